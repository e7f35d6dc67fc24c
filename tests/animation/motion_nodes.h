// Everything that makes or changes motions. What all of them must keep is tested once, in
// motion_nodes_test.cpp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "animation/motion_node.h"
#include "animation/motion_nodes_of_rigs.h"
#include "sinew/animation/blend_space.h"
#include "sinew/animation/blending_job.h"
#include "sinew/animation/crossfade.h"
#include "sinew/animation/inertialize_job.h"
#include "sinew/animation/mesh_additive_job.h"
#include "sinew/animation/phase_map.h"
#include "sinew/animation/smooth_input.h"

namespace sinew::fixtures {

/// τ and its rates at t.
using TimeMap = ClipTime (*)(double t);
inline ClipTime at_normal_speed(double t) {
  return t;
}
inline ClipTime swaying_time(double t) {
  return {t + 0.1 * std::sin(5 * t), 1 + 0.5 * std::cos(5 * t), -2.5 * std::sin(5 * t)};
}
/// Normal speed, slower, a stop, backwards.
inline ClipTime turning_time(double t) {
  return {std::sin(t), std::cos(t), -std::sin(t)};
}

template <class T>
struct SampleNode : MotionNode<T> {
  Clip clip;
  TimeMap map;
  SampleNode(Clip played, TimeMap time) : clip(std::move(played)), map(time) {
    clip.root_step = {1, 0.5f, 0};
  }
  void pose(std::span<JointJet<T>> out) override { sample<T>(clip, map(this->now), out); }
};

/// Three motions, joined as the modes say, with weights that sway.
template <class T>
struct BlendNode : MotionNode<T> {
  Clip clips[3] = {node_clip(1), node_clip(2), node_clip(3)};
  std::vector<JointJet<T>> jets[3];
  std::vector<T> mask = {0, 1, T(0.5), T(0.25), 1, 0, T(0.75), 1, 1, 0, T(0.1)};
  std::vector<Transform<T>> rest = std::vector<Transform<T>>(kNodeJoints);
  BlendMode second, third;
  BlendNode(BlendMode two, BlendMode three) : second(two), third(three) {
    for (auto& j : jets) j.resize(kNodeJoints);
  }
  void pose(std::span<JointJet<T>> out) override {
    const double t = this->now;
    for (int i = 0; i < 3; ++i) sample<T>(clips[i], t, jets[i]);
    const BlendLayer<T> layers[] = {{jets[0], swaying_weight<T>(t, 0.5, 0.3, 0)},
                                    {jets[1], swaying_weight<T>(t, 0.5, 0.4, 1), {}, second},
                                    {jets[2], swaying_weight<T>(t, 0.4, 0.2, 2), mask, third}};
    (void)BlendingJob<T>{layers, rest, out}.Run();
  }
};

/// From one clip to another, by the weight that `Ease` gives at a time.
template <class T, class Ease>
struct CrossfadeNode : MotionNode<T> {
  Clip a = node_clip(1), b = node_clip(2);
  std::vector<JointJet<T>> from = std::vector<JointJet<T>>(kNodeJoints);
  Ease ease;
  void begin() override { ease = {}; }
  void step(double h) override {
    this->now += h;
    ease.step(h);
  }
  void change(int k) override { ease.change(k); }
  void pose(std::span<JointJet<T>> out) override {
    sample<T>(a, this->now, from);
    sample<T>(b, this->now, out);
    const TimeJet<double> w = ease.weight();
    crossfade<T>(from, out, {T(w.value), T(w.rate), T(w.acceleration)}, out);
  }
};
struct TimedEase {
  double elapsed = -0.5, duration = 0.6;
  void step(double h) { elapsed += h; }
  void change(int) {}
};
struct QuinticEase : TimedEase {
  TimeJet<double> weight() const { return EaseWeight<double>::at(elapsed, duration); }
};
struct SmoothstepEase : TimedEase {
  TimeJet<double> weight() const {
    if (elapsed <= 0 || elapsed >= duration) return {elapsed <= 0 ? 0.0 : 1.0};
    const double u = elapsed / duration, d = duration;
    return {u * u * (3 - 2 * u), 6 * u * (1 - u) / d, (6 - 12 * u) / (d * d)};
  }
};
/// The game's weight steps to 1, back to 0 before it is there, and to a half.
struct FilteredEase {
  SmoothInput<double> input;
  double goal = 0;
  void step(double h) { input.step(goal, SmoothInput<double>::pole_of(0.1), h); }
  void change(int k) { goal = k == 0 ? 1 : k == 1 ? 0 : 0.5; }
  TimeJet<double> weight() const { return input.x; }
};

/// Changes from a clip to the next at three instants, the second in the middle of the first transition.
constexpr double kDepartures[] = {0.5, 0.7, 2}, kFade = 0.4;  ///< s
template <class T>
struct TransitionNode : MotionNode<T> {
  Clip clips[4] = {node_clip(1), node_clip(2), node_clip(3), node_clip(4)};
  int playing = 0;
  std::vector<JointJet<T>> output = std::vector<JointJet<T>>(kNodeJoints), next = output;
  void begin() override { playing = 0; }
  void change(int) override {
    if (std::find(std::begin(kDepartures), std::end(kDepartures), this->now) == std::end(kDepartures)) return;
    pose(output);
    ++playing;
    sample<T>(clips[playing], this->now, next);
    depart();
  }
  void pose(std::span<JointJet<T>> out) override {
    sample<T>(clips[playing], this->now, out);
    if (playing > 0) arrive(out);
  }
  virtual void depart() = 0;
  virtual void arrive(std::span<JointJet<T>> out) = 0;
};

template <class T>
struct InertializeNode : TransitionNode<T> {
  std::vector<T> numbers = std::vector<T>(inertial_numbers(kNodeJoints, kNodeJoints));
  std::vector<T> profile;
  InertialState<T> state{numbers, kNodeJoints, kNodeJoints};
  explicit InertializeNode(bool profiled) {
    for (int j = 0; profiled && j < kNodeJoints; ++j) profile.push_back(T(1) / T(1 + j % 3));
  }
  void step(double h) override {
    this->now += h;
    state.elapsed += T(h);
  }
  void depart() override { (void)begin_inertial<T>(this->output, this->next, T(kFade), state); }
  void arrive(std::span<JointJet<T>> out) override {
    (void)InertializeJob<T>{out, &state, profile, out}.Run();
  }
};

template <class T>
struct DeadBlendNode : TransitionNode<T> {
  std::vector<JointJet<T>> left = std::vector<JointJet<T>>(kNodeJoints), going = left;
  T elapsed = 0;
  void step(double h) override {
    this->now += h;
    elapsed += T(h);
  }
  void depart() override {
    left = this->output;
    elapsed = 0;
  }
  void arrive(std::span<JointJet<T>> out) override {
    ExtrapolateJob<T> job;
    job.from = left;
    job.elapsed = elapsed;
    job.out = going;
    (void)job.Run();
    crossfade<T>(going, out, EaseWeight<T>::at(elapsed, T(kFade)), out);
  }
};

/// A loop of 4 s and one of 3 s that step together, mixed by a filtered input.
inline PhaseMap phase_map(std::span<const PhaseMarker> markers, double duration) {
  PhaseMap map;
  (void)fit_phase_map(markers, duration, 1, map);
  return map;
}
constexpr PhaseMarker kSlowSteps[] = {{0, 0.3}, {0.5, 2.6}}, kFastSteps[] = {{0, 1.1}, {0.5, 2.5}};
template <class T>
struct SyncNode : MotionNode<T> {
  Clip slow = node_clip(1),
       fast = random_clip(
           {.joints = kNodeJoints, .duration = 3, .knot_interval = 0.5f, .moving = kNodeJoints, .seed = 2});
  PhaseMap maps[2] = {phase_map(kSlowSteps, 4), phase_map(kFastSteps, 3)};
  std::vector<JointJet<T>> other = std::vector<JointJet<T>>(kNodeJoints);
  SmoothInput<double> input;
  double goal = 0;
  TimeJet<double> phase;
  ClipTime times[2];
  void run(double h) {
    const PhaseMember members[] = {{&maps[0], TimeJet<double>(1.0) - input.x}, {&maps[1], input.x}};
    (void)PhaseJob{members, h, &phase, times}.Run();
  }
  void begin() override {
    input = {};
    goal = 0;
    phase = TimeJet<double>(0.1);
    run(0);
  }
  void step(double h) override {
    this->now += h;
    while (h > 0) {  // long frames in parts
      const double part = std::min(h, 1 / 240.0);
      input.step(goal, SmoothInput<double>::pole_of(0.15), part);
      run(part);
      h -= part;
    }
  }
  void change(int k) override { goal = k == 0 ? 1 : k == 1 ? 0.2 : 0.7; }
  void pose(std::span<JointJet<T>> out) override {
    sample<T>(slow, times[0], out);
    sample<T>(fast, times[1], other);
    const TimeJet<double>& w = input.x;
    crossfade<T>(out, other, {T(w.value), T(w.rate), T(w.acceleration)}, out);
  }
};

/// Five clips by two parameters that the game sets in steps, three of the points on a line.
inline BlendSpace node_space() {
  constexpr double kPoints[] = {0, 0, 1, 0, 2, 0, 0.5, 1.5, 1.5, 1.5};
  BlendSpace space;
  (void)bake_blend_space(kPoints, 2, 33, space);
  return space;
}
template <class T>
struct SpaceNode : MotionNode<T> {
  BlendSpace space = node_space();
  Clip clips[5] = {node_clip(1), node_clip(2), node_clip(3), node_clip(4), node_clip(5)};
  std::vector<JointJet<T>> jets[5];
  std::vector<Transform<T>> rest = std::vector<Transform<T>>(kNodeJoints);
  SmoothInput<T> input[2];
  Vec3<T> goal;
  SpaceNode() {
    for (auto& j : jets) j.resize(kNodeJoints);
  }
  void begin() override {
    goal = {0, 0, 0};
    for (auto& x : input) x = {};
  }
  void step(double h) override {
    this->now += h;
    for (int d = 0; d < 2; ++d) input[d].step(goal[d], SmoothInput<T>::pole_of(T(0.15)), T(h));
  }
  void change(int k) override {
    goal = k == 0 ? Vec3<T>(1, T(1.2), 0) : k == 1 ? Vec3<T>(2, T(0.1), 0) : Vec3<T>(T(0.6), T(2), 0);
  }
  void pose(std::span<JointJet<T>> out) override {
    const TimeJet<T> parameters[] = {input[0].x, input[1].x};
    TimeJet<T> weights[5];
    blend_space_weights<T>(space, parameters, weights);
    BlendLayer<T> layers[5];
    for (int i = 0; i < 5; ++i) {
      sample<T>(clips[i], this->now, jets[i]);
      layers[i] = {jets[i], weights[i]};
    }
    (void)BlendingJob<T>{layers, rest, out}.Run();
  }
};

/// A moving difference in model space on top of a motion, by a weight that sways and a mask.
template <class T>
struct MeshAdditiveNode : MotionNode<T> {
  Clip base = node_clip(1), aim = node_clip(2), reference = node_clip(3);
  std::vector<int> parents = {-1, 0, 1, 2, 3, 4, 2, 6, 0, 8, 9};
  std::vector<T> mask = {0, 1, T(0.5), T(0.25), 1, 0, T(0.75), 1, 1, 0, T(0.1)};
  std::vector<JointJet<T>> from = std::vector<JointJet<T>>(kNodeJoints), difference = from;
  std::vector<MovingRotation<T>> scratch = std::vector<MovingRotation<T>>(2 * kNodeJoints);
  void pose(std::span<JointJet<T>> out) override {
    sample<T>(reference, this->now, from);
    sample<T>(aim, this->now, difference);
    subtract_in_model<T>(parents, from, difference, scratch, difference);
    sample<T>(base, this->now, out);
    const TimeJet<T> w = swaying_weight<T>(this->now, 0.3, 0.2, 1);
    (void)MeshAdditiveJob<T>{parents, out, difference, w, mask, scratch}.Run();
  }
};

/// One node and what it promises.
template <class T>
struct NodeCase {
  std::string name;
  int continuity = 2;  ///< derivatives that do not jump at its changes: 2, 1, or 0 for the pose alone
  std::vector<double> switches;  ///< s: the game's changes, and where a node's own formula changes
  std::unique_ptr<MotionNode<T>> node;
};

template <class T>
std::vector<NodeCase<T>> motion_nodes() {
  std::vector<NodeCase<T>> all;
  const auto add = [&](const char* name, int continuity, std::vector<double> switches,
                       std::unique_ptr<MotionNode<T>> node) {
    all.push_back({name, continuity, std::move(switches), std::move(node)});
  };
  const BlendMode mix = BlendMode::kMix, over = BlendMode::kOverride, more = BlendMode::kAdditive;
  add("sampler_over_the_seam", 2, {4}, std::make_unique<SampleNode<T>>(node_clip(1), at_normal_speed));
  add("sampler_with_swaying_time", 2, {}, std::make_unique<SampleNode<T>>(node_clip(1), swaying_time));
  add("sampler_that_turns_back", 2, {3.14159265358979323846},
      std::make_unique<SampleNode<T>>(node_clip(1), turning_time));
  add("sampler_past_the_end", 0, {4}, std::make_unique<SampleNode<T>>(node_clip(1, false), at_normal_speed));
  add("mix", 2, {}, std::make_unique<BlendNode<T>>(mix, mix));
  add("override_and_additive", 2, {}, std::make_unique<BlendNode<T>>(over, more));
  add("additive_in_model_space", 2, {}, std::make_unique<MeshAdditiveNode<T>>());
  add("mirror", 2, {}, std::make_unique<MirrorNode<T>>());
  add("model_space_and_socket", 2, {}, std::make_unique<ModelMotionNode<T>>());
  add("crossfade_quintic", 2, {0.5, 1.1}, std::make_unique<CrossfadeNode<T, QuinticEase>>());
  add("crossfade_smoothstep", 1, {0.5, 1.1}, std::make_unique<CrossfadeNode<T, SmoothstepEase>>());
  add("crossfade_by_filtered_input", 2, {0.5, 0.6, 1.5}, std::make_unique<CrossfadeNode<T, FilteredEase>>());
  add("inertialize", 2, {0.5, 0.7, 1.1, 2, 2.4}, std::make_unique<InertializeNode<T>>(false));
  add("inertialize_by_profile", 2, {0.5, 0.7, 0.7 + kFade / 3, 0.9, 1.1, 2, 2 + kFade / 3, 2.2, 2.4},
      std::make_unique<InertializeNode<T>>(true));
  add("dead_blend", 2, {0.5, 0.7, 1.1, 2, 2.4}, std::make_unique<DeadBlendNode<T>>());
  add("two_bone_to_a_target_that_jumps", 2, {0.5, 0.7, 1.1}, std::make_unique<ReachNode<T>>());
  add("foot_that_is_locked_and_released", 2, {0.5, 0.6, 1.3, 1.5, 2}, std::make_unique<FootNode<T>>());
  add("aim_at_a_target_in_steps", 2, {0.5, 0.7}, std::make_unique<LookNode<T>>());
  add("look_at_one_target_after_the_other", 2, {0.5, 0.7}, std::make_unique<LookChainNode<T>>());
  add("step_together", 2, {0.5, 0.7, 1.5}, std::make_unique<SyncNode<T>>());
  add("blend_space", 2, {0.5, 0.7, 1.5}, std::make_unique<SpaceNode<T>>());
  return all;
}

/// The node's jets at `time` (s) in as many steps as `steps` says; what happens at a switch has happened when
/// `time` has come to it.
template <class T>
void run_node(NodeCase<T>& c, std::span<const double> steps, double time, std::span<JointJet<T>> out) {
  c.node->now = 0;
  c.node->begin();
  std::size_t next = 0, step = 0;
  double left = steps.empty() ? time : steps[0];
  while (c.node->now < time || (next < c.switches.size() && c.switches[next] <= time)) {
    const double goal = next < c.switches.size() && c.switches[next] <= time ? c.switches[next] : time;
    const double h = std::min(goal - c.node->now, left);
    c.node->step(h);
    left -= h;
    if (left <= 0) left = ++step < steps.size() ? steps[step] : time;
    if (goal - c.node->now > 1e-13) continue;
    c.node->now = goal;  // but for rounding
    if (next < c.switches.size() && c.switches[next] == goal)
      c.node->change(static_cast<int>(next++));
    else
      break;
  }
  c.node->pose(out);
}

}  // namespace sinew::fixtures
