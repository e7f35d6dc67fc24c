#include "study/accuracy_trip.h"

#include <algorithm>
#include <cmath>

#include "study/accuracy_clock.h"
#include "study/bodies.h"

namespace sinew::study {
namespace {

constexpr double kFrame = 1.0 / 60;     // s
constexpr double kSample = 1.0 / 30;    // s, between compared poses; every step of the sweep divides it
constexpr double kFinest = 1.0 / 7680;  // s, of converged runs
constexpr double kAtRest = 6;           // s after which a scene that settles has settled

Accuracy tight() {
  Accuracy a;
  a.tolerance = 1e-9;
  return a;
}

/// Mean over joints of squared angles between two poses of a figure, rad².
double mean_square_angle(const Skeleton& skeleton, const std::vector<Transform<double>>& a,
                         const std::vector<Transform<double>>& b) {
  double sum = 0;
  int joints = 0;
  for (int i = 0; i < skeleton.body_count; ++i) {
    const int parent = skeleton.joints[i].parent;
    if (parent < 0) continue;
    const Quat<double> in_a = a[parent].rotation.conjugate() * a[i].rotation,
                       in_b = b[parent].rotation.conjugate() * b[i].rotation;
    sum += std::pow(in_a.angularDistance(in_b), 2);
    ++joints;
  }
  return joints ? sum / joints : 0;
}

/// What is shown between two steps of 1/15 s.
std::vector<std::vector<Transform<double>>> halfway(const std::vector<std::vector<Transform<double>>>& a,
                                                    const std::vector<std::vector<Transform<double>>>& b) {
  std::vector<std::vector<Transform<double>>> out = a;
  for (std::size_t f = 0; f < out.size(); ++f)
    for (std::size_t i = 0; i < out[f].size(); ++i) {
      out[f][i].rotation = a[f][i].rotation.slerp(0.5, b[f][i].rotation);
      out[f][i].translation = (a[f][i].translation + b[f][i].translation) / 2;
    }
  return out;
}

}  // namespace

FrameCosts frame_costs(const std::vector<std::vector<double>>& runs) {
  constexpr double kShare = 0.99;
  FrameCosts costs;
  std::size_t count = runs.empty() ? 0 : runs[0].size();
  for (const std::vector<double>& run : runs) count = std::min(count, run.size());
  if (count == 0) return costs;
  std::vector<double> frames, of_one;
  for (std::size_t n = 0; n < count; ++n) {
    of_one.clear();
    for (const std::vector<double>& run : runs) of_one.push_back(run[n]);
    std::nth_element(of_one.begin(), of_one.begin() + of_one.size() / 2, of_one.end());
    frames.push_back(of_one[of_one.size() / 2]);
    costs.mean += frames.back() / double(count);
  }
  std::sort(frames.begin(), frames.end());
  const double at = kShare * double(count - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, count - 1);
  costs.p99 = frames[below] + (at - double(below)) * (frames[above] - frames[below]);
  costs.worst = frames.back();
  return costs;
}

Trip travel(const AccuracyScene& s, const EngineOption& with, double h, const Accuracy& accuracy,
            bool observe) {
  Trip trip;
  const std::unique_ptr<Engine> engine = with.make(s.scene, h, accuracy);
  trip.refusal = engine->refusal();
  if (!trip.refusal.empty()) return trip;
  const int steps = static_cast<int>(std::lround(s.seconds / h)),
            every = std::max(1, static_cast<int>(std::lround(kSample / h))),
            per_frame = std::max(1, static_cast<int>(std::lround(kFrame / h)));
  trip.frames.assign((steps + per_frame - 1) / per_frame, 0);
  const double start = engine->energy();
  double kinetic = 0, fall = 0;  // J: of the start, and of a metre's fall where that is at rest
  for (const Figure& f : s.scene.figures) {
    kinetic += energy_of(f.skeleton, f.jets, Vec3<double>(0, 0, 0)).kinetic;
    fall += f.skeleton.total_mass() * s.scene.gravity.norm();
  }
  Vec3<double> spin = Vec3<double>::Zero(), spin_before = spin;
  const bool keeps_spin = !s.scene.ground && s.scene.gravity.isZero();
  for (int n = 0; n < steps; ++n) {
    if (s.drive) s.drive(*engine, n * h, h);
    const double begin = processor_seconds();
    const bool alive = engine->step();
    trip.frames[n / per_frame] += std::max(0.0, processor_seconds() - begin - clock_cost());
    if (!alive) return trip;
    if (!observe) continue;
    if (keeps_spin && engine->angular_momentum(spin)) {
      if (n == 0) spin_before = spin;
      trip.momentum = std::max(trip.momentum, (spin - spin_before).norm() / spin_before.norm());
    }
    if (!(s.settles ? n + 1 == steps : (n + 1) % every == 0)) continue;
    std::vector<std::vector<Transform<double>>> poses;
    for (std::size_t f = 0; f < s.scene.figures.size(); ++f)
      poses.push_back(engine->pose(static_cast<int>(f)));
    if (h > 1.01 * kSample)
      trip.track.push_back(halfway(trip.track.empty() ? poses : trip.track.back(), poses));
    trip.track.push_back(std::move(poses));
  }
  trip.energy = (engine->energy() - start) / std::max(kinetic, fall);
  for (double& frame : trip.frames) trip.seconds += frame /= engine->copies();
  trip.passes = engine->passes();
  trip.survived = true;
  return trip;
}

Track converged(const AccuracyScene& s, const EngineOption& with, bool coarse) {
  if (!s.settles) return travel(s, with, coarse ? 2 * kFinest : kFinest, tight(), true).track;
  AccuracyScene resting = s;
  resting.seconds = kAtRest;
  return travel(resting, with, 1.0 / 240, tight(), true).track;
}

double apart(const AccuracyScene& s, const Track& a, const Track& b) {
  double most = 0;
  for (std::size_t n = 0; n < std::min(a.size(), b.size()); ++n) {
    double sum = 0, mass = 0;
    for (std::size_t f = 0; f < s.scene.figures.size(); ++f) {
      const Skeleton& skeleton = s.scene.figures[f].skeleton;
      sum += skeleton.total_mass() * std::pow(displacement(skeleton, a[n][f], b[n][f]), 2);
      mass += skeleton.total_mass();
    }
    most = std::max(most, std::sqrt(sum / mass));
  }
  return most;
}

double degrees_apart(const AccuracyScene& s, const Track& a, const Track& b) {
  double most = 0;
  for (std::size_t n = 0; n < std::min(a.size(), b.size()); ++n)
    for (std::size_t f = 0; f < s.scene.figures.size(); ++f)
      most = std::max(most, mean_square_angle(s.scene.figures[f].skeleton, a[n][f], b[n][f]));
  return std::sqrt(most) * 180 / 3.14159265358979323846;
}

double displacement(const Skeleton& skeleton, const std::vector<Transform<double>>& a,
                    const std::vector<Transform<double>>& b) {
  double sum = 0;
  for (int i = 0; i < skeleton.body_count; ++i) {
    const Joint& joint = skeleton.joints[i];
    const Mat3<double> second = 0.5 * joint.inertia.trace() * Mat3<double>::Identity() - joint.inertia;
    const Mat3<double> turned = a[i].rotation.toRotationMatrix() - b[i].rotation.toRotationMatrix();
    sum += joint.mass * (a[i] * joint.center_of_mass - b[i] * joint.center_of_mass).squaredNorm() +
           (turned * second * turned.transpose()).trace();
  }
  return std::sqrt(std::max(0.0, sum) / skeleton.total_mass());
}

}  // namespace sinew::study
