// Rows 15, 16, 34, 36, 62 and the off-plane figures: many bodies that touch each other.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

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
    penetration = std::max(penetration, stage.depth());
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
    penetration = std::max(penetration, stage.depth());
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
  double sum = 0;
  int looked = 0;
  stage.run(t.lasting(3, 1), t.h, [&](double time) {
    if (time > 0) sum += stage.depth(), ++looked;
  });
  Verdict v(stage.measured());
  v.general();
  v.at_most("deepest penetration, mean of all steps (m)", sum / looked, 1e-3);
  char text[80];
  std::snprintf(text, sizeof text, "deepest penetration in any step %.2f mm", 1e3 * v.measured().penetration);
  v.note(text);
  return v;
}

/// m/s, fastest that any body's centre of mass moved in the last second, and whether all fell asleep.
template <class T>
double fastest_at_the_end(Stage<T>& stage, double h, bool& asleep) {
  const auto centers = [&] {
    std::vector<Vec3<double>> all;
    for (std::size_t m = 0; m < stage.books().members().size(); ++m)
      for (std::size_t b = 0; b < stage.books().members()[m].bodies.size(); ++b)
        all.push_back(stage.books().poses(static_cast<int>(m))[b] *
                      stage.books().members()[m].bodies[b].center);
    return all;
  };
  double fastest = 0;
  std::vector<Vec3<double>> before = centers();
  stage.run(1, h, [&](double time) {
    const std::vector<Vec3<double>> now = centers();
    for (std::size_t i = 0; time > 0 && i < now.size(); ++i)
      fastest = std::max(fastest, (now[i] - before[i]).norm() / h);
    before = now;
  });
  asleep = true;
  for (int i = 0; i < stage.world().character_count(); ++i)
    asleep = asleep && stage.character(i).report().level == Level::kAsleep;
  return fastest;
}

/// Piles of limp figures side by side, each of so many dropped one above the other.
template <class T>
Verdict piles_of_figures(const Trial& t, int piles, int count, double duration) {
  scene::Scene scene = t.scene;
  scene.world.detail.sleep_after = 0.5;
  const std::vector<scene::SceneCharacter> pile(scene.characters.begin(), scene.characters.begin() + count);
  scene.characters.clear();
  for (int n = 0; n < piles; ++n)
    for (scene::SceneCharacter figure : pile) {
      figure.position += Vec3<double>(5 * (n % 4), 5 * std::floor(n / 4), 0);
      scene.characters.push_back(figure);
    }
  Stage<T> stage(scene);
  stage.run(duration - 1, t.h);
  bool asleep = false;
  const double fastest = fastest_at_the_end(stage, t.h, asleep);
  Verdict v(stage.measured());
  v.general();
  v.at_most("penetration (m)", v.measured().penetration, 5e-3);
  if (t.quick) return v;
  v.at_most("speed in the last second (m/s)", fastest, 0.05);
  v.require(asleep, "not all asleep at the end");
  return v;
}

template <class T>
Verdict figures_in_a_pile(const Trial& t) {
  return piles_of_figures<T>(t, 1, t.quick ? 2 : 10, t.lasting(15, 3));
}

template <class T>
Verdict sixteen_piles_of_figures(const Trial& t) {
  return piles_of_figures<T>(t, t.quick ? 2 : 16, t.quick ? 2 : 10, t.lasting(15, 2));
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

/// Chains fall side by side, and again so close that all touch in a world that has room for few of them to be
/// solved together: it must say so, and let nobody through the floor.
template <class T>
Verdict crowd_of_200(const Trial& t) {
  Measurement measured;
  double deepest = 0;
  int crowded = 0;
  for (const bool close : {false, true}) {
    scene::Scene scene = t.scene;
    if (t.quick) scene.characters.resize(40);
    if (close) {
      scene.world.island_dofs = 100;
      for (scene::SceneCharacter& c : scene.characters)
        c.position = c.position.cwiseProduct(Vec3<double>(0.03, 0.03, 1));
    }
    Stage<T> stage(scene);
    stage.run(t.lasting(4, 2), t.h, [&](double) {
      for (int i = 0; i < stage.world().character_count(); ++i) {
        const CharacterReport& report = stage.character(i).report();
        crowded += close && (report.crowded || report.left_out > 0);
        deepest = std::max(deepest, audit::depth_in(stage.surroundings(),
                                                    stage.books().members()[static_cast<std::size_t>(i)],
                                                    stage.books().poses(i)));
      }
    });
    measured.merge(stage.measured());
  }
  Verdict v(measured);
  v.general();
  v.at_most("depth in the floor (m), of bodies of 0.05 m radius", deepest, 0.05);
  v.require(crowded > 0, "no report says that there was no room to solve for all that touch");
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
       "SimBenchmark 666",
       "mean penetration below 1 mm",
       {1.0 / 60},
       ball_pile<float>,
       ball_pile<double>},
      {"figures_in_a_pile",
       "36",
       "Jolt PerformanceTest",
       "ten rest below 5 cm/s in 15 s, asleep; penetration below 5 mm",
       {1.0 / 60},
       figures_in_a_pile<float>,
       figures_in_a_pile<double>},
      {"sixteen_piles_of_figures",
       "36",
       "Jolt PerformanceTest",
       "16 piles of ten: rest below 5 cm/s in 15 s, asleep; penetration below 5 mm",
       {1.0 / 60},
       sixteen_piles_of_figures<float>,
       sixteen_piles_of_figures<double>,
       "",
       "figures_in_a_pile"},
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
       "nothing falls through the floor; a crowd without room is reported",
       {1.0 / 60},
       crowd_of_200<float>,
       crowd_of_200<double>},
  };
}

}  // namespace sinew::study
