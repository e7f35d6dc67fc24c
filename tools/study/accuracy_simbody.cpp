// Simbody (Debian's libsimbody-dev) on the study's scenes of hinges in free motion. It chooses its steps
// itself: its points are accuracies, not step sizes.
#include <dlfcn.h>

#include <algorithm>
#include <cmath>

#include "study/accuracy_trip.h"
#include "study/tables/peers/simbody_run.h"

namespace sinew::study {
namespace {

using Simulate = decltype(&sinew_simulate_with_simbody);

/// The module's entry, loaded once; nullptr where it cannot be.
Simulate simbody() {
  static const Simulate entry = [] {
    void* module = dlopen(SINEW_SIMBODY_MODULE, RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND);
    return module ? reinterpret_cast<Simulate>(dlsym(module, "sinew_simulate_with_simbody")) : nullptr;
  }();
  return entry;
}

std::string refusal_of(const AccuracyScene& s) {
  for (const Figure& f : s.scene.figures) {
    if (f.driven || (s.scene.ground && !f.skeleton.colliders.empty()))
      return "its contacts and muscles are not written here";
    for (const Joint& joint : f.skeleton.joints)
      if (joint.type != JointType::kRevolute) return "hinges alone are written for it";
  }
  return simbody() ? "" : "it cannot be loaded";
}

/// The figure as the mechanism that the reference family simulates too: axes of the rest pose.
multibody::Mechanism mechanism_of(const Figure& f, const Vec3<double>& gravity) {
  multibody::Mechanism m;
  m.gravity = gravity;
  std::vector<Vec3<double>> at;
  for (int i = 0; i < f.skeleton.body_count; ++i) {
    const Joint& joint = f.skeleton.joints[i];
    at.emplace_back(joint.rest.translation + (joint.parent < 0 ? Vec3<double>(0, 0, 0) : at[joint.parent]));
    multibody::Body& body = m.bodies.emplace_back();
    body.mass = joint.mass;
    body.center_of_mass = at[i] + joint.center_of_mass;
    body.inertia = joint.inertia;
    multibody::HingeOrSlider& hinge = m.joints.emplace_back();
    hinge.parent = joint.parent;
    hinge.child = i;
    hinge.anchor = at[i];
    hinge.axis = joint.axis;
    const Quat<double>& turned = f.jets[i].rotation;
    hinge.q0 = 2 * std::atan2(turned.vec().dot(joint.axis), turned.w());
    hinge.qd0 = f.jets[i].omega.dot(joint.axis);
  }
  return m;
}

std::vector<Transform<double>> pose_of(const Skeleton& skeleton, const std::vector<double>& q) {
  std::vector<Transform<double>> out;
  for (int i = 0; i < skeleton.body_count; ++i) {
    const Joint& joint = skeleton.joints[i];
    const Transform<double> local{Quat<double>(Eigen::AngleAxisd(q[i], joint.axis)), joint.rest.translation};
    out.push_back(joint.parent < 0 ? local : out[joint.parent] * local);
  }
  return out;
}

Trip travel_with_simbody(const AccuracyScene& s, bool cpodes, double accuracy) {
  const Figure& figure = s.scene.figures[0];
  SimbodyRun run;
  run.cpodes = cpodes;
  run.accuracy = accuracy;
  const int samples = static_cast<int>(std::lround(30 * s.seconds));
  for (int n = 1; n <= samples; ++n) run.instants.push_back(n / 30.0);
  simbody()(mechanism_of(figure, s.scene.gravity), run);
  Trip trip;
  trip.survived = run.stopped.empty();
  trip.seconds = run.seconds;
  for (const std::vector<double>& row : run.rows) trip.track.push_back({pose_of(figure.skeleton, row)});
  return trip;
}

}  // namespace

std::vector<AccuracyPoint> simbody_points(const AccuracyScene& s, int runs) {
  std::vector<AccuracyPoint> points;
  const std::string refusal = refusal_of(s);
  const Track truth = refusal.empty() ? travel_with_simbody(s, false, 1e-12).track : Track();
  for (const bool cpodes : {false, true})
    for (const double accuracy : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8}) {
      AccuracyPoint& p = points.emplace_back();
      p.engine = "Simbody";
      p.option = cpodes ? "CPodes" : "Runge-Kutta-Merson";
      p.varied = "step";
      p.accuracy.tolerance = accuracy;
      p.refusal = refusal;
      if (!refusal.empty()) continue;
      const Trip trip = travel_with_simbody(s, cpodes, accuracy);
      p.survived = trip.survived;
      if (!p.survived) continue;
      p.error = apart(s, trip.track, truth);
      p.degrees = degrees_apart(s, trip.track, truth);
      std::vector<double> times;
      for (int n = 0; n < runs; ++n) times.push_back(travel_with_simbody(s, cpodes, accuracy).seconds);
      std::sort(times.begin(), times.end());
      const double frames = 60 * s.seconds;
      p.us = 1e6 * times[times.size() / 2] / frames;
      p.us_low = 1e6 * times[times.size() / 4] / frames;
      p.us_high = 1e6 * times[times.size() * 3 / 4] / frames;
    }
  return points;
}

}  // namespace sinew::study
