// From recorded poses: when a body that fell began to get up, when it stood, and how.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "study/audit/member.h"
#include "study/behaviour/get_up_study.h"
#include "study/behaviour/slip.h"

namespace sinew::study {
namespace {

constexpr double kUp = 0.9;                   ///< of the root's height
constexpr double kTouches = 1e-3;             ///< m
constexpr double kStill = 0.1, kLies = 0.25;  ///< m/s of every body, s
constexpr double kLow = 0.5;                  ///< of the root's height: who lies or sits
constexpr double kStandsFor = 1;              ///< s

/// The character in the axes of the ground, which is level at 0 there.
class Lying {
 public:
  Lying(const scene::Recording& recording, double slope)
      : recording_(recording),
        member_(audit::member_of(recording.characters[0]->skeleton)),
        level_(Eigen::AngleAxisd(slope, Vec3<double>::UnitY())),
        ground_(slope == 0 ? double(recording.ground.value_or(0.f)) : 0) {
    const Skeleton& skeleton = recording.characters[0]->skeleton;
    for (std::size_t b = 0; b < member_.bodies.size(); ++b) {
      const Role role = skeleton.joints[b].role;
      const bool foot =
          role == Role::kFootL || role == Role::kFootR || role == Role::kToesL || role == Role::kToesR;
      feet_.push_back(foot);
      bears_.push_back(foot || role == Role::kHandL || role == Role::kHandR);
    }
  }
  std::vector<Transform<double>> poses(int frame) const {
    std::vector<Transform<double>> out;
    const auto& model = recording_.frames[static_cast<std::size_t>(frame)].characters[0].model;
    for (std::size_t b = 0; b < member_.bodies.size(); ++b) {
      out.push_back(model[b].cast<double>());
      out.back().rotation = (level_ * out.back().rotation).normalized();
      out.back().translation = level_ * out.back().translation;
    }
    return out;
  }
  const audit::Member& member() const { return member_; }
  double ground() const { return ground_; }
  bool is_foot(int body) const { return feet_[static_cast<std::size_t>(body)]; }
  bool bears(int body) const { return bears_[static_cast<std::size_t>(body)]; }

 private:
  const scene::Recording& recording_;
  audit::Member member_;
  Quat<double> level_;
  double ground_;
  std::vector<bool> feet_, bears_;  ///< [body]
};

/// What one frame shows.
struct Seen {
  std::vector<Transform<double>> poses;
  std::vector<audit::Solid> solids;
  std::vector<int> whose;
  double height = 0, depth = 0;
  bool only_feet = true;
};

Seen see(const Lying& body, int frame) {
  Seen now;
  now.poses = body.poses(frame);
  now.solids = audit::placed(body.member(), now.poses, &now.whose);
  now.height = now.poses[0].translation.z() - body.ground();
  for (std::size_t s = 0; s < now.solids.size(); ++s) {
    const double below = audit::below(now.solids[s], body.ground());
    now.depth = std::max(now.depth, below);
    if (below > -kTouches && !body.is_foot(now.whose[s])) now.only_feet = false;
  }
  return now;
}

double fastest_body(const Seen& before, const Seen& now, double h) {
  double most = 0;
  for (std::size_t b = 0; b < now.poses.size(); ++b)
    most = std::max(most, (now.poses[b].translation - before.poses[b].translation).norm() / h);
  return most;
}

double fastest_joint(const Lying& body, const Seen& before, const Seen& now, double h) {
  double most = 0;
  for (std::size_t b = 1; b < now.poses.size(); ++b) {
    const auto parent = static_cast<std::size_t>(body.member().bodies[b].parent);
    const Quat<double> was = before.poses[parent].rotation.conjugate() * before.poses[b].rotation,
                       is = now.poses[parent].rotation.conjugate() * now.poses[b].rotation;
    most = std::max(most, was.angularDistance(is) / h);
  }
  return most;
}

}  // namespace

Rising rising(const scene::Recording& recording, double slope) {
  Rising found;
  const Lying body(recording, slope);
  const double h = 1 / recording.frame_rate;
  Seen before = see(body, 0);
  const double height = before.height;
  double still = 0;
  std::map<int, Slip> slips;
  const int frames = static_cast<int>(recording.frames.size());
  for (int f = 1; f < frames; ++f) {
    const Seen now = see(body, f);
    const double time = f * h;
    found.depth = std::max(found.depth, now.depth);
    found.fell = found.fell || !now.only_feet;
    const bool rests = fastest_body(before, now, h) < kStill && now.height < kLow * height;
    if (found.decided < 0 && !rests && still > kLies) {
      found.decided = time;
      found.decided_frame = f;
    }
    still = rests ? still + h : 0;
    const bool stands = found.fell && now.height > kUp * height && now.only_feet;
    if (!stands) found.stood_frame = -1;
    if (found.stood_frame < 0 && found.decided >= 0) {
      found.joint_speed = std::max(found.joint_speed, fastest_joint(body, before, now, h));
      for (std::size_t s = 0; s < now.solids.size(); ++s)
        if (body.bears(now.whose[s]))
          slips[now.whose[s]].look(before.solids[s], now.solids[s], body.ground());
      for (auto& [whose, slip] : slips) slip.end_frame();
    }
    if (stands && found.stood_frame < 0) found.stood_frame = f;
    before = now;
  }
  for (const auto& [whose, slip] : slips) found.slip = std::max(found.slip, slip.furthest());
  if (found.stood_frame < 0) return found;
  found.stood = found.stood_frame * h;
  found.stands = (frames - 1) * h - found.stood >= kStandsFor;
  return found;
}

}  // namespace sinew::study
