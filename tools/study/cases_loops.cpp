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

/// Largest gap (from poses) and force of the first `count` loops now.
template <class T>
double widest_gap(Stage<T>& stage, int count) {
  double gap = 0;
  for (int n = 0; n < count; ++n) gap = std::max(gap, stage.loop_gap(n));
  return gap;
}
template <class T>
double largest_force(Stage<T>& stage, int count) {
  double force = 0;
  for (int n = 0; n < count; ++n) force = std::max(force, double(stage.world().loop_force(n).norm()));
  return force;
}

template <class T>
Verdict bricard_loop(const Trial& t) {
  Stage<T> stage(t.scene);
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

/// The scene's windows of 1 m bars side by side, upright, continued; rockers after the first close a loop
/// with the ground.
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

void continue_windows(scene::Scene& scene, int windows) {
  const Linkage linkage = four_bars(windows);
  scene::SceneCharacter& bars = scene.characters[0];
  skeleton_of(scene) = linkage.skeleton;
  bars.speeds.spin.clear();
  for (int i = 0; i < linkage.skeleton.body_count; ++i)
    bars.speeds.spin.emplace_back(i, V(0, 0, i % 2 == 0 ? -1 : 1));
  scene.loops.clear();
  for (int n = 1; n <= windows; ++n) {
    LoopSettings loop;
    loop.kind = LoopKind::kPoint;
    loop.a = linkage.anchor(2 * n, {double(n), 0, 0});
    loop.b.frame.translation = {double(n), 0, 0};
    scene.loops.push_back(loop);
  }
}

template <class T>
Verdict n_four_bar(const Trial& t) {
  Measurement measured;
  double gap = 0, spike = 0;
  for (const int windows : {2, 40}) {
    scene::Scene scene = t.scene;
    if (windows > 2) continue_windows(scene, windows);
    Stage<T> stage(scene);
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
  Stage<T> stage(t.scene);
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

template <class T>
Verdict hands_on_a_wheel(const Trial& t) {
  Stage<T> stage(t.scene);
  double gap = 0;
  stage.run(t.lasting(60, 5), t.h, [&](double) { gap = std::max(gap, widest_gap(stage, 2)); });
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
    scene::Scene scene = t.scene;
    scene.loops.resize(static_cast<std::size_t>(times));
    Stage<T> stage(scene);
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
       "no spike at the dead point, N = 2 and 40",
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
