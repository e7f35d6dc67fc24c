// The demo character walks where its clip does not know the ground: slopes, stairs, platforms that move.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>

#include "convert/convert.h"
#include "fixtures/known_failure.h"
#include "fixtures/paths.h"
#include "sinew/animation/foot_placement_job.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

using Vec = Vec3<double>;
using Pose = std::vector<JointJet<double>>;
using Moving = MovingTransform<double>;
using Jet = TimeJet<double>;

constexpr double kPi = 3.14159265358979323846;
constexpr double kLead =
    0.1;  ///< s, between the instants at which a ray is cast under the toe: now and three more

/// A ground and how the game moves a character over it. Heights and normals in the axes of `body`.
struct Ground {
  std::function<double(double x, double y)> height = [](double, double) { return 0.0; };
  std::function<Vec(double x, double y)> normal = [](double, double) { return Vec(Vec::UnitZ()); };
  /// m, from a point above which there is `deep` of ground to the nearest without: a riser may be nearer.
  std::function<double(const Vec& point, double deep)> depth = [](const Vec&, double deep) { return deep; };
  std::function<Jet(const Moving& root)> level = [](const Moving&) {
    return Jet(0.0);
  };                                     ///< given to the root
  std::function<Moving(double t)> body;  ///< none: it stands
  double half_life = 0.1;                ///< s, FootSettings::half_life
  double speed = 1;                      ///< of the root over the clip's own: feet would slide
};

/// What a walk has shown.
struct Walk {
  double slide = 0;    ///< m, largest distance of a settled foot from where it was when it came to rest
  double depth = 0;    ///< m, deepest that a sole was in the ground
  double bearing = 0;  ///< m, of those that have come to rest: the nearer end of the sole from the ground
  double rate = 0, acceleration = 0;  ///< parts of them, plus 1, that differences of poses are off
  double peak = 0;                    ///< rad/s², of any joint
  double knee = 0;                    ///< largest part of a leg's length
  double jump = 0;                    ///< of positions, velocities, accelerations at what happens in a frame
  double drop = 0;                    ///< m, that the pelvis came down at most
  int locks = 0, breaks = 0;
  int settled = 0;  ///< frames
};

class FootWalk : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    nlohmann::json report;
    const auto error =
        convert::convert_files({source_dir() + "/assets/character/mannequin.glb"}, {}, asset, report);
    ASSERT_FALSE(error) << error.message;
    for (const Joint& joint : asset.skeleton.joints) parents.push_back(joint.parent);
    ASSERT_TRUE(find_foot_leg(asset.skeleton, Role::kFootL, legs[0]).ok());
    ASSERT_TRUE(find_foot_leg(asset.skeleton, Role::kFootR, legs[1]).ok());
  }
  static const Clip& clip(const char* name) { return asset.clips[std::size_t(asset.find_clip(name))]; }

  inline static Asset asset;
  inline static std::vector<int> parents;
  inline static FootLeg<double> legs[2];
};

/// One character on a ground, frame by frame.
class Walker {
 public:
  Walker(const Clip& clip, const Ground& ground, std::span<const int> parents,
         std::span<const FootLeg<double>> legs)
      : clip_(clip), ground_(ground), parents_(parents), legs_(legs) {}

  Walk run(double seconds, double rate) {
    const double h = 1 / rate;
    for (double t = 0; t < seconds; t += h) frame(t, t == 0 ? 0 : h);
    return walk_;
  }

