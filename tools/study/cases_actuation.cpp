// Rows 49–51 and 54: bodies that are moved by the animation, characters that are put elsewhere, limbs that
// are solved for in one step of four.
#include <algorithm>
#include <cmath>

#include "study/bodies.h"
#include "study/hard_case.h"

namespace sinew::study {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Greatest speeds while a figure is crushed, m/s.
struct CrushSpeeds {
  double joint = 0;  ///< of any joint
  double along = 0;  ///< of the centre of mass, the way the piston goes
};

template <class T>
CrushSpeeds crush(Stage<T>& stage, double duration, double h) {
  CrushSpeeds most;
  std::vector<Vec3<T>> last;
  double center = 0;
  stage.run(duration, h, [&](double) {
    const auto model = stage.character(0).model();
    const double x = stage.center_of_mass(0).x();
    if (!last.empty()) most.along = std::max(most.along, std::abs(x - center) / h);
    for (std::size_t i = 0; i < last.size(); ++i)
      most.joint = std::max(most.joint, double((model[i].translation - last[i]).norm()) / h);
    center = x;
    last.clear();
    for (const Transform<T>& joint : model) last.push_back(joint.translation);
  });
  return most;
}

/// A limb that is squeezed past its dead centre flings its end, in finer steps no less: what steps an eighth
/// as long show is no explosion. The fastest of four starts, for where a hand goes is chaotic.
template <class T>
double fling_in_fine_steps(const Trial& t) {
  double fastest = 0;
  for (const double aside : {0.0, 0.001, 0.002, 0.003}) {
    scene::Scene scene = t.scene;
    scene.characters[0].position.x() += aside;
    Stage<T> stage(scene);
    fastest = std::max(fastest, crush(stage, t.scene.duration, t.h / 8).joint);
  }
  return fastest;
}

template <class T>
Verdict piston(const Trial& t) {
  constexpr double kPistonSpeed = 1;  // m/s, of the scene
  Stage<T> stage(t.scene);
  const CrushSpeeds fastest = crush(stage, t.scene.duration, t.h);
  Verdict v(stage.measured());
  v.require(v.measured().refused.empty() && v.measured().finite, "refused or not finite");
  v.at_most("speed of the centre of mass along the piston's way (m/s)", fastest.along, 3 * kPistonSpeed);
  v.at_most("speed of a joint (m/s), that in fine steps", fastest.joint, fling_in_fine_steps<T>(t));
  v.at_most("kinetic energy at the end (J)", stage.kinetic(), 5);
  v.at_most("depth in anything at the end (m)", stage.depth(0), 0.01);
  return v;
}

template <class T>
Vec3<double> riding_place(Stage<T>& stage, int platform, int rider) {
  const Transform<double> base = stage.character(platform).model()[0].template cast<double>();
  return base.inverse() * stage.character(rider).model()[0].translation.template cast<double>();
}

double level(const Vec3<double>& way) {
  return std::hypot(way.x(), way.y());
}

/// Velocity (m/s) of the scene's rider in the fifth step after it was sent off its platform by a jump of
/// `up` m/s at 0.5 s, less what gravity has taken.
template <class T>
Vec3<double> take_off(const Trial& t, double up, Measurement& measured) {
  constexpr int kRider = 1, kSteps = 5;
  Stage<T> stage(t.scene);
  stage.run(0.5, t.h);
  const double mass = stage.character(kRider).skeleton().total_mass();
  stage.push(kRider, 0, stage.center_of_mass(kRider), Vec3<double>(0, 0, mass * up));
  stage.run(kSteps * t.h, t.h);
  measured.merge(stage.measured());
  const double aloft = (kSteps - 0.5) * t.h;  // s, in the middle of the last step
  return stage.books().momentum(kRider).linear / mass + Vec3<double>(0, 0, 9.81 * aloft);
}

template <class T>
Verdict moving_platform(const Trial& t) {
  constexpr double kSpeed = 5, kUp = 3;  // m/s
  Measurement ignored;
  const Vec3<double> sent = take_off<T>(t, kUp, ignored);
  Stage<T> stage(t.scene);
  constexpr int kPlatform = 0, kRider = 1;
  double slip = 0, rise = 0;
  stage.run(2, t.h, [&](double) { slip = std::max(slip, level(riding_place(stage, kPlatform, kRider))); });
  stage.run(3, t.h,
            [&](double) { rise = std::max(rise, riding_place(stage, kPlatform, kRider).z() - 0.15); });
  const double slid = riding_place(stage, kPlatform, kRider).x();
  Verdict v(stage.measured());
  v.require(v.measured().refused.empty() && v.measured().finite, "refused or not finite");
  v.at_most("slip at constant speed (m)", slip, 0.01);
  v.at_most("take-off off the platform's speed, share", std::hypot(sent.x() - kSpeed, sent.y()) / kSpeed,
            0.02);
  v.at_most("take-off off the jump's speed upwards, share", std::abs(sent.z() / kUp - 1), 0.02);
  v.at_most("rise when the platform stops in one frame (m)", rise, 0.01);
  v.at_most("way to stop off v^2/(2 mu g), share", std::abs(slid / (25 / (2 * 9.81)) - 1), 0.1);
  return v;
}

template <class T>
Verdict turning_platform(const Trial& t) {
  Stage<T> stage(t.scene);  // up to 2 rad/s in a second: 2 m/s² outwards, a fifth of what friction holds
  double slip = 0;
  stage.run(5, t.h, [&](double) {
    slip = std::max(slip, level(riding_place(stage, 0, 1) - Vec3<double>(0.5, 0, 0.15)));
  });
  Verdict v(stage.measured());
  v.require(v.measured().refused.empty() && v.measured().finite, "refused or not finite");
  v.at_most("slip (m)", slip, 0.01);
  return v;
}

/// Largest joint speed (rad/s) in the two seconds after the figure was put 1 km away and turned round, and in
/// how many steps its report says that it was carried.
template <class T>
double speed_after_jump(bool declared, const Trial& t, Measurement& measured, int& carried) {
  Stage<T> stage(t.scene);
  const Skeleton& body = t.scene.characters[0].asset->skeleton;
  stage.run(1, t.h);
  std::vector<JointJet<T>> jets = rest_jets<T>(body);
  jets[0].translation.x() += T(1000);
  jets[0].rotation = Quat<T>(Eigen::AngleAxis<T>(T(kPi / 2), Vec3<T>::UnitZ()));
  (void)stage.character(0).set_target(jets);
  if (declared) (void)stage.character(0).reset();
  stage.forget();
  double fastest = 0;
  std::vector<Transform<T>> last(stage.character(0).local().begin(), stage.character(0).local().end());
  stage.run(2, t.h, [&](double) {
    carried += stage.character(0).report().carried;
    const auto local = stage.character(0).local();
    for (std::size_t i = 1; i < last.size(); ++i)
      fastest = std::max(fastest, double(last[i].rotation.angularDistance(local[i].rotation)) / t.h);
    last.assign(local.begin(), local.end());
  });
  measured.merge(stage.measured());
  return fastest;
}

template <class T>
Verdict teleport(const Trial& t) {
  Measurement measured, ignored;
  int told = 0, noticed = 0;
  const double declared = speed_after_jump<T>(true, t, measured, told);
  const double undeclared = speed_after_jump<T>(false, t, ignored, noticed);
  Verdict v(measured);
  v.general();
  v.require(ignored.finite, "NaN after an undeclared jump");
  v.at_most("joint speed after a declared jump (rad/s)", declared, 1);
  v.at_most("joint speed after an undeclared jump (rad/s)", undeclared, 4);
  v.require(told == 0 && noticed == 1, "the telemetry does not count the undeclared jump");
  return v;
}

template <class T>
Verdict animation_cut(const Trial& t) {
  Stage<T> stage(t.scene);
  const int arm = t.scene.characters[0].asset->skeleton.find("upperarm_l");
  stage.run(0.5, t.h);
  stage.forget();
  double torque = 0;
  stage.run(3, t.h, [&](double) {
    for (int k = 0; k < 3; ++k)
      torque = std::max(torque,
                        std::abs(double(stage.character(0).torque()[stage.character(0).first_dof(arm) + k])));
  });
  Verdict v(stage.measured());
  v.require(v.measured().refused.empty() && v.measured().finite, "refused or not finite");
  v.at_most("torque (N m)", torque, 70 * (1 + 1e-5));
  v.require(stage.character(0).on_animation(), "not on the animation after 3 s");
  return v;
}

/// Stands, with weakened hands and feet, and is struck at an elbow or a knee every third of a second.
template <class T>
struct Struck {
  Stage<T> stage{WorldSettings{}};
  Skeleton body = humanoid();
  std::vector<int> limbs;
  int strike = 0;

