// Muscles with a tone: clamp(τ_ff − k·s − d·ṡ, −τ⁻, τ⁺) about the animation. Judged from poses.
#include "sinew/muscle/tone.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "character/scenes.h"

namespace sinew {
namespace {

constexpr double kLimit = 400;            ///< N·m
constexpr double kMass = 3, kLength = 1;  ///< kg, m: a rod that hangs on a driven base

Skeleton rod() {
  Skeleton s;
  Joint base;
  base.name = "base";
  base.type = JointType::kFree;
  base.mass = 10;
  base.inertia = Vec3<double>(1, 1, 1).asDiagonal();
  s.joints.push_back(base);
  Joint joint;
  joint.name = "rod";
  joint.parent = 0;
  joint.type = JointType::kRevolute;
  joint.axis = Vec3<double>::UnitY();
  joint.mass = kMass;
  joint.center_of_mass = {kLength / 2, 0, 0};
  const double across = kMass * kLength * kLength / 12;
  joint.inertia = Vec3<double>(1e-3, across, across).asDiagonal();
  joint.dofs[0].torque_minus = joint.dofs[0].torque_plus = kLimit;
  joint.dofs[0].dry_friction = 0;
  s.joints.push_back(joint);
  s.body_count = 2;
  return s;
}
constexpr double kInertia = kMass * kLength * kLength / 3;  ///< kg·m², of the rod about its joint

template <class T>
struct Rod {
  World<T> world;
  double h;

