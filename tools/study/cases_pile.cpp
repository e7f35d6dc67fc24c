// Rows 15, 16, 34, 36, 62 and the off-plane figures: many bodies that touch each other.
#include <algorithm>
#include <cmath>

#include "study/bodies.h"
#include "study/hard_case.h"

namespace sinew::study {
namespace {

template <class T>
int add_prop_at(Stage<T>& stage, Shape shape, const Vec3<double>& size, double mass, const Vec3<double>& at) {
  PropSettings prop;
  prop.shape = shape;
  prop.size = size;
  prop.mass = mass;
  prop.pose.translation = at;
  return stage.add_prop(prop);
}

/// Largest speed of any prop over the last step, m/s.
template <class T>
double fastest_prop(Stage<T>& stage) {
  double fastest = 0;
  for (int p = 0; p < stage.world().prop_count(); ++p)
    fastest = std::max(fastest, double(stage.world().prop_velocity(p).norm()));
  return fastest;
}

template <class T>
Verdict heavy_on_light(const Trial& t) {
  Measurement measured;
  double penetration = 0;
  for (const double density : {5.0, 10.0, 50.0}) {
    Stage<T> stage(WorldSettings{});
    const Vec3<double> half = Vec3<double>::Constant(2.5);
    add_prop_at(stage, Shape::kBox, half, 125e3, {0, 0, 2.5});
    add_prop_at(stage, Shape::kBox, half, density * 125e3, {0, 0, 7.5});
    stage.run(3, t.h);
    for (int p = 0; p < 2; ++p) penetration = std::max(penetration, stage.world().prop_report(p).penetration);
    measured.merge(stage.measured());
  }
  Verdict v(measured);
  v.general();
  v.at_most("penetration after 3 s (m)", penetration, 2e-3);
  return v;
}

template <class T>
Verdict cube_under_100_kg(const Trial& t) {
  Measurement measured;
  double penetration = 0, fastest = 0;
  for (const double mass : {60.0, 100.0}) {
    Stage<T> stage(WorldSettings{});
    add_prop_at(stage, Shape::kBox, Vec3<double>::Constant(0.1), 1, {0, 0, 0.1});
    add_prop_at(stage, Shape::kBox, {0.3, 0.3, 0.2}, mass, {0, 0, 0.4});
    stage.run(2, t.h);
    fastest = std::max(fastest, fastest_prop(stage));
    for (int p = 0; p < 2; ++p) penetration = std::max(penetration, stage.world().prop_report(p).penetration);
    measured.merge(stage.measured());
  }
  Verdict v(measured);
  v.general();
  v.at_most("penetration (m)", penetration, 2e-3);
  v.at_most("speed after 2 s (m/s)", fastest, 0.01);
  return v;
}

template <class T>
Verdict box_tower(const Trial& t) {
  Stage<T> stage(WorldSettings{});
  for (int i = 0; i < 5; ++i) add_prop_at(stage, Shape::kBox, {0.25, 0.25, 0.1}, 5, {0, 0, 0.1 + 0.2 * i});
  stage.run(t.lasting(5, 3), t.h);
  Verdict v(stage.measured());
  v.general();
  v.at_most("speed at the end (m/s)", fastest_prop(stage), 0.01);
  v.at_most("top fell (m)", 0.9 - double(stage.world().prop_pose(4).translation.z()), 0.01);
  return v;
}

template <class T>
Verdict ball_pile(const Trial& t) {
  Stage<T> stage(WorldSettings{});
  const int n = t.quick ? 2 : 4;
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z)
        add_prop_at(stage, Shape::kSphere, Vec3<double>::Constant(0.5), 10,
                    {1.001 * x, 1.001 * y, 0.5 + 1.001 * z});
  stage.run(t.lasting(3, 1), t.h);
  Verdict v(stage.measured());
  v.general();
  v.at_most("penetration (m)", v.measured().penetration, 1e-3);
  return v;
}

/// Limp figures dropped one above the other.
template <class T>
Verdict figures_in_a_pile(const Trial& t) {
  Stage<T> stage(WorldSettings{});
  const int count = t.quick ? 2 : 5;
  for (int i = 0; i < count; ++i)
    add_thrown_humanoid(stage, 0.2 + 1.2 * i, 0.5, static_cast<unsigned>(i + 1));
  stage.run(t.lasting(8, 3), t.h);
  double fastest = 0;
  for (int i = 0; i < count; ++i)
    fastest = std::max(fastest, std::sqrt(2 * stage.character(i).report().kinetic_energy / 75));
  Verdict v(stage.measured());
  v.general();
  if (!t.quick) v.at_most("rms speed at the end (m/s)", fastest, 0.05);
  v.at_most("penetration (m)", v.measured().penetration, 5e-3);
  return v;
}

/// Figures flying into each other.
template <class T>
Verdict colliding_figures(const Trial& t) {
  Measurement measured;
  for (unsigned seed = 1; seed <= (t.quick ? 2u : 10u); ++seed) {
    Stage<T> stage(weightless());
    for (const double side : {1.0, -1.0}) {
      Skeleton body = chain({5, JointType::kBall, JointType::kFree, 0.35, 10, 3, 0.06, true});
      std::vector<JointJet<T>> jets = rest_jets<T>(body);
      randomise_speeds(body, jets, 1, seed + (side > 0 ? 100 : 200));
      jets[0].translation = Vec3<T>(T(-0.6 * side), T(0.03 * seed), T(0));
      jets[0].velocity = Vec3<T>(T(2 * side), 0, 0);
      stage.add(body, limp(), jets);
    }
    stage.run(1.5, t.h);
    measured.merge(stage.measured());
  }
  Verdict v(measured);
  v.general();
  v.at_most("largest rise in a step (J)", v.measured().worst_rise, 1e-3);
  return v;
}

/// A box thrown on its edges and corners.
template <class T>
Verdict tumbling_box(const Trial& t) {
  Measurement measured;
  for (unsigned seed = 1; seed <= (t.quick ? 5u : 40u); ++seed) {
    Stage<T> stage(WorldSettings{});
    Skeleton body = box_body(5, {0.3, 0.2, 0.1});
    std::vector<JointJet<T>> jets = rest_jets<T>(body);
    randomise_speeds(body, jets, 6, seed);
    jets[0].translation.z() = T(1);
    jets[0].velocity = Vec3<T>(2, 0, 0);
    stage.add(body, limp(), jets);
    stage.run(3, t.h);
    measured.merge(stage.measured());
  }
  Verdict v(measured);
  v.general();
  v.at_most("largest rise in a step (J)", v.measured().worst_rise, 1e-3);
  return v;
}

/// A limp figure falling over edges and corners of static boxes.
template <class T>
Verdict figure_on_stairs(const Trial& t) {
  Measurement measured;
  for (unsigned seed = 1; seed <= (t.quick ? 2u : 12u); ++seed) {
    Stage<T> stage(WorldSettings{});
    for (int i = 0; i < 5; ++i)
      stage.add_obstacle(obstacle_box({0.3 * i, 0, 0.1 * (5 - i) - 0.5}, {0.15, 1, 0.5}));
    add_thrown_humanoid(stage, 0.8, 2, seed);
    stage.run(3, t.h);
    measured.merge(stage.measured());
  }
  Verdict v(measured);
  v.general();
  v.at_most("largest rise in a step (J)", v.measured().worst_rise, 1e-3);
  return v;
}

template <class T>
Verdict crowd_of_200(const Trial& t) {
  Stage<T> stage(WorldSettings{});
  const int count = t.quick ? 40 : 200;
  for (int i = 0; i < count; ++i) {
    Skeleton body = chain({3, JointType::kBall, JointType::kFree, 0.3, 3, 1, 0.05, true});
    std::vector<JointJet<T>> jets = rest_jets<T>(body);
    const int column = i % 20, row = i / 20;
    jets[0].translation = Vec3<T>(T(3 * column), T(3 * row), T(1.2));
    stage.add(body, limp(), jets);
  }
  stage.run(t.lasting(4, 2), t.h);
  double lowest = 1;
  for (int i = 0; i < count; ++i)
    for (const Transform<T>& joint : stage.character(i).model())
      lowest = std::min(lowest, double(joint.translation.z()));
  Verdict v(stage.measured());
  v.general();
  v.at_least("lowest joint (m)", lowest, 0);
  return v;
}

}  // namespace