  Struck(bool bake, double strength_of_hands) {
    stage.add(body, {});
    for (const char* name : {"hand_l", "hand_r", "foot_l", "foot_r"}) limbs.push_back(body.find(name));
    for (int n = 0; n < 4; ++n)
      (void)stage.character(0).set_strength(limbs[n], T(n < 2 ? strength_of_hands : 0.3));
    CharacterDetail detail;
    detail.bake = bake;
    (void)stage.character(0).set_detail(detail);
  }
  void step(double h, bool strikes) {
    const char* const struck[] = {"forearm_r", "shin_l", "forearm_l", "shin_r"};
    const int joint = body.find(struck[strike % 4]);
    const Vec3<double> at = stage.character(0).model()[joint].translation.template cast<double>();
    if (strikes) stage.push(0, joint, at, {strike++ % 2 == 0 ? 30.0 : -30.0, 12, 0});
    stage.step(h);
  }
  int solved() {
    int sum = 0;
    for (const int limb : limbs) sum += stage.character(0).unknown()[stage.character(0).first_dof(limb)];
    return sum;
  }
};

/// What baking changes.
struct Baking {
  double off = 0;      ///< deg, rms of all joints off the always dynamic ones
  double energy = 0;   ///< most kinetic energy, of the always dynamic one's
  double solved = 0;   ///< steps in which limbs were solved for, of the always dynamic one's
  double unbaked = 0;  ///< share of the limbs that were to be baked that had to be solved for
  Measurement measured;
};

/// Two seconds of it, with baking beside without.
template <class T>
Baking bake_beside(const Trial& t, double strength_of_hands) {
  Struck<T> dynamic(false, strength_of_hands), baked(true, strength_of_hands);
  double squares = 0, terms = 0, hottest_dynamic = 0, hottest_baked = 0;
  int solved_dynamic = 0, solved_baked = 0, left_out = 0, unbaked = 0;
  const int steps = static_cast<int>(std::lround(2 / t.h)),
            between = static_cast<int>(std::lround(1 / (3 * t.h)));
  for (int n = 0; n < steps; ++n) {
    dynamic.step(t.h, n % between == 0);
    baked.step(t.h, n % between == 0);
    const Character<T> one = dynamic.stage.character(0), two = baked.stage.character(0);
    for (std::size_t i = 0; i < one.model().size(); ++i) {
      squares += std::pow(double(one.model()[i].rotation.angularDistance(two.model()[i].rotation)), 2);
      ++terms;
    }
    hottest_dynamic = std::max(hottest_dynamic, dynamic.stage.kinetic());
    hottest_baked = std::max(hottest_baked, baked.stage.kinetic());
    solved_dynamic += dynamic.solved();
    solved_baked += baked.solved();
    left_out += two.report().baked;
    unbaked += two.report().unbaked;
  }
  return {std::sqrt(squares / terms) * 180 / kPi, hottest_baked / hottest_dynamic,
          double(solved_baked) / solved_dynamic, double(unbaked) / (unbaked + left_out),
          baked.stage.measured()};
}

template <class T>
Verdict baked_limbs(const Trial& t) {
  // Weak hands are off their muscles for a few steps after each blow, limp ones all the time.
  const Baking weak = bake_beside<T>(t, 0.3), limp = bake_beside<T>(t, 0);
  Measurement measured = weak.measured;
  measured.merge(limp.measured);
  Verdict v(measured);
  v.require(weak.measured.refused.empty() && limp.measured.refused.empty() && measured.finite,
            "refused or not finite");
  for (const Baking& b : {weak, limp}) {
    v.at_most("pose off that of the always dynamic one, rms (deg)", b.off, 3);
    v.at_most("most kinetic energy, of the always dynamic one's", b.energy, 1.01);
  }
  v.at_most("steps in which weak limbs are solved for, of the always dynamic one's", weak.solved, 0.9);
  // A quarter by the duty cycle, 6 steps of 120 with a blow, and what follows blows.
  v.at_most("steps in which limp limbs are solved for, of the always dynamic one's", limp.solved, 0.4);
  v.at_most("share of limp limbs to be baked that had to be solved for", limp.unbaked, 0.15);
  return v;
}

}  // namespace