 private:
  Pose animated(double t) const {
    Pose jets(parents_.size());
    EXPECT_TRUE((SamplingJob<double>{&clip_, t, jets}.Run().ok()));
    JointJet<double>& root = jets[0];
    const double more = ground_.speed - 1, v = more * clip_.root_step.x() / clip_.duration;
    root.translation.x() += v * t;
    root.velocity.x() += v;
    Moving moving = moving_transform(root);
    level_ = ground_.level(moving);
    moving.translation.z() += level_;
    root = joint_jet(body_ * moving);
    return jets;
  }
  GroundHit<double> hit_under(const Vec& point) const {
    const Moving back = body_.inverse();
    const Vec own = value_of<double>(back * still<double>(point));
    const Vec at(own.x(), own.y(), ground_.height(own.x(), own.y()));
    const JointJet<double> jet = joint_jet(body_);
    return {value_of<double>(body_ * still<double>(at)), jet.rotation * ground_.normal(own.x(), own.y()),
            ground_.body ? 0 : -1};
  }
  void cast_rays(const Pose& jets, std::size_t k) {
    const auto below = [&](const Pose& pose, const Vec& point) {
      const Moving foot = model_motion<double>(pose, parents_, legs_[k].foot);
      return hit_under(value_of<double>(foot * still<double>(point)));
    };
    under_[k] = {below(jets, legs_[k].toe), below(jets, legs_[k].heel)};
    for (std::size_t n = 0; n < 3; ++n) ahead_[k][n] = below(soon_[n], legs_[k].toe);
  }
  FootPlacementJob<double> job(Pose& jets, std::span<FootState<double>> states, SmoothInput<double>& drop,
                               double h) {
    FootPlacementJob<double> job;
    job.parents = parents_;
    job.jets = jets;
    job.legs = legs_;
    job.feet = feet_;
    job.states = states;
    job.grounds = std::span(&body_, ground_.body ? 1u : 0u);
    job.level = level_;
    job.drop = &drop;
    job.step = h;
    job.settings.half_life = ground_.half_life;
    return job;
  }
  void frame(double t, double h) {
    if (ground_.body) {
      body_ = ground_.body(t);
    } else {
      body_ = moving_transform(JointJet<double>{});
    }
    for (int n = 0; n < 3; ++n) soon_[n] = animated(t + kLead * (n + 1));
    const Pose wanted = animated(t);
    for (std::size_t k = 0; k < 2; ++k) {
      cast_rays(wanted, k);
      feet_[k] = {in_contact(clip_, t, legs_[k].foot) ? 1.0 : 0.0, under_[k], ahead_[k]};
    }
    Pose jets = wanted;
    FootState<double> before[2] = {states_[0], states_[1]};
    ASSERT_TRUE(job(jets, states_, drop_, h).Run().ok()) << t;
    // Once more at the same instant, with what the frame has decided: nothing may have jumped by it.
    Pose again = wanted;
    FootState<double> after[2] = {states_[0], states_[1]};
    SmoothInput<double> drop = drop_;
    ASSERT_TRUE(job(again, after, drop, 0).Run().ok()) << t;
    for (std::size_t i = 0; i < jets.size(); ++i) {
      const auto grow = [&](const auto& a, const auto& b) {
        walk_.jump = std::max(walk_.jump, (a - b).norm());
      };
      grow(jets[i].rotation.coeffs(), again[i].rotation.coeffs());
      grow(jets[i].omega, again[i].omega);
      grow(jets[i].alpha, again[i].alpha);
      grow(jets[i].acceleration, again[i].acceleration);
    }
    check_rates(t);
    walk_.drop = std::max(walk_.drop, wanted[0].translation.z() - jets[0].translation.z());
    for (std::size_t k = 0; k < 2; ++k) measure(jets, k, before[k]);
  }
  /// The pose a little after this frame, of what the foot states are now.
  Pose soon_after(double t, double later) {
    if (ground_.body) body_ = ground_.body(t + later);
    Pose pose = animated(t + later);
    for (std::size_t k = 0; k < 2; ++k) cast_rays(pose, k);
    FootState<double> states[2] = {states_[0], states_[1]};
    SmoothInput<double> drop = drop_;
    EXPECT_TRUE(job(pose, states, drop, later).Run().ok());
    return pose;
  }
  /// Rates and accelerations against central differences.
  void check_rates(double t) {
    constexpr double h = 2e-5;  // s
    const Pose now = soon_after(t, 2 * h), before = soon_after(t, h), after = soon_after(t, 3 * h);
    for (std::size_t i = 0; i < now.size(); ++i) {
      const Vec turn = rotation_log<double>(before[i].rotation.conjugate() * after[i].rotation) / (2 * h),
                spin = (after[i].omega - before[i].omega) / (2 * h);
      const auto grow = [](double& most, const Vec& found, const Vec& said) {
        most = std::max(most, (found - said).norm() / (1 + said.norm()));
      };
      grow(walk_.rate, turn, now[i].omega);
      grow(walk_.acceleration, spin, now[i].alpha);
      walk_.peak = std::max(walk_.peak, now[i].alpha.norm());
    }
    if (ground_.body) body_ = ground_.body(t);
  }
  void measure(const Pose& jets, std::size_t k, const FootState<double>& before) {
    const FootState<double>& state = states_[k];
    const bool changed = state.hold != before.hold;
    walk_.locks += changed && state.locked();
    walk_.breaks += changed && !state.locked() && feet_[k].contact > 0.5;
    const Moving back = body_.inverse(), foot = model_motion<double>(jets, parents_, legs_[k].foot);
    const Moving hip = model_motion<double>(jets, parents_, legs_[k].upper),
                 knee = model_motion<double>(jets, parents_, legs_[k].middle);
    const auto apart = [](const Moving& a, const Moving& b) {
      return value_of<double>(MovingVector<double>(a.translation - b.translation)).norm();
    };
    walk_.knee = std::max(walk_.knee, apart(hip, foot) / (apart(hip, knee) + apart(knee, foot)));
    const Vec toe = value_of<double>(back * (foot * still<double>(legs_[k].toe))),
              heel = value_of<double>(back * (foot * still<double>(legs_[k].heel)));
    const auto over = [&](const Vec& point) { return point.z() - ground_.height(point.x(), point.y()); };
    for (const Vec& point : {toe, heel})
      if (const double deep = over(point); deep < 0)
        walk_.depth = std::max(walk_.depth, ground_.depth(point, -deep));
    // The frame's pose is that of the state before the frame changed it.
    const bool at_rest = !changed && state.at_rest();
    const Vec pivot = before.hold == FootHold::kHeel ? heel : toe;
    if (at_rest && !rested_[k]) {
      rest_[k] = pivot;
      if (!bore_[k])
        walk_.bearing = std::max(walk_.bearing, std::min(std::abs(over(toe)), std::abs(over(heel))));
    }
    if (at_rest) {
      ++walk_.settled;
      walk_.slide = std::max(walk_.slide, (pivot - rest_[k]).norm());
    }
    bore_[k] = state.locked() && (bore_[k] || at_rest);
    rested_[k] = at_rest;
  }