  Rod(double hz, double stiffness, double damping_ratio, double gravity = 0)
      : world(settings(gravity)), h(1 / hz) {
    Status status;
    EXPECT_EQ(world.add_character(rod(), {}, status), 0) << status.reason;
    const Status set = character().set_tone(1, Stiffness{stiffness, damping_ratio});
    EXPECT_TRUE(set.ok()) << set.reason;
  }
  static WorldSettings settings(double gravity) {
    WorldSettings s;
    s.ground = false;
    s.gravity = {0, 0, -gravity};
    return s;
  }
  Character<T> character() { return world.character(0); }
  /// rad, about y: positive turns the rod down.
  double angle() {
    const Quat<double> q = character().local()[1].rotation.template cast<double>();
    return 2 * std::atan2(q.y(), q.w());
  }
  Vec3<T> tip() { return character().model()[1] * Vec3<T>(T(kLength), 0, 0); }
  void hit(double impulse) { EXPECT_TRUE(character().apply_impulse(1, tip(), {0, 0, T(-impulse)}).ok()); }
  void load(double force) { EXPECT_TRUE(character().apply_force(1, tip(), {0, 0, T(-force)}).ok()); }
  void step() { EXPECT_TRUE(world.step(T(h)).ok()); }
};

struct Swing {
  double period = 0, decrement = 0;  ///< s; ln of successive peaks, over half a period
};

/// Of the first peaks after a hit, each found on the parabola through three samples.
template <class T>
Swing swing(double hz, double stiffness, double damping_ratio) {
  Rod<T> rod(hz, stiffness, damping_ratio);
  rod.step();
  rod.hit(1.2 * std::sqrt(stiffness * kInertia) /
          kLength);  // as far as 1.2 rad: small swings return without unknowns
  std::vector<double> at, peaks;
  double before = 0, last = 0;
  for (int n = 0; peaks.size() < 3 && n < 10 * hz; ++n) {
    rod.step();
    const double now = rod.angle();
    if (n > 1 && (last - before) * (now - last) < 0) {
      const double bend = before - 2 * last + now, lean = (now - before) / 2;
      at.push_back((n - lean / bend) * rod.h);
      peaks.push_back(std::abs(last - lean * lean / (2 * bend)));
    }
    before = last;
    last = now;
  }
  EXPECT_EQ(peaks.size(), 3u);
  if (peaks.size() < 3) return {};
  return {at[2] - at[0], std::log(peaks[0] / peaks[2]) / 2};
}

template <class T>
void expect_closed_form(double hz, double stiffness, double damping_ratio) {
  const Swing is = swing<T>(hz, stiffness, damping_ratio);
  const double root = std::sqrt(1 - damping_ratio * damping_ratio),
               period = 2 * std::numbers::pi / (std::sqrt(stiffness / kInertia) * root),
               decrement = std::numbers::pi * damping_ratio / root;
  // A few percent; the midpoint rule's period is long by (ωh)²/12: 0.4 % for the stiffest of these at 60 Hz.
  EXPECT_NEAR(is.period / period, 1, 0.02) << hz << " Hz, " << stiffness << " N·m/rad, " << damping_ratio;
  EXPECT_NEAR(is.decrement / decrement, 1, 0.04) << hz << " Hz, " << stiffness << ", " << damping_ratio;
}

TEST(Tone, SwingsAsADampedSpring) {
  for (const double hz : {60.0, 240.0})
    for (const double stiffness : {10.0, 60.0, 160.0})
      for (const double damping_ratio : {0.1, 0.2, 0.3}) {
        expect_closed_form<double>(hz, stiffness, damping_ratio);
        expect_closed_form<float>(hz, stiffness, damping_ratio);
      }
}

TEST(Tone, SagsUnderALoadByItOverTheStiffness) {
  Rod<double> rod(60, 100, 0.7);
  constexpr double kForce = 5;
  for (int n = 0; n < 300; ++n) {
    rod.load(kForce);
    rod.step();
  }
  const double sag = rod.angle();
  EXPECT_NEAR(sag, kForce * kLength * std::cos(sag) / 100, 1e-4);
  EXPECT_GT(rod.character().report().unknown_dofs, 0);
}

TEST(Tone, DoesNotSagUnderItsOwnWeight) {
  // What the animation asks for by itself is fed forward: nothing is solved, and nothing moves.
  Rod<double> rod(60, 20, 0.3, 9.81);
  for (int n = 0; n < 60; ++n) {
    rod.step();
    ASSERT_EQ(rod.angle(), 0);
    ASSERT_EQ(rod.character().report().unknown_dofs, 0);
  }
}

TEST(Tone, NeverExceedsTheLimit) {
  for (const double hz : {30.0, 60.0, 240.0}) {
    Rod<double> rod(hz, 300, 0.7, 9.81);
    bool saturated = false;
    for (int n = 0; n < hz; ++n) {
      if (n == hz / 6) rod.hit(50);
      if (n > hz / 2) rod.load(600);
      rod.step();
      const double torque = std::abs(rod.character().torque()[6]);
      EXPECT_LE(torque, kLimit * (1 + 1e-9));
      saturated = saturated || torque > 0.999 * kLimit;
    }
    EXPECT_TRUE(saturated);
  }
}

TEST(Tone, IsTheSameAtAnyRate) {
  const auto peak = [](double hz) {
    Rod<double> rod(hz, 40, 0.3);
    rod.step();
    rod.hit(1);
    double most = 0;
    for (int n = 0; n < hz; ++n) {
      rod.step();
      most = std::max(most, rod.angle());
    }
    return most;
  };
  const double fine = peak(1920);
  for (const double hz : {15.0, 30.0, 60.0, 120.0, 240.0, 960.0}) EXPECT_NEAR(peak(hz) / fine, 1, 0.1) << hz;
}

TEST(Tone, StiffOnesAreStableAtAnyRate) {
  // ωh up to 30: what stays of a swing must not grow.
  for (const double stiffness : {1e3, 1e5})
    for (const double damping_ratio : {0.0, 0.3, 2.0})
      for (const double hz : {15.0, 60.0, 240.0}) {
        Rod<double> rod(hz, stiffness, damping_ratio);
        rod.step();
        rod.hit(1);
        double first = 0, late = 0;
        for (int n = 0; n < 200; ++n) {
          rod.step();
          (n < 50 ? first : late) = std::max(n < 50 ? first : late, std::abs(rod.angle()));
        }
        EXPECT_LE(late, first * (1 + 1e-6)) << stiffness << ' ' << damping_ratio << ' ' << hz;
        EXPECT_LT(first, 0.3);
      }
}

TEST(Tone, AnUndampedSwingGainsNoEnergy) {
  // Kinetic from differences of the angle, between frames; of the spring at its middle.
  for (const double hz : {30.0, 60.0, 240.0}) {
    constexpr double kStiff = 40;
    Rod<double> rod(hz, kStiff, 0);
    rod.step();
    rod.hit(1);
    double before = rod.angle(), first = 0;
    for (int n = 0; n < 10 * hz; ++n) {
      rod.step();
      const double now = rod.angle(), speed = (now - before) * hz, middle = (now + before) / 2;
      const double energy = kInertia * speed * speed / 2 + kStiff * middle * middle / 2;
      if (n == 1) first = energy;
      if (n > 1) {
        ASSERT_LE(energy, first * 1.005) << hz << " Hz, step " << n;  // the mean of a step is not its middle
      }
      before = now;
    }
  }
}

/// The humanoid, weightless: what moves has been hit.
struct Floating {
  World<double> world{Rod<double>::settings(0)};
  Skeleton body = fixtures::humanoid();

