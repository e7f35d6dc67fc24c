// What makes or changes motions, as one kind of thing: it is begun, stepped and changed at known times, and
// gives jets.
#pragma once

#include <cmath>
#include <span>

#include "fixtures/clips.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/animation/time_jet.h"

namespace sinew::fixtures {

constexpr int kNodeJoints = 11;

/// Runs from time 0. What a game would do between two frames happens in `change`.
template <class T>
class MotionNode {
 public:
  explicit MotionNode(int joint_count = kNodeJoints) : joints(joint_count) {}
  virtual ~MotionNode() = default;
  virtual void begin() {}
  virtual void step(double h) { now += h; }
  virtual void change(int) {}
  virtual void pose(std::span<JointJet<T>> out) = 0;

  const int joints;
  double now = 0;  ///< s
};

/// A clip whose knots are half a second apart, so that differences of its poses are exact.
inline Clip node_clip(unsigned seed, bool loops = true) {
  return random_clip({.joints = kNodeJoints,
                      .duration = 4,
                      .knot_interval = 0.5f,
                      .loops = loops,
                      .moving = kNodeJoints,
                      .seed = seed});
}

template <class T>
void sample(const Clip& clip, const ClipTime& time, std::span<JointJet<T>> out) {
  (void)SamplingJob<T>{&clip, time, out}.Run();
}

template <class T>
TimeJet<T> swaying_weight(double t, double a, double b, double c) {
  return {T(a + b * std::sin(2 * t + c)), T(2 * b * std::cos(2 * t + c)), T(-4 * b * std::sin(2 * t + c))};
}

}  // namespace sinew::fixtures
