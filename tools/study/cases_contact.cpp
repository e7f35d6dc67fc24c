// Rows 31–33, 37–44 and the figures of single figures on the floor.
#include <algorithm>
#include <cmath>

#include "study/bodies.h"
#include "study/hard_case.h"

namespace sinew::study {
namespace {

template <class T>
Vec3<double> place(Stage<T>& stage, int character = 0) {
  return stage.character(character).model()[0].translation.template cast<double>();
}

template <class T>
Verdict foot_on_slope(const Trial& t) {
  Stage<T> stage(t.scene);
  stage.run(1, t.h);
  const double start = place(stage).x(), lasting = t.lasting(60, 10);
  stage.run(lasting, t.h);
  Verdict v(stage.measured());
  v.general();
  v.at_most("creep (m/s)", (place(stage).x() - start) / lasting, 3e-3);
  return v;
}

template <class T>
Verdict sliding_cube(const Trial& t) {
  Stage<T> stage(t.scene);
  double lift = 0;
  stage.run(3, t.h, [&](double) { lift = std::max(lift, place(stage).z() - 0.05); });
  Verdict v(stage.measured());
  v.general();
  v.at_most("lift (m)", lift, 1e-3);
  v.at_most("way to stop off v^2/(2 mu g), share", std::abs(place(stage).x() / (36 / (2 * 0.5 * 9.81)) - 1),
            0.02);
  return v;
}

template <class T>
Verdict rolling_balls(const Trial& t) {
  Stage<T> stage(t.scene);
  stage.run(0.5, t.h);
  const double seconds = 1;
  Vec3<double> plate_before = place(stage), ball_before = place(stage, 13);
  stage.run(seconds, t.h, [&](double) { plate_before = place(stage), ball_before = place(stage, 13); });
  // The plate drags on the floor under everything's weight; a ball without slip takes 2/7 of its
  // acceleration.
  const double a = (150 - 0.4 * 35 * 9.81) / (10 + 25 * 2.0 / 7);
  const double plate = (place(stage) - plate_before).norm() / t.h,
               rolling = (place(stage, 13) - ball_before).norm() / t.h;
  Verdict v(stage.measured());
  v.general();
  v.at_most("plate's speed off theory, share", std::abs(plate / (a * (seconds - t.h / 2)) - 1), 0.01);
  v.at_most("ball's speed off theory, share", std::abs(rolling / (a * 2 / 7 * (seconds - t.h / 2)) - 1),
            0.01);
  return v;
}

template <class T>
Verdict hand_in_crease(const Trial& t) {
  Stage<T> stage(t.scene);
  double squares = 0;
  int counted = 0;
  Vec3<double> before = place(stage);
  stage.run(6, t.h, [&](double time) {
    if (time > 3) squares += ((place(stage) - before) / t.h).squaredNorm(), ++counted;
    before = place(stage);
  });
  Verdict v(stage.measured());
  v.general();
  v.at_most("rms speed (m/s)", std::sqrt(squares / counted), 1e-3);
  return v;
}

template <class T>
Verdict foot_at_an_edge(const Trial& t) {
  Stage<T> stage(t.scene);
  const Vec3<double> start = place(stage);
  stage.run(0.2, t.h);
  const Vec3<double> moved = place(stage) - start;
  Verdict v(stage.measured());
  v.general();
  v.at_most("lateral way over 1 % of g t^2/2", std::hypot(moved.x(), moved.y()), 0.01 * 9.81 * 0.04 / 2);
  v.at_most("drop (m)", -moved.z(), 2e-3);
  return v;
}

template <class T>
Verdict coplanar_tiles(const Trial& t) {
  Stage<T> stage(t.scene);
  double fastest = 0, before = 0.05;
  stage.run(2, t.h, [&](double time) {
    const double z = place(stage).z();
    if (time > 0.2) fastest = std::max(fastest, std::abs(z - before) / t.h);
    before = z;
  });
  Verdict v(stage.measured());
  v.general();
  v.at_most("vertical speed (m/s)", fastest, 0.01);
  v.at_least("way (m)", place(stage).x(), 8);
  return v;
}

/// How far the ball got at most beyond the near face of the wall, which is at x = 0, m.
template <class T>
double beyond_wall(const Trial& t, Measurement& measured) {
  double most = -1;
  for (const double start : {0.5, 0.73, 1.11, 2.0}) {  // so that frames fall differently on the impact
    scene::Scene scene = t.scene;
    scene.props[0].settings.pose.translation.x() = -start;
    Stage<T> stage(scene);
    stage.run(0.25, t.h);
    most = std::max(most, double(stage.world().prop_pose(0).translation.x()));
    measured.merge(stage.measured());
  }
  return most;
}

template <class T>
Verdict thrown_at_thin_wall(const Trial& t) {
  Measurement measured;
  const double beyond = beyond_wall<T>(t, measured);
  Verdict v(measured);
  v.general();
  v.at_most("centre beyond the wall's face (m)", beyond, 0);
  return v;
}

/// What the scene's bullet leaves behind of its momentum when it strikes the hand of a floating figure,
/// share.
template <class T>
double lost_on_a_hand(const Trial& t, Measurement& measured, bool& hit) {
  Stage<T> stage(t.scene.world);
  const Skeleton body = humanoid();
  const int figure = stage.add(body, passive());
  const auto hand = static_cast<std::size_t>(body.find("hand_l"));
  PropSettings bullet = t.scene.props[0].settings;
  bullet.pose.translation +=
      stage.character(figure).model()[hand].template cast<double>() * body.joints[hand].center_of_mass;
  stage.add_prop(bullet);
  const Vec3<double> given = bullet.mass * bullet.velocity;
  stage.run(0.05, t.h);
  const Vec3<double> taken = stage.books().momentum(figure).linear, left = stage.books().momentum(1).linear;
  measured.merge(stage.measured());
  hit = taken.norm() > 0.5 * given.norm();
  return (taken + left - given).norm() / given.norm();
}

template <class T>
Verdict bullet(const Trial& t) {
  Measurement measured;
  const double beyond = beyond_wall<T>(t, measured);
  Stage<T> stage(t.scene);
  stage.run(0.05, t.h);
  const PropSettings& settings = t.scene.props[0].settings;
  const double given = settings.mass * settings.velocity.norm();
  const double kept = stage.books().momentum(0).linear.norm() / given;
  bool hit = false;
  const double lost = lost_on_a_hand<T>(t, measured, hit);
  Verdict v(measured);
  v.general();
  v.at_most("centre beyond the plate's face (m)", beyond, 0);
  v.at_most("impulse on the plate off m v, share", kept, 0.01);
  v.require(hit, "the bullet missed the hand");
  v.at_most("momentum of hand and bullet off m v, share", lost, 0.01);
  return v;
}

template <class T>
Verdict spawned_in_floor(const Trial& t) {
  Stage<T> stage(t.scene);
  double fastest = 0, before = 0;
  stage.run(4, t.h, [&](double) {
    fastest = std::max(fastest, (place(stage).z() - before) / t.h);
    before = place(stage).z();
  });
  Verdict v(stage.measured());
  v.require(v.measured().finite, "NaN or infinity");
  v.at_most("exit speed (m/s)", fastest, 0.5);
  v.at_least("height at the end (m)", place(stage).z(), 0.19);
  return v;
}

/// Heights (m) that the scene's ball reaches after each bounce.
template <class T>
std::vector<double> bounces(const scene::Scene& scene, double seconds, double h, Measurement& measured) {
  Stage<T> stage(scene);
  const PropSettings& ball = scene.props[0].settings;
  const double height = ball.pose.translation.z() - ball.size.x();
  std::vector<double> tops;
  double before = height;
  bool fallen = false, rising = false;
  stage.run(seconds, h, [&](double) {
    const double z = double(stage.world().prop_pose(0).translation.z()) - ball.size.x();
    fallen = fallen || z < 0.5 * height;
    if (rising && z < before) tops.push_back(before);
    rising = fallen && z > before, before = z;
  });
  measured.merge(stage.measured());
  return tops;
}

template <class T>
Verdict bounce_1(const Trial& t) {
  Measurement measured;
  const std::vector<double> tops = bounces<T>(t.scene, 20, t.h, measured);
  Verdict v(measured);
  v.general();
  v.at_least("bounces in 20 s", double(tops.size()), 9);  // √(8·5/g) = 2.02 s each
  for (const double top : tops) {
    v.at_most("height (m)", top, 5 * 1.005);
    v.at_least("height (m)", top, 5 * 0.98);
  }
  return v;
}

template <class T>
Verdict bounce_half(const Trial& t) {
  Measurement measured;
  const std::vector<double> tops = bounces<T>(t.scene, 3, t.h, measured);
  Verdict v(measured);
  v.general();
  v.at_most("largest rise in a step (J)", v.measured().worst_rise, 1e-3);
  v.at_most("height off 0.25 (m)", tops.empty() ? 1 : std::abs(tops[0] - 0.25), 0.02);
  return v;
}

/// Limp figures that may touch themselves: neighbours that overlap at rest are no contact.
template <class T>
Verdict adjacent_limb_overlap(const Trial& t) {
  Measurement measured;
  double moved = 0;
  for (unsigned seed = 0; seed <= (t.quick ? 2u : 10u); ++seed) {
    scene::Scene scene = t.scene;
    scene.characters[0].speeds.seed = seed;
    if (seed == 0) scene.world = weightless(), scene.characters[0].speeds.random = 0;
    Stage<T> stage(scene);
    const std::vector<Transform<T>> before(stage.character(0).model().begin(),
                                           stage.character(0).model().end());
    stage.run(2, t.h);
    for (std::size_t i = 0; seed == 0 && i < before.size(); ++i)
      moved =
          std::max(moved, double((before[i].translation - stage.character(0).model()[i].translation).norm()));
    measured.merge(stage.measured());
  }
  Verdict v(measured);
  v.general();
  v.at_most("moved out of the rest pose by itself in 2 s (m)", moved, 1e-5);
  return v;
}

template <class T>
Verdict contact_on_and_off(const Trial& t) {
  Measurement measured;
  double fastest = 0;
  for (const T off : {std::nextafter(T(0.1), T(0)), T(0.1), std::nextafter(T(0.1), T(1))}) {
    scene::Scene scene = t.scene;
    scene.characters[0].position.z() = double(off);
    Stage<T> stage(scene);
    double before = double(off);
    stage.run(5, t.h, [&](double time) {
      if (time > 0.5) fastest = std::max(fastest, std::abs(place(stage).z() - before) / t.h);
      before = place(stage).z();
    });
    measured.merge(stage.measured());
  }
  Verdict v(measured);
  v.general();
  v.require(v.measured().solved > 0, "was not simulated");
  v.at_most("speed (m/s)", fastest, 1e-3);
  return v;
}

template <class T>
Verdict painleve_rod(const Trial& t) {
  Stage<T> stage(t.scene);
  stage.run(3, t.h);
  Verdict v(stage.measured());
  v.general();
  return v;
}

/// Limp falls with many seeds, for energy and counts.
template <class T>
Measurement limp_falls(const Trial& t, Compared scheme) {
  Measurement measured;
  const int seeds = t.quick ? 6 : 40;
  for (int seed = 1; seed <= seeds; ++seed) {
    scene::Scene scene = t.scene;
    scene.characters[0].speeds.seed = static_cast<unsigned>(seed);
    Stage<T> stage(scene, scheme);
    stage.run(3, t.h);
    measured.merge(stage.measured());
  }
  return measured;
}

template <class T, Compared scheme>
Verdict limp_fall(const Trial& t) {
  Verdict v(limp_falls<T>(t, scheme));
  v.general();
  return v;
}

/// Dropped and counted as by the prototype whose figures are the bounds: its first body 1.5 to 2.2 m up, 4 s,
/// steps in contact (research/solver-prototype.md).
template <class T>
Verdict limp_fall_counts(const Trial& t) {
  constexpr double kChest = 1.42;  // m above the feet of the figure
  Measurement measured;
  const int seeds = t.quick ? 6 : 40;
  for (int seed = 1; seed <= seeds; ++seed) {
    scene::Scene scene = t.scene;
    scene.characters[0].speeds.seed = static_cast<unsigned>(seed);
    scene.characters[0].position.z() = 1.5 - kChest + 0.7 * (seed - 1) / (seeds - 1);
    Stage<T> stage(scene);
    stage.count_in_contact_only();
    stage.run(4, t.h);
    measured.merge(stage.measured());
  }
  Verdict v(measured);
  const Measurement& m = v.measured();
  const bool sixty = t.h < 0.02;
  if (sixty) v.at_most("mean passes", m.mean_passes(), 2);
  v.at_most("99th percentile of passes", m.passes_percentile(0.99), sixty ? 7 : 10);
  if (sixty) v.at_most("mean factorisations", m.mean_factorisations(), 3.7);
  if (sixty) v.at_most("share of unconverged steps", m.unconverged_share(), 1e-4);
  return v;
}

}  // namespace

std::vector<HardCase> contact_cases() {
  const std::vector<double> every{1.0 / 240, 1.0 / 120, 1.0 / 60, 1.0 / 30, 1.0 / 15};
  return {
      {"foot_on_slope",
       "31",
       "mujoco#3328; newton#3943",
       "creep below 3 mm/s at 20 deg, mu 0.5",
       {1.0 / 60},
       foot_on_slope<float>,
       foot_on_slope<double>},
      {"sliding_cube",
       "32",
       "Genesis PR #3126",
       "lifts below 1 mm, stops within 2 % of theory",
       {1.0 / 60, 1.0 / 30},
       sliding_cube<float>,
       sliding_cube<double>},
      {"rolling_balls",
       "33",
       "SimBenchmark rolling",
       "speeds within 1 % of theory",
       {1.0 / 60},
       rolling_balls<float>,
       rolling_balls<double>},
      {"bounce_1",
       "35",
       "SimBenchmark bouncing",
       "height within 2 %, never above 100.5 %",
       {1.0 / 60, 1.0 / 30},
       bounce_1<float>,
       bounce_1<double>},
      {"bounce_half",
       "figure",
       "issue 3",
       "returns to 0.25 +- 0.02 of its height",
       {1.0 / 60, 1.0 / 30},
       bounce_half<float>,
       bounce_half<double>},
      {"hand_in_crease",
       "37",
       "sbox-issues#1359",
       "rms speed below 1 mm/s",
       {1.0 / 60},
       hand_in_crease<float>,
       hand_in_crease<double>},
      {"foot_at_an_edge",
       "38",
       "JoltPhysics#717",
       "lateral impulse below 1 % of the normal one",
       {1.0 / 60},
       foot_at_an_edge<float>,
       foot_at_an_edge<double>},
      {"coplanar_tiles",
       "39",
       "godot#102544; JoltPhysics#1922",
       "vertical speed below 1 cm/s",
       {1.0 / 60},
       coplanar_tiles<float>,
       coplanar_tiles<double>},
      {"thrown_at_thin_wall",
       "figure",
       "issue 3",
       "40 m/s never through 1 cm",
       {1.0 / 60, 1.0 / 30},
       thrown_at_thin_wall<float>,
       thrown_at_thin_wall<double>},
      {"bullet",
       "40",
       "Jolt MotionQualityLinearCastTests",
       "900 m/s never through 5 mm nor a hand; impulse to 1 %",
       {1.0 / 60},
       bullet<float>,
       bullet<double>},
      {"spawned_in_floor",
       "41",
       "shock2quest PR #277",
       "leaves at 0.5 m/s at most",
       {1.0 / 60},
       spawned_in_floor<float>,
       spawned_in_floor<double>},
      {"adjacent_limb_overlap",
       "42",
       "shock2quest PR #283",
       "filtered; no energy; nothing moves by 10 um",
       {1.0 / 60},
       adjacent_limb_overlap<float>,
       adjacent_limb_overlap<double>},
      {"contact_on_and_off",
       "43",
       "NVIDIA PhysX#365",
       "speed below 1 mm/s",
       {1.0 / 60},
       contact_on_and_off<float>,
       contact_on_and_off<double>},
      {"painleve_rod",
       "44",
       "drake examples/rod2d",
       "finite, no energy gained",
       {1.0 / 60, 1.0 / 30},
       painleve_rod<float>,
       painleve_rod<double>},
      {"limp_fall", "figure", "DESIGN section 3.1", "no energy gained from 1/240 to 1/15 s", every,
       limp_fall<float, Compared::kBossak>, limp_fall<double, Compared::kBossak>, "", "limp_fall"},
      {"limp_fall_bdf1", "figure", "DESIGN section 3.1", "no energy gained from 1/240 to 1/15 s", every,
       limp_fall<float, Compared::kBdf1>, limp_fall<double, Compared::kBdf1>, "", "limp_fall"},
      {"limp_fall_bdf2", "figure", "DESIGN section 3.1", "no energy gained from 1/240 to 1/15 s", every,
       limp_fall<float, Compared::kBdf2>, limp_fall<double, Compared::kBdf2>, "", "limp_fall"},
      {"limp_fall_counts",
       "figure",
       "issue 3",
       "passes and factorisations of the prototype",
       {1.0 / 60, 1.0 / 30},
       limp_fall_counts<float>,
       limp_fall_counts<double>,
       "",
       "limp_fall"},
  };
}

}  // namespace sinew::study
