#include "study/behaviour/get_up_study.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <numbers>
#include <random>

#include "study/behaviour/push_map.h"
#include "study/mannequin.h"
#include "study/on_all_processors.h"

namespace sinew::study {
namespace {

constexpr double kPushAt = 0.5, kEnds = 16;         ///< s
constexpr double kSlope = std::numbers::pi / 18;    ///< rad
constexpr double kInterrupts = 60;                  ///< N·s
constexpr double kHumanMass = 75;                   ///< kg
constexpr double kMostMedian = 4, kMostTime = 8;    ///< s
constexpr double kMostHelp = 8;                     ///< N and N·m of a human
constexpr double kMostSlip = 0.015, kDepth = 5e-3;  ///< m
constexpr double kJointSpeed = 8;                   ///< rad/s
constexpr double kShare = 0.98;                     ///< that has to stand

struct Fall {
  int seed = 0;
  double slope = 0;
  double interrupted = -1;  ///< s
};

double between(std::mt19937& random, double low, double high) {
  return low + (high - low) * double(random()) / double(std::mt19937::max());
}

/// Who stands on the floor, or on a slope, and is pushed over: one push somewhere, another at the chest that
/// turns it.
scene::Scene fall_scene(const Fall& fall) {
  scene::Scene s = balancing_scene("stand", true, kEnds, 60);
  scene::SceneCharacter& c = s.characters[0];
  c.behaviour->get_up = GetUpPolicy::kAuto;
  c.settings.self_collision = true;
  const Skeleton& skeleton = c.asset->skeleton;
  std::mt19937 random(1 + static_cast<unsigned>(fall.seed));
  const Role where[] = {Role::kChest, Role::kPelvis, Role::kHead, Role::kShinL, Role::kThighR};
  const Role at = where[random() % 5];
  const double share = at == Role::kHead || at == Role::kShinL ? 0.4 : 1;
  const double angle = between(random, 0, 2 * std::numbers::pi), size = between(random, 120, 260) * share;
  const Vec3<double> way(std::cos(angle), std::sin(angle), 0);
  const auto push = [&](Role role, const Vec3<double>& impulse, double time) {
    scene::Push p;
    p.time = time;
    p.duration = kPushed;
    p.joint = skeleton.find(role);
    p.impulse = impulse;
    s.pushes.push_back(p);
  };
  push(at, size * way, kPushAt);
  push(Role::kUpperArmL, between(random, -60, 60) * Vec3<double>(-way.y(), way.x(), 0), kPushAt);
  push(Role::kChest, 150 * way, kPushAt + 0.3);  // no step catches it
  if (fall.interrupted > 0) push(Role::kChest, kInterrupts * way, fall.interrupted);
  if (fall.slope == 0) return s;
  Collider& slope = s.obstacles.emplace_back();
  slope.shape = Shape::kBox;
  slope.size = {40, 40, 1};
  slope.local.rotation = Quat<double>(Eigen::AngleAxisd(-fall.slope, Vec3<double>::UnitY()));
  slope.local.translation = slope.local.rotation * Vec3<double>(0, 0, -1);
  s.world.ground = false;
  return s;
}

void add(const Fall& fall, GetUpResult& into, Rising* found, std::mutex& writing) {
  scene::Recording recording;
  scene::Telemetry telemetry;
  const convert::Error error = scene::run_scene(fall_scene(fall), recording, telemetry, nullptr);
  const Rising is = error ? Rising{} : rising(recording, fall.slope);
  const std::lock_guard lock(writing);
  if (error) into.refused = error.message;
  if (found) *found = is;
  ++into.falls;
  into.depth = std::max(into.depth, is.depth);
  const bool stands = is.stands && is.fell;
  into.stand += stands ? 1 : 0;
  if (is.decided < 0) return;  // it never lay quite still: what it took is not to be told apart from its fall
  into.slip = std::max(into.slip, is.slip);
  into.joint_speed = std::max(into.joint_speed, is.joint_speed);
  for (const scene::TelemetryRow& row : telemetry.rows) {
    if (row.time < is.decided) continue;
    into.help_force = std::max(into.help_force, row.report.help_force);
    into.help_torque = std::max(into.help_torque, row.report.help_torque);
  }
  if (stands)
    into.times.insert(std::upper_bound(into.times.begin(), into.times.end(), is.stood - is.decided),
                      is.stood - is.decided);
}

GetUpResult run_falls(const char* name, int falls, double slope,
                      const std::function<void(int, int)>& progress) {
  GetUpResult result;
  result.name = name;
  std::mutex writing;
  int done = 0;
  on_all_processors(falls, [&](int n) {
    add({n, slope}, result, nullptr, writing);
    const std::lock_guard lock(writing);
    if (progress) progress(++done, falls);
  });
  return result;
}

GetUpResult run_interruptions(int times, const std::function<void(int, int)>& progress) {
  GetUpResult result, alone;
  result.name = "interrupted";
  std::mutex writing;
  Rising first;
  add({0}, alone, &first, writing);
  if (!first.stands) return result;
  on_all_processors(times, [&](int n) {
    const double at = first.decided + (n + 0.5) / times * (first.stood - first.decided);
    add({0, 0, at}, result, nullptr, writing);
    if (progress) progress(n + 1, times);
  });
  return result;
}

}  // namespace

std::vector<GetUpResult> run_get_ups(const GetUpPlan& plan, const std::function<void(int, int)>& progress) {
  return {run_falls("flat", plan.falls, 0, progress), run_falls("slope_10_deg", plan.falls, kSlope, progress),
          run_interruptions(plan.interruptions, progress)};
}

void judge_get_ups(const GetUpResult& r, Findings& findings) {
  if (!r.refused.empty()) return findings.refuse(r.refused);
  findings.at_least("stand again (share)", r.falls > 0 ? double(r.stand) / r.falls : 0, kShare);
  findings.at_most("from the decision to standing, median (s)", r.median(), kMostMedian);
  findings.at_most("from the decision to standing, longest (s)", r.worst(), kMostTime);
  const double mass = mannequin()->skeleton.total_mass() / kHumanMass;
  findings.at_most("help, peak (N)", r.help_force, kMostHelp * mass);
  findings.at_most("help, peak (N m)", r.help_torque, kMostHelp * mass);
  findings.at_most("slip of hands and feet that touch (m)", r.slip, kMostSlip);
  findings.at_most("joint speed, largest (rad/s)", r.joint_speed, kJointSpeed);
  findings.at_most("depth in the ground (m)", r.depth, kDepth);
}

nlohmann::json get_ups_json(const std::vector<GetUpResult>& results) {
  nlohmann::json list = nlohmann::json::array();
  for (const GetUpResult& r : results)
    list.push_back({{"scene", r.name},
                    {"falls", r.falls},
                    {"stand", r.stand},
                    {"time_median", r.median()},
                    {"time_longest", r.worst()},
                    {"help_force", r.help_force},
                    {"help_torque", r.help_torque},
                    {"slip", r.slip},
                    {"joint_speed", r.joint_speed},
                    {"depth", r.depth}});
  return list;
}

std::string get_ups_table(const std::vector<GetUpResult>& results) {
  std::string text =
      "getting up      stand     s, median  longest   help N   N m   slip mm   rad/s   deep mm\n";
  char line[300];
  for (const GetUpResult& r : results) {
    std::snprintf(line, sizeof line, "    %-12s %3d/%-3d %8.2f %9.2f %8.0f %5.0f %9.0f %7.1f %9.1f\n",
                  r.name.c_str(), r.stand, r.falls, r.median(), r.worst(), r.help_force, r.help_torque,
                  1000 * r.slip, r.joint_speed, 1000 * r.depth);
    text += line;
  }
  return text + "\n";
}

}  // namespace sinew::study