  explicit Floating(Tone tone, double h = 1 / 60.) : h_(h) {
    CharacterSettings settings;
    settings.tone = tone;
    Status status;
    EXPECT_EQ(world.add_character(body, settings, status), 0) << status.reason;
    EXPECT_TRUE(world.step(h_).ok());
    before_ = poses();
  }
  Character<double> character() { return world.character(0); }
  void step() {
    before_ = poses();
    EXPECT_TRUE(world.step(h_).ok());
  }
  std::vector<Transform<double>> poses() { return {character().model().begin(), character().model().end()}; }
  /// J: kinetic of the way from the pose before to this one, and of every muscle that has a tone k·s²/2 at
  /// the mean of the two; as the skeleton has masses and poses are.
  double energy() {
    const auto now = poses();
    double sum = 0;
    for (int i = 0; i < body.body_count; ++i) {
      const Joint& joint = body.joints[static_cast<std::size_t>(i)];
      const Transform<double>&a = before_[static_cast<std::size_t>(i)], &b = now[static_cast<std::size_t>(i)];
      const Vec3<double> way = b * joint.center_of_mass - a * joint.center_of_mass;
      const Vec3<double> turn = rotation_log<double>(a.rotation.conjugate() * b.rotation);
      sum += (joint.mass * way.squaredNorm() + turn.dot(joint.inertia * turn)) / (2 * h_ * h_);
      if (joint.parent < 0) continue;
      const auto offset = [&](const std::vector<Transform<double>>& model) {
        const Quat<double> local = model[static_cast<std::size_t>(joint.parent)].rotation.conjugate() *
                                   model[static_cast<std::size_t>(i)].rotation;
        return rotation_log<double>(joint.rest.rotation.conjugate() * local);
      };
      const Vec3<double> middle = (offset(before_) + offset(now)) / 2;
      const int first = character().first_dof(i);
      const double k = character().tone(first).stiffness;  // the same about all of a joint's axes
      sum += k * middle.squaredNorm() / 2;
    }
    return sum;
  }

