// How bodies fall: what touches the ground first, how hard, and how they come to lie; from recorded poses
// alone, beside what people's falls are like.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scene/recording.h"
#include "scene/scene.h"
#include "study/scenes/situation.h"

namespace sinew::study {

/// What takes somebody's balance.
enum class FallCause { kPush, kTrip, kSlip };

struct FallCase {
  FallCause cause = FallCause::kPush;
  double direction = 0;  ///< rad about the vertical, 0 ahead, positive left: of a push
  double impulse = 0;    ///< N·s
  double phase = 0;      ///< s of a walk, that is tripped or slips
  double hz = 60;
  bool reaches = true;  ///< with its arms for the ground; else it is limp, for comparison
};

struct FallRun {
  FallCase fall;
  std::string name;
  bool fell = false;        ///< more than feet touched the ground
  double hand = -1;         ///< s after the cause, when a hand or forearm touches the ground; negative: never
  double pelvis = -1;       ///< the same of the pelvis
  double head = -1;         ///< the same of the head
  double wrist_speed = 0;   ///< m/s, of the hand of the arm that touches first, a frame before
  double head_peak = 0;     ///< m/s², most that the head's centre of mass is accelerated
  double head_hit = 0;      ///< m/s, of the head a frame before it touches
  double pelvis_force = 0;  ///< N, from the ground, most within 0.1 s of the pelvis touching it
  double joint_speed = 0;   ///< rad/s, fastest of a joint
  double rests = 0;         ///< s from the last touch of another part until it lies still
  double depth = 0;         ///< m, deepest in the ground
  std::string refused;
};

/// Of a recording's first character; `since`: s, of the cause.
FallRun look_at_fall(const scene::Recording& recording, double since);

struct FallPlan {
  std::vector<double> impulses{};  ///< N·s, of pushes at the chest in eight directions; none: nobody falls
  std::vector<double> rates{};     ///< Hz
  int phases = 4;                  ///< of a walk, in which somebody is tripped or slips

  static FallPlan full() { return {{70, 100, 150}, {30, 60, 120}, 8}; }
  static FallPlan quick() { return {{100}, {60}, 2}; }
};

scene::Scene fall_scene(const FallCase& fall);
std::vector<FallRun> run_falls(const FallPlan& plan, const std::function<void(int, int)>& progress);
/// Those at one rate, of who reaches.
void judge_falls(const std::vector<FallRun>& falls, double hz, Findings& findings);
/// [{"scene", "reaches", "fell", "hand_s", "pelvis_s", "head_s" (−1: never), "wrist_speed",
/// "head_acceleration", "head_speed", "pelvis_force", "joint_speed", "rests_s", "depth"}], SI
nlohmann::json falls_json(const std::vector<FallRun>& falls);
std::string falls_table(const std::vector<FallRun>& falls);

}  // namespace sinew::study