  const Clip& clip_;
  const Ground& ground_;
  std::span<const int> parents_;
  std::span<const FootLeg<double>> legs_;
  FootState<double> states_[2];
  SmoothInput<double> drop_;
  FootInput<double> feet_[2];
  std::array<GroundHit<double>, 2> under_[2];
  std::array<GroundHit<double>, 3> ahead_[2];
  Pose soon_[3];
  Moving body_;
  mutable Jet level_{0.0};
  Vec rest_[2];
  bool rested_[2] = {}, bore_[2] = {true, true};  // the walk begins anywhere, also on its toes over an edge
  Walk walk_;
};

/// What every ground is asked for.
void expect_good(const char* name, const Walk& w) {
  SCOPED_TRACE(name);
  std::printf(
      "%-16s slides %.3f mm, is %.2f mm deep (%.2f where it bears), leg %.4f, drop %.1f cm, jumps %.0e, "
      "rates off "
      "%.0e and %.0e, peak %.0f rad/s2\n",
      name, 1e3 * w.slide, 1e3 * w.depth, 1e3 * w.bearing, w.knee, 100 * w.drop, w.jump, w.rate,
      w.acceleration, w.peak);
  EXPECT_LT(w.slide, 1e-4) << "m, of a foot that bears";
  EXPECT_LT(w.depth, 2e-3) << "m, in the ground";
  EXPECT_LT(w.bearing, 2e-3) << "m, from the ground";
  EXPECT_LE(w.knee, 0.9995 + 1e-9) << "of a leg's length";
  EXPECT_LT(w.jump, 1e-6) << "at locks, releases and new ground";
  EXPECT_LT(w.rate, 1e-3) << "differences of poses over 40 µs";
  EXPECT_LT(w.acceleration, 1e-2) << "differences of rates over 40 µs: of corners a millimetre wide";
  EXPECT_GT(w.settled, 50);
}

/// A character on a ground, at any frame rate.
void expect_good_walks(const char* name, const Clip& clip, const Ground& ground, std::span<const int> parents,
                       std::span<const FootLeg<double>> legs) {
  for (const double rate : {30.0, 60.0, 144.0}) {
    SCOPED_TRACE(rate);
    expect_good(name, Walker(clip, ground, parents, legs).run(10, rate));
  }
}