 private:
  double h_;
  std::vector<Transform<double>> before_;
};

TEST(Tone, AFigureThatWasHitGainsNoEnergy) {
  for (const Tone tone : {Tone::kRelaxed, Tone::kAlert, Tone::kBraced})
    for (const double hz : {30.0, 60.0, 240.0}) {
      Floating figure(tone, 1 / hz);
      const int hand = figure.body.find("hand_l");
      const Vec3<double> at = figure.poses()[static_cast<std::size_t>(hand)].translation;
      EXPECT_TRUE(figure.character().apply_impulse(hand, at, {1, 0.5, 0}).ok());
      double least = 1e9, first = 0;
      for (int n = 0; n < hz; ++n) {
        figure.step();
        const double now = figure.energy();
        if (n == 0) first = now;
        if (n <= 1) continue;
        EXPECT_LT(now, first) << int(tone) << " at " << hz << " Hz, step " << n;
        // A step's means are not its ends: a hundredth of what the hit brought; and at 30 Hz they do not show
        // how a wrist swings.
        if (hz > 30) {
          EXPECT_LE(now, least + 0.01 * first) << int(tone) << " at " << hz << " Hz, step " << n;
        }
        least = std::min(least, now);
      }
      EXPECT_GT(first, 0.05);
      EXPECT_LT(least, 0.7 * first);  // dampers take
    }
}

TEST(Tone, WhoIsNotDisturbedPlaysTheAnimationsBits) {
  for (const Tone tone : {Tone::kRelaxed, Tone::kAlert, Tone::kBraced}) {
    fixtures::Playing<float> playing;
    ASSERT_TRUE(playing.character().set_tone(tone).ok());
    for (int n = 0; n < 300; ++n) {
      playing.step();
      ASSERT_TRUE(playing.pose_is_the_targets_bits()) << n;
      ASSERT_EQ(playing.character().report().unknown_dofs, 0) << n;
    }
  }
}

/// rad, that a hand's load for a tenth of a second turns the upper arm from its animation.
float turned(Tone tone) {
  fixtures::Playing<float> playing, led;
  EXPECT_TRUE(playing.character().set_tone(tone).ok());
  const auto hand = static_cast<std::size_t>(playing.skeleton.find("hand_l"));
  const auto arm = static_cast<std::size_t>(playing.skeleton.find("upperarm_l"));
  float most = 0;
  for (int n = 0; n < 60; ++n) {
    const Vec3<float> at = playing.character().model()[hand].translation;
    if (n >= 10 && n < 16) {
      EXPECT_TRUE(playing.character().apply_force(static_cast<int>(hand), at, {20, 0, 0}).ok());
    }
    playing.step();
    led.step();
    const Quat<float> wanted = led.character().local()[arm].rotation,
                      is = playing.character().local()[arm].rotation;
    most = std::max(most, rotation_log<float>(wanted.conjugate() * is).norm());
  }
  return most;
}

TEST(Tone, ALoadMovesWhatRigidMusclesHold) {
  EXPECT_EQ(turned(Tone::kRigid), 0);
  EXPECT_GT(turned(Tone::kBraced), 0.005f);
  EXPECT_GT(turned(Tone::kAlert), 1.2f * turned(Tone::kBraced));
  EXPECT_GT(turned(Tone::kRelaxed), 1.2f * turned(Tone::kAlert));
}

TEST(Tone, ComesBackAndIsPlayedAgain) {
  fixtures::Playing<float> playing;
  ASSERT_TRUE(playing.character().set_tone(Tone::kAlert).ok());
  for (int n = 0; n < 10; ++n) playing.step();
  const int hand = playing.skeleton.find("hand_l");
  const Vec3<float> at = playing.character().model()[static_cast<std::size_t>(hand)].translation;
  ASSERT_TRUE(playing.character().apply_impulse(hand, at, {3, 0, 0}).ok());
  playing.step();
  EXPECT_GT(playing.character().report().unknown_dofs, 0);
  EXPECT_FALSE(playing.pose_is_the_targets_bits());
  for (int n = 0; n < 240; ++n) playing.step();
  EXPECT_EQ(playing.character().report().unknown_dofs, 0);
  EXPECT_TRUE(playing.pose_is_the_targets_bits());
}

// A host asks once how large its snapshots may become.
TEST(Tone, ThatIsAskedForLaterHasRoomInASnapshot) {
  fixtures::Playing<float> rigid, toned;
  ASSERT_TRUE(toned.character().set_tone(Tone::kAlert).ok());
  EXPECT_EQ(rigid.world.snapshot_capacity(), toned.world.snapshot_capacity());
}

TEST(Tone, GoesOnFromASnapshotWithTheSameBits) {
  fixtures::Playing<float> playing;
  ASSERT_TRUE(playing.character().set_tone(Tone::kAlert).ok());
  ASSERT_TRUE(playing.character().set_tone(playing.skeleton.find("upperarm_l"), Tone::kRelaxed).ok());
  for (int n = 0; n < 10; ++n) playing.step();
  const int hand = playing.skeleton.find("hand_l");
  const Vec3<float> at = playing.character().model()[static_cast<std::size_t>(hand)].translation;
  ASSERT_TRUE(playing.character().apply_impulse(hand, at, {2, 0, 1}).ok());
  for (const int later : {1, 9, 30, 25, 10}) {
    for (int n = 0; n < later; ++n) playing.step();
    std::vector<std::byte> kept(playing.world.snapshot_capacity());
    kept.resize(playing.world.save(kept));
    ASSERT_FALSE(kept.empty());
    fixtures::Playing<float> other;  // which has never heard of tone
    ASSERT_TRUE(other.world.restore(kept).ok());
    other.time = playing.time;
    fixtures::Playing<float> again;
    ASSERT_TRUE(again.world.restore(kept).ok());
    again.time = playing.time;
    for (int n = 0; n < 60; ++n) {
      other.step();
      again.step();
      for (std::size_t i = 0; i < other.skeleton.joints.size(); ++i) {
        ASSERT_EQ(other.character().local()[i].rotation.coeffs(),
                  again.character().local()[i].rotation.coeffs());
      }
    }
    for (int dof = 0; dof < 37; ++dof)
      EXPECT_EQ(other.character().tone(dof).stiffness, playing.character().tone(dof).stiffness);
    World<float>& world = playing.world;
    const float time = playing.time;
    for (int n = 0; n < 60; ++n) playing.step();
    for (std::size_t i = 0; i < other.skeleton.joints.size(); ++i)
      ASSERT_EQ(other.character().local()[i].rotation.coeffs(),
                playing.character().local()[i].rotation.coeffs())
          << later;
    ASSERT_TRUE(world.restore(kept).ok());
    playing.time = time;
  }
}

TEST(Tone, PresetsAreAHumansAndScaleWithMassAndStature) {
  const Skeleton human = fixtures::humanoid();
  const Scale<double> unit = scale_of(human);
  Skeleton named = human;
  const int shin = named.find("shin_l");
  named.joints[static_cast<std::size_t>(shin)].role = Role::kShinL;
  EXPECT_DOUBLE_EQ(stiffness_of(named, unit, shin, 0, Tone::kAlert).stiffness, 300);
  EXPECT_DOUBLE_EQ(stiffness_of(named, unit, shin, 0, Tone::kBraced).damping_ratio, 0.7);
  EXPECT_TRUE(std::isinf(stiffness_of(named, unit, shin, 0, Tone::kRigid).stiffness));
  EXPECT_TRUE(std::isinf(stiffness_of(named, unit, 0, 0, Tone::kAlert).stiffness)) << "the root";
  Scale<double> large = unit;
  large.length = 2;
  large.energy = 8 * 2;  // mass · length
  EXPECT_DOUBLE_EQ(stiffness_of(named, large, shin, 0, Tone::kAlert).stiffness, 8 * 4 * 300.);
}

TEST(Tone, RefusesWhatIsNone) {
  Tone tone = Tone::kAlert;
  EXPECT_FALSE(tone_named("floppy", tone).ok());
  EXPECT_EQ(tone, Tone::kAlert);
  EXPECT_TRUE(tone_named("braced", tone).ok());
  EXPECT_EQ(tone, Tone::kBraced);
  fixtures::Playing<float> playing;
  Character<float> figure = playing.character();
  EXPECT_FALSE(figure.set_tone(99, Tone::kAlert).ok());
  EXPECT_FALSE(figure.set_tone(static_cast<Tone>(7)).ok());
  EXPECT_FALSE(figure.set_tone(1, Stiffness{0, 0.3}).ok());
  EXPECT_FALSE(figure.set_tone(1, Stiffness{10, -1}).ok());
  EXPECT_FALSE(figure.set_tone(0, Stiffness{10, 0.3}).ok()) << "the root";
  EXPECT_FALSE(figure.set_group_tone("no such group", Tone::kAlert).ok());
  EXPECT_FALSE(Character<float>(nullptr).set_tone(Tone::kAlert).ok());
}

}  // namespace
}  // namespace sinew