std::vector<HardCase> pile_cases() {
  return {
      {"heavy_on_light",
       "15",
       "Jolt HeavyOnLightTest",
       "penetration below 2 mm after 3 s",
       {1.0 / 60},
       heavy_on_light<float>,
       heavy_on_light<double>},
      {"cube_under_100_kg",
       "16",
       "godot-jolt#1041",
       "penetration below 2 mm, still after 2 s",
       {1.0 / 60},
       cube_under_100_kg<float>,
       cube_under_100_kg<double>},
      {"box_tower", "figure", "research D4", "stands still", {1.0 / 60}, box_tower<float>, box_tower<double>},
      {"ball_pile",
       "34",
       "SimBenchmark 666 (4 x 4 x 4 here)",
       "penetration below 1 mm",
       {1.0 / 60},
       ball_pile<float>,
       ball_pile<double>},
      {"figures_in_a_pile",
       "36",
       "Jolt PerformanceTest (5 figures here)",
       "settles; penetration below 5 mm",
       {1.0 / 60},
       figures_in_a_pile<float>,
       figures_in_a_pile<double>},
      {"colliding_figures",
       "figure",
       "issue 3",
       "no rise above 1 mJ",
       {1.0 / 60, 1.0 / 30},
       colliding_figures<float>,
       colliding_figures<double>},
      {"tumbling_box",
       "figure",
       "issue 3",
       "no rise above 1 mJ",
       {1.0 / 60, 1.0 / 30},
       tumbling_box<float>,
       tumbling_box<double>},
      {"figure_on_stairs",
       "figure",
       "issue 3",
       "no rise above 1 mJ",
       {1.0 / 60, 1.0 / 30},
       figure_on_stairs<float>,
       figure_on_stairs<double>},
      {"crowd_of_200",
       "62",
       "OloEngineBase#523",
       "nothing falls through the floor",
       {1.0 / 60},
       crowd_of_200<float>,
       crowd_of_200<double>},
  };
}

}  // namespace sinew::study
