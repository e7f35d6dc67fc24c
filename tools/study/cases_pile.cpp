// Rows 15, 16, 34, 36, 62 and the off-plane figures: many bodies that touch each other.
#include <algorithm>
#include <cmath>

#include "study/bodies.h"
#include "study/hard_case.h"

namespace sinew::study {
namespace {

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
  for (const double times : {5.0, 10.0, 50.0}) {
    scene::Scene scene = t.scene;
    scene.props[1].settings.mass = times * scene.props[0].settings.mass;
    Stage<T> stage(scene);
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
    scene::Scene scene = t.scene;
    scene.props[1].settings.mass = mass;
    Stage<T> stage(scene);
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
  Stage<T> stage(t.scene);
  stage.run(t.lasting(5, 3), t.h);
  Verdict v(stage.measured());
  v.general();
  v.at_most("speed at the end (m/s)", fastest_prop(stage), 0.01);
  v.at_most("top fell (m)", 0.9 - double(stage.world().prop_pose(4).translation.z()), 0.01);
  return v;
}

template <class T>
Verdict ball_pile(const Trial& t) {
  scene::Scene scene = t.scene;
  if (t.quick)  // two by two by two of the balls
    std::erase_if(scene.props,
                  [](const scene::SceneProp& ball) { return ball.settings.pose.translation.maxCoeff() > 2; });
  Stage<T> stage(scene);
  stage.run(t.lasting(3, 1), t.h);
  Verdict v(stage.measured());
  v.general();
  v.at_most("penetration (m)", v.measured().penetration, 1e-3);
  return v;
}

/// Limp figures dropped one above the other.
template <class T>
Verdict figures_in_a_pile(const Trial& t) {
  scene::Scene scene = t.scene;
  if (t.quick) scene.characters.resize(2);
  const int count = static_cast<int>(scene.characters.size());
  Stage<T> stage(scene);
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
    scene::Scene scene = t.scene;
    for (scene::SceneCharacter& c : scene.characters) c.position.y() *= seed, c.speeds.seed += seed - 1;
    Stage<T> stage(scene);
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
    scene::Scene scene = t.scene;
    scene.characters[0].speeds.seed = seed;
    Stage<T> stage(scene);
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
    scene::Scene scene = t.scene;
    scene.characters[0].speeds.seed = seed;
    Stage<T> stage(scene);
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
  scene::Scene scene = t.scene;
  if (t.quick) scene.characters.resize(40);
  const int count = static_cast<int>(scene.characters.size());
  Stage<T> stage(scene);
  stage.run(t.lasting(4, 2), t.h);
  double lowest = 1;
  for (int i = 0; i < count; ++i)
    for (const Transform<T>& joint : stage.character(i).model())
      lowest = std::min(lowest, double(joint.translation.z()));
  Verdict v(stage.measured());
  v.general();
  // A joint may lie at its body's surface, which sinks in.
  v.at_least("lowest joint (m)", lowest, -v.measured().penetration);
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
