#include "study/behaviour/falls.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <numbers>
#include <set>
#include <utility>

#include "study/audit/member.h"
#include "study/behaviour/push_map.h"
#include "study/mannequin.h"
#include "study/on_all_processors.h"

namespace sinew::study {
namespace {

using Eigen::Vector3d;

constexpr double kCauseAt = 1, kStride = 1.067, kWatchedFor = 7;  ///< s
constexpr double kFootImpulse = 45, kFootPulled = 0.2;            ///< N·s and s, of who is tripped or slips
constexpr double kGravity = 9.81;
constexpr double kFar = 1e9;         ///< m: of what has no solid
constexpr double kTouches = 1e-3;    ///< m
constexpr double kStill = 0.05;      ///< m/s
constexpr double kNewTouch = 0.25;   ///< s
constexpr double kPelvisHits = 0.1;  ///< s

// What people's falls are like.
constexpr double kHandFirst = 0.9;           ///< share of sideways falls: 98 % (H11)
constexpr double kWristSpeed = 2.5;          ///< m/s (S45: 1.3 to 2.3)
constexpr double kHeadTouches = 0.15;        ///< share (H13: 11 %)
constexpr double kHeadStrikes = 1;           ///< m/s: a head that is laid down does not
constexpr double kHeadPeak = 60 * kGravity;  ///< m/s²: not a knock-out (H15)
constexpr double kPelvisForce = 5700;        ///< N: 4.0 ± 1.7 kN (H12)
constexpr double kRests = 2, kDepth = 5e-3;  ///< s, m

enum class Part { kFoot, kArm, kPelvis, kHead, kOther };  ///< an arm from the forearm on

/// A recording's first character, body by body.
class Faller {
 public:
  explicit Faller(const scene::Recording& recording)
      : recording_(recording),
        skeleton_(recording.characters[0]->skeleton),
        member_(audit::member_of(skeleton_)),
        ground_(double(recording.ground.value_or(0.f))) {
    for (int b = 0; b < bodies(); ++b) part_.push_back(part_of(b));
  }

  std::vector<Transform<double>> poses(int frame) const {
    std::vector<Transform<double>> out;
    const auto& model = recording_.frames[static_cast<std::size_t>(frame)].characters[0].model;
    for (std::size_t b = 0; b < member_.bodies.size(); ++b) {
      out.push_back(model[b].cast<double>());
      out.back().rotation.normalize();
    }
    return out;
  }
  /// m, of each body over the ground; what has no solid is far away.
  std::vector<double> clearance(int frame) const {
    const std::vector<Transform<double>> at = poses(frame);
    std::vector<int> whose;
    const std::vector<audit::Solid> solids = audit::placed(member_, at, &whose);
    std::vector<double> least(member_.bodies.size(), kFar);
    for (std::size_t s = 0; s < solids.size(); ++s) {
      double& clear = least[static_cast<std::size_t>(whose[s])];
      clear = std::min(clear, -audit::below(solids[s], ground_));
    }
    return least;
  }
  Vector3d center(int frame, int body) const {
    const auto b = static_cast<std::size_t>(body);
    return poses(frame)[b] * member_.bodies[b].center;
  }
  /// m/s, of a body's centre of mass, over the frame that ended before this one; 0 in the first two.
  double speed_before(int frame, int body) const {
    return frame < 2 ? 0 : (center(frame - 1, body) - center(frame - 2, body)).norm() / step();
  }
  Vector3d center_of_mass(int frame) const { return audit::center_of_mass(member_, poses(frame)); }
  /// Of the arm that a body belongs to.
  int hand_of(int body) const {
    while (part(parent(body)) == Part::kArm) body = parent(body);  // now the forearm
    const bool left = body == find(Role::kForearmL);
    const int hand = find(left ? Role::kHandL : Role::kHandR);
    return hand < 0 ? body : hand;
  }
  Part part(int body) const { return body < 0 ? Part::kOther : part_[static_cast<std::size_t>(body)]; }
  int find(Role role) const { return skeleton_.find(role); }
  int frames() const { return static_cast<int>(recording_.frames.size()); }
  double step() const { return 1 / recording_.frame_rate; }
  double mass() const { return skeleton_.total_mass(); }
  int parent(int body) const { return member_.bodies[static_cast<std::size_t>(body)].parent; }
  int bodies() const { return static_cast<int>(member_.bodies.size()); }