std::vector<HardCase> actuation_cases() {
  return {
      {"piston",
       "49",
       "godot#29256",
       "thrown at 3 times the piston's speed at most, limbs no faster than in fine steps; at rest and free "
       "after it",
       {1.0 / 60},
       piston<float>,
       piston<double>},
      {"moving_platform",
       "50",
       "box2d#117",
       "slips below 1 cm; takes off at its speed and the jump's, each to 2 %; slides by theory when it stops",
       {1.0 / 60},
       moving_platform<float>,
       moving_platform<double>},
      {"turning_platform",
       "50",
       "box2d#117",
       "slips below 1 cm",
       {1.0 / 60},
       turning_platform<float>,
       turning_platform<double>},
      {"teleport",
       "51",
       "VPhysics-Jolt#276",
       "joint speeds below 4 rad/s, declared or not",
       {1.0 / 60},
       teleport<float>,
       teleport<double>},
      {"animation_cut",
       "51",
       "issue 3",
       "torque within limits; back on the animation",
       {1.0 / 60},
       animation_cut<float>,
       animation_cut<double>},
      {"baked_limbs",
       "54",
       "seed talk, bake",
       "below 3 deg rms off always dynamic, no more energy; limp limbs left out of 60 % of the solves",
       {1.0 / 60},
       baked_limbs<float>,
       baked_limbs<double>},
  };
}

}  // namespace sinew::study
