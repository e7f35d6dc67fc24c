// Nodes that work on the joints of a rig: limbs that reach, heads that look, feet that stand, sides, sockets.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "animation/motion_node.h"
#include "sinew/animation/foot_placement_job.h"
#include "sinew/animation/inverse_kinematics.h"
#include "sinew/animation/look_at_job.h"
#include "sinew/animation/mirror_job.h"
#include "sinew/animation/model_motion_job.h"
#include "sinew/animation/quintic_offset.h"
#include "sinew/animation/smooth_input.h"
#include "sinew/animation/socket.h"

namespace sinew::fixtures {

/// A limb of 0.4 and 0.3 m below a moving root.
inline Clip limb_clip() {
  Clip clip = random_clip({.joints = 4, .duration = 4, .knot_interval = 0.5f, .moving = 1, .seed = 9});
  clip.constants[1].translation << 0.1f, 0, 0;
  clip.constants[2].translation << 0, 0, -0.4f;
  clip.constants[3].translation << 0, 0, -0.3f;
  return clip;
}
template <class T>
struct LimbNode : MotionNode<T> {
  static constexpr int kUpper = 1, kMiddle = 2, kEnd = 3;
  Clip clip = limb_clip();
  std::vector<int> parents{-1, 0, 1, 2};
  LimbNode() : MotionNode<T>(4) {}
};

/// Reaches for a target that jumps: the jump is taken up by an offset.
template <class T>
struct ReachNode : LimbNode<T> {
  int reached = 0;
  TimeJet<T> offset[3];  ///< where it began
  T elapsed = 0;
  void begin() override {
    reached = 0;
    elapsed = 1;
    for (auto& x : offset) x = TimeJet<T>(T(0));
  }
  void step(double h) override {
    this->now += h;
    elapsed += T(h);
  }
  static Vec3<T> direction(int k) {
    return k == 0 ? Vec3<T>(T(0.12), T(0.36), T(-0.24)) : Vec3<T>(T(0.3), T(-0.1), T(-0.3));
  }
  QuinticOffset<T> fade() const { return QuinticOffset<T>::at(elapsed, T(0.4)); }
  void change(int k) override {
    if (k > 1) return;
    const QuinticOffset<T> left = fade();
    for (int a = 0; a < 3; ++a) {
      offset[a] = left(offset[a]);
      offset[a].value += direction(reached)[a] - direction(1 - reached)[a];
    }
    elapsed = 0;
    reached = 1 - reached;
  }
  void pose(std::span<JointJet<T>> out) override {
    sample<T>(this->clip, this->now, out);
    TwoBoneJob<T> job;
    job.parents = this->parents;
    job.jets = out;
    job.upper = this->kUpper;
    job.middle = this->kMiddle;
    job.end = this->kEnd;
    job.target = model_motion<T>(out, this->parents, this->kUpper).translation;
    for (int a = 0; a < 3; ++a) job.target[a] += TimeJet<T>(direction(reached)[a]) + fade()(offset[a]);
    job.pole = still<T>({T(1), T(0.2), T(0.4)});
    (void)job.Run();
  }
};

/// Looks at a target that the game moves in steps, through filters.
template <class T>
struct LookNode : LimbNode<T> {
  SmoothInput<T> target[3];
  Vec3<T> goal;
  void begin() override {
    goal = {2, T(0.5), 1};
    for (int a = 0; a < 3; ++a) target[a].x = TimeJet<T>(goal[a]);
  }
  void step(double h) override {
    this->now += h;
    for (int a = 0; a < 3; ++a) target[a].step(goal[a], SmoothInput<T>::pole_of(T(0.15)), T(h));
  }
  void change(int k) override { goal = k == 0 ? Vec3<T>(2, 2, T(0.5)) : Vec3<T>(2, -1, 1); }
  void pose(std::span<JointJet<T>> out) override {
    sample<T>(this->clip, this->now, out);
    AimJob<T> job{this->parents, out, this->kEnd};
    for (int a = 0; a < 3; ++a) job.target[a] = target[a].x;
    job.limit = T(3.1);
    (void)job.Run();
  }
};

/// Three joints that look at one target after the other, with a weight that sways.
template <class T>
struct LookChainNode : LimbNode<T> {
  LookChain<T> chain;
  LookState<T> state;
  int looked_at = 0;
  T since = 0;  ///< s
  std::vector<JointJet<T>> scratch = std::vector<JointJet<T>>(4);
  LookChainNode() {
    chain.count = 3;
    for (int k = 0; k < 3; ++k) chain.joints[k] = k + 1;
    chain.shares[0] = T(0.2);
    chain.shares[1] = T(0.3);
    chain.shares[2] = T(0.5);
    chain.base = 0;
    chain.axis = Vec3<T>(T(0.8), T(-0.6), 0);
  }
  void begin() override {
    state = {};
    looked_at = 0;
    since = 0;
    run(scratch, state, nullptr);
  }
  void step(double h) override {
    this->now += h;
    since += T(h);
  }
  void change(int k) override {
    const MovingVector<T> before = target();
    if (k < 2) looked_at = k + 1;
    run(scratch, state, k < 2 ? &before : nullptr);
    since = 0;
  }
  MovingVector<T> target() const {
    const double t = this->now;
    const TimeJet<T> up(T(std::sin(3 * t)), T(3 * std::cos(3 * t)), T(-9 * std::sin(3 * t)));
    if (looked_at == 1) return {TimeJet<T>(T(2)), TimeJet<T>(T(-2)), up};
    return {TimeJet<T>(T(looked_at == 0 ? 2 : -1)), TimeJet<T>(T(1)), up};
  }
  void run(std::span<JointJet<T>> out, LookState<T>& look, const MovingVector<T>* before) {
    sample<T>(this->clip, this->now, out);
    LookAtJob<T> job;
    job.parents = this->parents;
    job.jets = out;
    job.chain = &chain;
    job.state = &look;
    job.target = target();
    job.before = before;
    job.weight = swaying_weight<T>(this->now, 0.6, 0.3, 1);
    job.step = since;
    (void)job.Run();
  }
  void pose(std::span<JointJet<T>> out) override {
    LookState<T> copy = state;
    run(out, copy, nullptr);
  }
};

/// A foot on a body that rocks: it comes down, leaves, and finds other ground.
template <class T>
struct FootNode : LimbNode<T> {
  FootState<T> state;
  GroundHit<T> local{{T(0), T(0), T(-0.78)}, Vec3<T>(T(0.2), T(-0.1), T(1)).normalized(), 0};
  T contact = 0, since = 0;  ///< s, since the state was moved on
  std::vector<JointJet<T>> scratch = std::vector<JointJet<T>>(4);
  void begin() override {
    state = {};
    contact = since = 0;
    local.normal = Vec3<T>(T(0.2), T(-0.1), T(1)).normalized();
    run(scratch, state);
  }
  void step(double h) override {
    this->now += h;
    since += T(h);
  }
  void change(int k) override {
    if (k == 0) contact = 1;
    if (k == 2) contact = 0;
    if (k == 4) local.normal = Vec3<T>(T(-0.3), T(0.1), T(1)).normalized();
    run(scratch, state);
    since = 0;
  }
  MovingTransform<T> ground() const {
    JointJet<T> jet;
    const T a = T(0.3 * std::sin(2 * this->now)), v = T(0.6 * std::cos(2 * this->now));
    jet.rotation = rotation_exp<T>({a, 0, 0});
    jet.omega << v, 0, 0;
    jet.alpha << -4 * a, 0, 0;
    jet.translation << 0, a, 0;
    jet.velocity << 0, v, 0;
    jet.acceleration << 0, -4 * a, 0;
    return moving_transform(jet);
  }
  void run(std::span<JointJet<T>> out, FootState<T>& foot) {
    sample<T>(this->clip, this->now, out);
    const MovingTransform<T> body[] = {ground()};
    const JointJet<T> place = joint_jet(body[0]);
    const GroundHit<T> hit[] = {
        {place.rotation * local.point + place.translation, place.rotation * local.normal, 0}};
    const FootInput<T> input[] = {{contact, hit, {}}};
    const Vec3<T> toe(T(0.1), 0, T(-0.05));
    const FootLeg<T> leg[] = {{this->kUpper, this->kMiddle, this->kEnd, toe, toe, Vec3<T>::UnitX()}};
    FootPlacementJob<T> job;
    job.parents = this->parents;
    job.jets = out;
    job.legs = leg;
    job.feet = input;
    job.states = {&foot, 1};
    job.grounds = body;
    job.level = TimeJet<T>(T(-0.75));
    job.step = since;
    job.settings.farthest = T(10);
    (void)job.Run();
  }
  void pose(std::span<JointJet<T>> out) override {
    FootState<T> copy = state;
    run(out, copy);
  }
};

/// All joints in model space, and in place of the last one what hangs in a socket of it.
template <class T>
struct ModelMotionNode : MotionNode<T> {
  Clip clip = node_clip(1), carrier = node_clip(2);
  std::vector<int> parents = {-1, 0, 1, 2, 3, 4, 2, 6, 0, 8, 9};
  std::vector<JointJet<T>> place = std::vector<JointJet<T>>(kNodeJoints);
  std::vector<MovingTransform<T>> model = std::vector<MovingTransform<T>>(kNodeJoints);
  void pose(std::span<JointJet<T>> out) override {
    sample<T>(carrier, this->now, place);
    sample<T>(clip, this->now, out);
    (void)ModelMotionJob<T>{parents, out, moving_transform(place[0]), model}.Run();
    for (std::size_t j = 0; j < out.size(); ++j) out[j] = joint_jet(model[j]);
    const Socket<T> palm{10, {rotation_exp<T>({T(0.3), 0, T(1)}), {T(0.1), 0, T(0.05)}}};
    const Transform<T> handle{rotation_exp<T>({0, T(0.8), 0}), {0, T(0.2), 0}};
    out[10] =
        joint_jet(attached<T>(socket_motion<T>(palm, std::span<const MovingTransform<T>>(model)), handle));
  }
};

/// Mirrored on a rig whose sides differ: two limbs with axes of their own, a sword in one.
inline Skeleton lopsided_rig() {
  constexpr int kParents[] = {-1, 0, 1, 2, 3, 0, 5, 6, 7, 7, 9};
  constexpr const char* kNames[] = {"root",   "thigh_l", "shin_l", "foot_l", "toes_l", "thigh_r",
                                    "shin_r", "foot_r",  "toes_r", "sword",  "tip"};
  Skeleton s;
  s.joints.resize(kNodeJoints);
  for (int i = 0; i < kNodeJoints; ++i) {
    Joint& joint = s.joints[std::size_t(i)];
    joint.name = kNames[i];
    joint.parent = kParents[i];
    joint.rest = {rotation_exp<double>({0.3 * i, -0.2, 0.1 * i}), {0.1, 0.05 * i, -0.2}};
  }
  return s;
}
template <class T>
struct MirrorNode : MotionNode<T> {
  Clip clip = node_clip(1);
  MirrorMap<T> map;
  MirrorNode() { (void)build_mirror_map<T>(lopsided_rig(), map); }
  void pose(std::span<JointJet<T>> out) override {
    sample<T>(clip, this->now, out);
    (void)MirrorJob<T>{&map, out, out}.Run();
  }
};

}  // namespace sinew::fixtures