 private:
  Part part_of(int body) const {
    for (int b = body; b >= 0; b = parent(b)) {
      const Role role = skeleton_.joints[static_cast<std::size_t>(b)].role;
      if (role == Role::kFootL || role == Role::kFootR) return Part::kFoot;
      if (role == Role::kForearmL || role == Role::kForearmR) return Part::kArm;
      if (b == body && role == Role::kPelvis) return Part::kPelvis;
      if (b == body && role == Role::kHead) return Part::kHead;
    }
    return Part::kOther;
  }

  const scene::Recording& recording_;
  const Skeleton& skeleton_;
  audit::Member member_;
  double ground_;
  std::vector<Part> part_;  ///< [body]
};

template <class Of>
Vector3d acceleration(int frame, double h, const Of& of) {
  return (of(frame + 1) - 2 * of(frame) + of(frame - 1)) / (h * h);
}

std::string name_of(const FallCase& c) {
  char text[64];
  const char* cause = c.cause == FallCause::kPush ? "push" : c.cause == FallCause::kTrip ? "trip" : "slip";
  if (c.cause == FallCause::kPush)
    std::snprintf(text, sizeof text, "%s %3.0f N s %4.0f deg %3.0f Hz", cause, c.impulse,
                  c.direction * 180 / std::numbers::pi, c.hz);
  else
    std::snprintf(text, sizeof text, "%s at %.2f s       %3.0f Hz", cause, c.phase, c.hz);
  return text;
}

/// `body` touches the ground in a frame, `since` s after the cause.
void note_touch(const Faller& of, int frame, int body, double since, FallRun& run) {
  const Part part = of.part(body);
  run.fell = run.fell || part != Part::kFoot;
  const auto first = [&](Part wanted, double& time) {
    const bool now = part == wanted && time < 0;
    if (now) time = since;
    return now;
  };
  if (first(Part::kArm, run.hand)) run.wrist_speed = of.speed_before(frame, of.hand_of(body));
  if (first(Part::kHead, run.head)) run.head_hit = of.speed_before(frame, body);
  first(Part::kPelvis, run.pelvis);
}

/// Whether anything moves over the step that ends with a frame; and how fast joints turn.
bool note_motion(const Faller& of, int frame, FallRun& run) {
  double fastest = 0;
  const std::vector<Transform<double>> now = of.poses(frame), before = of.poses(frame - 1);
  for (std::size_t b = 0; b < now.size(); ++b) {
    fastest = std::max(fastest, (now[b].translation - before[b].translation).norm() / of.step());
    const int parent = of.parent(static_cast<int>(b));
    if (parent < 0) continue;
    const auto up = static_cast<std::size_t>(parent);
    const Eigen::AngleAxisd turn((before[up].rotation.conjugate() * before[b].rotation).conjugate() *
                                 (now[up].rotation.conjugate() * now[b].rotation));
    run.joint_speed = std::max(run.joint_speed, turn.angle() / of.step());
  }
  return fastest > kStill;
}

/// What the head and the pelvis bear in a frame that is neither the first nor the last.
void note_loads(const Faller& of, int frame, double since, FallRun& run) {
  const int head = of.find(Role::kHead);
  // A push ends 0.1 s after it began; what it does to the head is not the fall's.
  if (head >= 0 && since > kPushed + 2 * of.step())
    run.head_peak = std::max(
        run.head_peak, acceleration(frame, of.step(), [&](int f) { return of.center(f, head); }).norm());
  if (run.pelvis < 0 || since - run.pelvis > kPelvisHits) return;
  const auto force = [&](int f) {
    const double up = acceleration(f, of.step(), [&](int g) { return of.center_of_mass(g); }).z();
    return of.mass() * (up + kGravity);
  };
  run.pelvis_force = std::max({run.pelvis_force, force(frame), force(std::max(frame - 1, 1))});
}

}  // namespace

FallRun look_at_fall(const scene::Recording& recording, double since) {
  FallRun run;
  const Faller body(recording);
  const double h = body.step();
  std::vector<double> touched(static_cast<std::size_t>(body.bodies()), -1e9);  // [body] s, last
  double last_touch = 0, moves = 0;                                            // s, since the cause
  const int from = std::max(static_cast<int>(std::lround(since / h)), 1);
  for (int f = from; f < body.frames(); ++f) {
    const double time = f * h - since;
    const std::vector<double> clear = body.clearance(f);
    for (int b = 0; b < body.bodies(); ++b) {
      const auto i = static_cast<std::size_t>(b);
      const bool has_solid = clear[i] < kFar, clip_presses = body.part(b) == Part::kFoot;
      if (has_solid && !clip_presses) run.depth = std::max(run.depth, -clear[i]);
      if (clear[i] > kTouches) continue;
      if (time - std::exchange(touched[i], time) > kNewTouch) last_touch = time;
      note_touch(body, f, b, time, run);
    }
    if (note_motion(body, f, run)) moves = time;
    if (f + 1 < body.frames()) note_loads(body, f, time, run);
  }
  run.rests = std::max(moves - last_touch, 0.0);
  return run;
}

scene::Scene fall_scene(const FallCase& fall) {
  const bool walks = fall.cause != FallCause::kPush;
  scene::Scene s =
      balancing_scene(walks ? "walk" : "stand", true, kCauseAt + kStride + kPushed + kWatchedFor, fall.hz);
  s.characters[0].settings.self_collision = true;
  if (!fall.reaches) s.characters[0].behaviour->reach_strength = 0;
  const Skeleton& skeleton = s.characters[0].asset->skeleton;
  scene::Push p;
  p.time = kCauseAt + fall.phase;
  p.duration = walks ? kFootPulled : kPushed;
  if (!walks) {
    p.joint = skeleton.find(Role::kChest);
    p.impulse = fall.impulse * Vec3<double>(std::cos(fall.direction), std::sin(fall.direction), 0);
    s.pushes.push_back(p);
    return s;
  }
  // The foot that is pulled back, or ahead, whichever it is in that moment; and so is the trunk, the other
  // way.
  const double way = fall.cause == FallCause::kTrip ? -1 : 1;
  p.joint = skeleton.find(Role::kFootL);
  p.impulse = Vec3<double>(way * kFootImpulse, 0, 0);
  s.pushes.push_back(p);
  p.joint = skeleton.find(Role::kChest);
  p.impulse = Vec3<double>(-way * kFootImpulse, 0, 0);
  s.pushes.push_back(p);
  return s;
}

std::vector<FallRun> run_falls(const FallPlan& plan, const std::function<void(int, int)>& progress) {
  std::vector<FallCase> cases;
  const auto add = [&](const FallCase& fall) {
    for (const bool reaches : {true, false}) {
      cases.push_back(fall);
      cases.back().reaches = reaches;
    }
  };
  for (const double hz : plan.rates) {
    for (const double impulse : plan.impulses)
      for (int d = 0; d < 8; ++d) add({FallCause::kPush, d * std::numbers::pi / 4, impulse, 0, hz});
    for (const FallCause cause : {FallCause::kTrip, FallCause::kSlip})
      for (int n = 0; n < plan.phases; ++n) add({cause, 0, 0, kStride * n / plan.phases, hz});
  }
  std::vector<FallRun> runs(cases.size());
  std::mutex writing;
  int done = 0;
  on_all_processors(static_cast<int>(cases.size()), [&](int n) {
    const auto i = static_cast<std::size_t>(n);
    scene::Recording recording;
    scene::Telemetry telemetry;
    const convert::Error error = scene::run_scene(fall_scene(cases[i]), recording, telemetry, nullptr);
    FallRun run = error ? FallRun{} : look_at_fall(recording, kCauseAt + cases[i].phase);
    if (error) run.refused = error.message;
    run.fall = cases[i];
    run.name = name_of(cases[i]);
    runs[i] = run;
    const std::lock_guard lock(writing);
    if (progress) progress(++done, static_cast<int>(cases.size()));
  });
  return runs;
}

void judge_falls(const std::vector<FallRun>& falls, double hz, Findings& findings) {
  int fell = 0, hand_first = 0, head = 0, pelvis = 0;
  for (const FallRun& run : falls) {
    if (!run.refused.empty()) return findings.refuse(run.refused);
    if (!run.fell || !run.fall.reaches || run.fall.hz != hz) continue;
    ++fell;
    head += run.head_hit > kHeadStrikes;
    pelvis += run.pelvis >= 0;
    hand_first += run.hand >= 0 && run.pelvis >= 0 && run.hand <= run.pelvis;
    if (run.hand >= 0) findings.at_most("wrist that touches, fastest (m/s)", run.wrist_speed, kWristSpeed);
    findings.at_most("head, largest acceleration (m/s^2)", run.head_peak, kHeadPeak);
    findings.at_most("force of the ground when the pelvis touches, largest (N)", run.pelvis_force,
                     kPelvisForce);
    findings.at_most("from the last touch until it lies still, longest (s)", run.rests, kRests);
    findings.at_most("depth in the ground (m)", run.depth, kDepth);
  }
  if (fell == 0) return findings.refuse("nobody fell");
  findings.at_least("a hand touches before the pelvis (share)", pelvis > 0 ? double(hand_first) / pelvis : 1,
                    kHandFirst);
  findings.at_most("the head strikes the ground (share)", double(head) / fell, kHeadTouches);
}

nlohmann::json falls_json(const std::vector<FallRun>& falls) {
  nlohmann::json list = nlohmann::json::array();
  for (const FallRun& r : falls)
    list.push_back({{"scene", r.name},
                    {"reaches", r.fall.reaches},
                    {"fell", r.fell},
                    {"hand_s", r.hand},
                    {"pelvis_s", r.pelvis},
                    {"head_s", r.head},
                    {"wrist_speed", r.wrist_speed},
                    {"head_acceleration", r.head_peak},
                    {"head_speed", r.head_hit},
                    {"pelvis_force", r.pelvis_force},
                    {"joint_speed", r.joint_speed},
                    {"rests_s", r.rests},
                    {"depth", r.depth}});
  return list;
}

std::string falls_table(const std::vector<FallRun>& falls) {
  std::string text =
      "falls                        hand s  pelvis s  head s  wrist m/s  head m/s     g   pelvis N  rad/s  "
      "rests s  deep mm\n";
  char line[300];
  for (const FallRun& r : falls) {
    if (!r.fall.reaches) continue;
    std::snprintf(line, sizeof line, "    %-26s stands\n", r.name.c_str());
    if (r.fell)
      std::snprintf(line, sizeof line,
                    "    %-26s %5.2f %8.2f %8.2f %9.2f %9.2f %6.0f %9.0f %7.1f %8.2f %8.1f\n", r.name.c_str(),
                    r.hand, r.pelvis, r.head, r.wrist_speed, r.head_hit, r.head_peak / kGravity,
                    r.pelvis_force, r.joint_speed, r.rests, 1000 * r.depth);
    text += line;
  }
  text += "medians, of those to whom it happens\n";
  std::set<double> rates;
  for (const FallRun& r : falls) rates.insert(r.fall.hz);
  for (const double hz : rates)
    for (const bool reaches : {true, false}) {
      const auto median = [&](double FallRun::*of) {
        std::vector<double> values;
        for (const FallRun& r : falls)
          if (r.fell && r.fall.hz == hz && r.fall.reaches == reaches && r.*of > 0) values.push_back(r.*of);
        std::sort(values.begin(), values.end());
        return values.empty() ? 0 : values[values.size() / 2];
      };
      std::snprintf(line, sizeof line, "    %-18s %3.0f Hz  %5.2f %8.2f %8.2f %9.2f %9.2f %6.0f %9.0f\n",
                    reaches ? "who reaches" : "who is limp", hz, median(&FallRun::hand),
                    median(&FallRun::pelvis), median(&FallRun::head), median(&FallRun::wrist_speed),
                    median(&FallRun::head_hit), median(&FallRun::head_peak) / kGravity,
                    median(&FallRun::pelvis_force));
      text += line;
    }
  return text + "\n";
}

}  // namespace sinew::study
