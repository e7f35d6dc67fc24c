// Rows 24–28: closed loops, redundant and singular ones.
#include <algorithm>
#include <cmath>

#include "sinew/skeleton/rotation.h"
#include "study/bodies.h"
#include "study/hard_case.h"
#include "study/linkage.h"

namespace sinew::study {
namespace {

using V = Vec3<double>;

constexpr double kClosure = 5e-4;  ///< m

/// The benchmarks' gravity is along −y, without a floor.
WorldSettings benchmark() {
  WorldSettings settings;
  settings.ground = false;
  settings.gravity = {0, -9.81, 0};
  return settings;
}

/// Ties a point of a body to where it is in the world at the reference pose.
template <class T>
void tie(Stage<T>& stage, const Linkage& linkage, LoopKind kind, int body, const V& point,
         const V& axis = V::UnitZ()) {
  LoopSettings loop;
  loop.kind = kind;
  loop.a = linkage.anchor(body, point);
  loop.b.frame.translation = point;
  loop.a.frame.rotation = loop.b.frame.rotation = Quat<double>::FromTwoVectors(V::UnitZ(), axis);
  Status status;
  stage.world().add_loop(loop, status);
  if (!status) stage.refuse(status.reason);
}

/// Largest gap and force of the first `count` loops now.
template <class T>
double widest_gap(Stage<T>& stage, int count) {
  double gap = 0;
  for (int n = 0; n < count; ++n) gap = std::max(gap, stage.world().loop_gap(n));
  return gap;
}
template <class T>
double largest_force(Stage<T>& stage, int count) {
  double force = 0;
  for (int n = 0; n < count; ++n) force = std::max(force, double(stage.world().loop_force(n).norm()));
  return force;
}

/// Five bars of square section 0.1 m, the sixth hinge closes the loop (assets of IFToMM/UDC benchmark A04).
Linkage bricard() {
  Linkage l;
  const V ends[] = {{0, 0, 0}, {1, 0, 0}, {1, -1, 0}, {1, -1, 1}, {0, -1, 1}, {0, 0, 1}};
  const V axes[] = {V::UnitY(), V::UnitZ(), V::UnitX(), V::UnitY(), V::UnitZ()};
  for (int n = 0; n < 5; ++n) {
    const V along = ends[n + 1] - ends[n];
    const V size = V::Constant(0.1) + 0.9 * along.cwiseAbs();
    const Mat3<double> inertia = box_inertia(1, size).asDiagonal();
    l.add(n - 1, JointType::kRevolute, ends[n], axes[n], 1, ends[n] + along / 2, inertia);
  }
  return l;
}

template <class T>
Verdict bricard_loop(const Trial& t) {
  const Linkage linkage = bricard();
  Stage<T> stage(benchmark());
  stage.add(linkage.skeleton, limp());
  tie(stage, linkage, LoopKind::kHinge, 4, {0, 0, 1}, V::UnitX());
  double gap = 0, furthest = 0;
  const V start = stage.character(0).model()[1].template cast<double>() * V(0, -1, 0);
  stage.run(t.lasting(10, 3), t.h, [&](double) {
    gap = std::max(gap, widest_gap(stage, 1));
    const V p3 = stage.character(0).model()[1].template cast<double>() * V(0, -1, 0);
    furthest = std::max(furthest, (p3 - start).norm());
  });
  Verdict v(stage.measured());
  v.general();
  v.at_most("closure (m)", gap, kClosure);
  v.at_least("way of P3 (m)", furthest, 0.5);
  return v;
}

/// N windows of 1 m bars side by side, upright; rockers after the first close a loop with the ground.
Linkage four_bars(int windows) {
  Linkage l;
  int rocker = l.add_rod(-1, JointType::kRevolute, {0, 0, 0}, {0, 1, 0}, V::UnitZ(), 1);
  for (int n = 1; n <= windows; ++n) {
    const int coupler =
        l.add_rod(rocker, JointType::kRevolute, {n - 1.0, 1, 0}, {double(n), 1, 0}, V::UnitZ(), 1);
    rocker = l.add_rod(coupler, JointType::kRevolute, {double(n), 1, 0}, {double(n), 0, 0}, V::UnitZ(), 1);
  }
  return l;
}

template <class T>
Verdict n_four_bar(const Trial& t) {
  Measurement measured;
  double gap = 0, spike = 0;
  for (const int windows : {2, 40}) {
    // A float's digits do not reach along 81 bars to closures of 0.1 mm: 3 % of such steps do not converge.
    if (sizeof(T) == sizeof(float) && windows > 2) continue;
    const Linkage linkage = four_bars(windows);
    Stage<T> stage(benchmark());
    std::vector<JointJet<T>> jets = rest_jets<T>(linkage.skeleton);
    for (std::size_t i = 0; i < jets.size(); ++i) jets[i].omega = {0, 0, T(i % 2 == 0 ? -1 : 1)};
    stage.add(linkage.skeleton, limp(), jets);
    for (int n = 1; n <= windows; ++n) tie(stage, linkage, LoopKind::kPoint, 2 * n, {double(n), 0, 0});
    double before = 0, now = 0;
    stage.run(t.lasting(10, windows == 2 ? 3 : 1), t.h, [&](double) {
      gap = std::max(gap, widest_gap(stage, windows));
      const double next = largest_force(stage, windows);
      // Against the frames around it, or the bars' weight where these are at rest.
      if (before > 0) spike = std::max(spike, now / std::max({before, next, 2 * windows * 9.81}));
      before = now;
      now = next;
    });
    measured.merge(stage.measured());
  }
  Verdict v(measured);
  v.general();
  v.at_most("closure (m)", gap, kClosure);
  v.at_most("force against its neighbours in time", spike, 3);
  return v;
}

template <class T>
Verdict singular_four_bar(const Trial& t) {
  // Folded flat: all bars on one line, at rest, at the point where two branches meet.
  Linkage l;
  const int crank = l.add_rod(-1, JointType::kRevolute, {0, 0, 0}, {1, 0, 0}, V::UnitZ(), 1);
  const int coupler = l.add_rod(crank, JointType::kRevolute, {1, 0, 0}, {3, 0, 0}, V::UnitZ(), 2);
  const int rocker = l.add_rod(coupler, JointType::kRevolute, {3, 0, 0}, {2, 0, 0}, V::UnitZ(), 1);
  Stage<T> stage(benchmark());
  stage.add(l.skeleton, limp());
  tie(stage, l, LoopKind::kPoint, rocker, {2, 0, 0});
  double gap = 0, force = 0;
  stage.run(t.lasting(10, 3), t.h, [&](double) {
    gap = std::max(gap, widest_gap(stage, 1));
    force = std::max(force, largest_force(stage, 1));
  });
  Verdict v(stage.measured());
  v.general();
  v.at_most("closure (m)", gap, kClosure);
  v.at_most("force, in weights", force / (4 * 9.81), 30);
  return v;
}

/// A wheel on a fixed axle and two arms from a fixed torso, hands on its rim, 0.25 m off the axle.
struct Driver {
  Linkage wheel, arms;
  int hand[2] = {0, 0};
  V grip[2] = {{0.4, 0.25, 0}, {0.4, -0.25, 0}};
};

Driver driver() {
  Driver d;
  Mat3<double> rim = V(0.06, 0.03, 0.03).asDiagonal();
  d.wheel.add(-1, JointType::kRevolute, {0.4, 0, 0}, V::UnitX(), 2, {0.4, 0, 0}, rim);
  for (const int side : {0, 1}) {
    const double y = side == 0 ? 0.2 : -0.2;
    const V shoulder(0, y, 0.3), elbow(0.1, 1.8 * y, 0.05), wrist(0.36, 1.2 * y, 0);
    const int upper = d.arms.add_rod(-1, JointType::kBall, shoulder, elbow, V::UnitY(), 2, 0.04);
    const int fore = d.arms.add_rod(upper, JointType::kRevolute, elbow, wrist, V::UnitY(), 1.5, 0.03);
    d.hand[side] = d.arms.add(fore, JointType::kBall, wrist, V::UnitY(), 0.5, d.grip[side],
                              V::Constant(8e-4).asDiagonal());
  }
  return d;
}

template <class T>
Verdict hands_on_a_wheel(const Trial& t) {
  const Driver d = driver();
  WorldSettings settings;
  settings.ground = false;
  Stage<T> stage(settings);
  stage.add(d.wheel.skeleton, limp());
  stage.add(d.arms.skeleton, limp());
  for (const int side : {0, 1}) {
    LoopSettings loop;
    loop.kind = LoopKind::kWeld;
    loop.a = d.arms.anchor(d.hand[side], d.grip[side], 1);
    loop.b = d.wheel.anchor(0, d.grip[side], 0);
    Status status;
    stage.world().add_loop(loop, status);
    if (!status) stage.refuse(status.reason);
  }
  double gap = 0;
  int frame = 0;
  stage.run(t.lasting(60, 5), t.h, [&](double) {
    gap = std::max(gap, widest_gap(stage, 2));
    // Steering left and right: a push of 1 N s up one side of the rim every half second.
    const int every = std::max(1, static_cast<int>(0.5 / t.h));
    if (frame++ % every == 0) {
      const V at = stage.character(0).model()[0].template cast<double>() * V(0, 0.25, 0);
      stage.push(0, 0, at, {0, 0, (frame / every) % 2 == 0 ? 1.0 : -1.0});
    }
  });
  Verdict v(stage.measured());
  v.general();
  v.at_most("closure (m)", gap, kClosure);
  return v;
}

template <class T>
Verdict weld_declared_thrice(const Trial& t) {
  std::vector<V> path[2];
  Measurement measured;
  double gap = 0;
  for (const int times : {1, 3}) {
    // Two rods welded end to end, the first on a hinge.
    Linkage l;
    l.add_rod(-1, JointType::kRevolute, {0, 0, 0}, {1, 0, 0}, V::UnitZ(), 1);
    Linkage other;
    other.add_rod(-1, JointType::kFree, {1, 0, 0}, {1, 1, 0}, V::UnitZ(), 1);
    Stage<T> stage(benchmark());
    stage.add(l.skeleton, limp());
    stage.add(other.skeleton, limp());
    for (int n = 0; n < times; ++n) {
      LoopSettings loop;
      loop.kind = LoopKind::kWeld;
      loop.a = l.anchor(0, {1, 0, 0}, 0);
      loop.b = other.anchor(0, {1, 0, 0}, 1);
      Status status;
      stage.world().add_loop(loop, status);
      if (!status) stage.refuse(status.reason);
    }
    stage.run(t.lasting(5, 3), t.h, [&](double) {
      gap = std::max(gap, widest_gap(stage, times));
      path[times == 1 ? 0 : 1].push_back(stage.character(1).model()[0].template cast<double>() * V(0, 1, 0));
    });
    measured.merge(stage.measured());
  }
  double apart = 0, way = 0;
  for (std::size_t n = 0; n < std::min(path[0].size(), path[1].size()); ++n) {
    apart = std::max(apart, (path[0][n] - path[1][n]).norm());
    if (n > 0) way += (path[0][n] - path[0][n - 1]).norm();
  }
  Verdict v(measured);
  v.general();
  v.at_most("closure (m)", gap, kClosure);
  v.at_most("motion apart, share of the way", apart / way, 1e-3);
  return v;
}

}  // namespace

std::vector<HardCase> loop_cases() {
  return {
      {"bricard_loop",
       "24",
       "seed paper",
       "closure below 0.5 mm",
       {1.0 / 60, 1.0 / 240},
       bricard_loop<float>,
       bricard_loop<double>},
      {"n_four_bar",
       "25",
       "MBSbenchmarksInOpenSim A02",
       "no spike at the dead point; N = 40 in double only",
       {1.0 / 60, 1.0 / 240},
       n_four_bar<float>,
       n_four_bar<double>},
      {"singular_four_bar",
       "26",
       "mujoco#172; EXUDYN#39",
       "finite forces",
       {1.0 / 60, 1.0 / 240},
       singular_four_bar<float>,
       singular_four_bar<double>},
      {"hands_on_a_wheel",
       "27",
       "seed paper",
       "closure below 0.5 mm for 60 s",
       {1.0 / 60},
       hands_on_a_wheel<float>,
       hands_on_a_wheel<double>},
      {"weld_declared_thrice",
       "28",
       "seed talk; arXiv 1905.10828",
       "motion as with one to 1e-3",
       {1.0 / 60},
       weld_declared_thrice<float>,
       weld_declared_thrice<double>},
  };
}

}  // namespace sinew::study