Ground slope(double degrees, double across = 0) {
  const double x = std::tan(degrees * kPi / 180), y = std::tan(across * kPi / 180);
  Ground g;
  g.height = [=](double px, double py) { return x * px + y * py; };
  g.normal = [=](double, double) { return Vec(-x, -y, 1).normalized(); };
  g.level = [=](const Moving& root) { return x * root.translation.x() + y * root.translation.y(); };
  return g;
}

TEST_F(FootWalk, OnTheFlatTheWalkStaysWhatItIs) {
  const Ground flat;
  for (const double rate : {30.0, 60.0, 144.0}) {
    const Walk w = Walker(clip("walk"), flat, parents, legs).run(10, rate);
    expect_good("flat", w);
    EXPECT_LT(w.drop, 0.015) << "m, as much as others keep legs short (Holden's motion matching)";
  }
}
TEST_F(FootWalk, FeetDoNotSlideWhenTheRootIsTooFast) {
  for (const double speed : {0.85, 1.1}) {
    Ground flat;
    flat.speed = speed;
    expect_good_walks(speed < 1 ? "root too slow" : "root too fast", clip("walk"), flat, parents, legs);
  }
}
TEST_F(FootWalk, SlopesOfTwentyDegreesUpDownAndAcross) {
  for (const auto& [along, across] : {std::pair{20.0, 0.0}, {-20.0, 0.0}, {0.0, 20.0}, {12.0, -10.0}}) {
    const Ground g = slope(along, across);
    expect_good_walks("slope", clip("walk"), g, parents, legs);
  }
}

/// Steps of 18 cm, up or down, as long as those of the walk; the first one begins at a part of that.
Ground stairs(double rise, double tread, double from) {
  Ground g;
  const double start = from * tread;
  g.half_life = 0.07;  // from one step of the clip to the next a foot rises by two stairs
  g.height = [=](double x, double) { return rise * std::floor((x - start) / tread); };
  g.depth = [=](const Vec& point, double deep) {
    const double past = (point.x() - start) / tread - std::floor((point.x() - start) / tread);
    return std::min(deep, tread * (rise > 0 ? past : 1 - past));
  };
  g.level = [=](const Moving& root) {
    return (rise / tread) * (root.translation.x() - Jet(start)) - Jet(rise / 2);
  };
  return g;
}
TEST_F(FootWalk, StairsOfEighteenCentimetres) {
  const double tread = 0.5 * double(clip("walk").root_step.x());
  for (const double from : {0.0, 0.25, 0.5, 0.75}) {
    const Ground up = stairs(0.18, tread, from), down = stairs(-0.18, tread, from);
    expect_good_walks("stairs down", clip("walk"), down, parents, legs);
    if (from == 0.75) continue;  // below
    expect_good_walks("stairs up", clip("walk"), up, parents, legs);
  }
}
TEST_F(FootWalk, StairsAFewCentimetresInFrontOfTheToe) {
  const Ground up = stairs(0.18, 0.5 * double(clip("walk").root_step.x()), 0.75);
  const Walk w = Walker(clip("walk"), up, parents, legs).run(10, 60);
  EXPECT_LT(w.slide, 1e-4);
  EXPECT_LT(w.bearing, 2e-3);
  EXPECT_LT(w.jump, 1e-6);
  SINEW_FAILS_TODAY(w.depth < 2e-3,
                    "a foot that leaves 8 cm in front of a riser goes through its edge: the clip "
                    "swings it forward at 4 m/s, and only its height follows the ground");
}
TEST_F(FootWalk, PlatformThatMovesAndTurns) {
  Ground g;
  g.body = [](double t) {
    const double turn = 30 * kPi / 180, a = turn * t;
    JointJet<double> jet;
    jet.rotation = rotation_exp<double>({0, 0, a});
    jet.omega << 0, 0, turn;
    jet.translation << t, 0.2, 0;
    jet.velocity << 1, 0, 0;
    return moving_transform(jet);
  };
  for (const double speed : {1.0, 0.9}) {
    g.speed = speed;
    expect_good_walks("platform", clip("walk"), g, parents, legs);
  }
}
TEST_F(FootWalk, WhoStandsStands) {
  const Ground flat;
  expect_good_walks("standing", clip("stand"), flat, parents, legs);
}

}  // namespace
}  // namespace sinew
