// Model space, skinning, inverse kinematics and root motion.
#include <cmath>

#include "animation/moving_pose.h"
#include "sinew/animation/crossfade.h"
#include "sinew/animation/inverse_kinematics.h"
#include "sinew/animation/model_pose_job.h"
#include "sinew/animation/root_motion.h"
#include "sinew/animation/skinning_job.h"

namespace sinew {
namespace {

using fixtures::Pose;
using Vec = Vec3<double>;
using Moving = MovingVector<double>;

constexpr int kJoints = 11;
const std::vector<int> kParents = {-1, 0, 1, 2, 3, 4, 2, 6, 0, 8, 9};
const Clip kClip = fixtures::smooth_clip(4);

Pose pose_at(double t) {
  return fixtures::sampled(kClip, t);
}

std::vector<Transform<double>> model_of(const Pose& jets) {
  std::vector<Transform<double>> model(jets.size());
  EXPECT_TRUE((ModelPoseJob<double>{kParents, jets, {}, {}, model}.Run().ok()));
  return model;
}

/// A point on a smooth path with its derivatives.
Moving path(double t, const Vec& middle, double size) {
  return {TimeJet<double>{middle.x() + size * std::sin(3 * t), 3 * size * std::cos(3 * t),
                          -9 * size * std::sin(3 * t)},
          TimeJet<double>{middle.y() + size * std::cos(2 * t), -2 * size * std::sin(2 * t),
                          -4 * size * std::cos(2 * t)},
          TimeJet<double>{middle.z() + size * t, size, 0}};
}

TEST(ModelPose, ChainsEveryJointToItsParentAndTheRootToItsPlace) {
  const Pose jets = pose_at(0.7);
  const Transform<double> place{rotation_exp<double>({0.1, 0.4, -2}), {3, 2, 1}};
  std::vector<Transform<double>> model(kJoints), poses;
  for (const JointJet<double>& jet : jets) poses.push_back({jet.rotation, jet.translation});
  ASSERT_TRUE((ModelPoseJob<double>{kParents, jets, {}, place, model}.Run().ok()));
  for (int i = 0; i < kJoints; ++i) {
    Vec point{0.1, 0.2, 0.3}, wanted = point;
    for (int j = i; j >= 0; j = kParents[j]) wanted = jets[j].rotation * wanted + jets[j].translation;
    EXPECT_LT((model[i] * point - place * wanted).norm(), 1e-14);
  }
  ASSERT_TRUE((ModelPoseJob<double>{kParents, {}, poses, place, poses}.Run().ok()));
  for (int i = 0; i < kJoints; ++i) EXPECT_EQ(poses[i].translation, model[i].translation) << "in place";
}

TEST(ModelPose, RefusesChildrenBeforeParentsAndShortInputs) {
  const Pose jets = pose_at(0.7);
  std::vector<Transform<double>> model(kJoints);
  std::vector<int> parents = kParents;
  EXPECT_FALSE((ModelPoseJob<double>{parents, {}, {}, {}, model}.Run().ok()));
  EXPECT_FALSE((ModelPoseJob<double>{parents, std::span(jets).first(4), {}, {}, model}.Run().ok()));
  parents[3] = 3;
  EXPECT_EQ((ModelPoseJob<double>{parents, jets, {}, {}, model}.Run().index), 3);
}

TEST(MovingTransform, ModelMotionIsTheDerivativeOfTheModelPose) {
  fixtures::expect_consistent(
      [](double t) {
        Pose model;
        const Pose jets = pose_at(t);
        for (int i = 0; i < kJoints; ++i) model.push_back(joint_jet(model_motion<double>(jets, kParents, i)));
        return model;
      },
      {0.31, 1.7}, 2e-4);  // chains of six add up to faster motion
  const Pose jets = pose_at(0.7);
  const auto model = model_of(jets);
  EXPECT_LT(
      (value_of<double>(model_motion<double>(jets, kParents, 5).translation) - model[5].translation).norm(),
      1e-14);
}

TEST(MovingTransform, JetsComeBackUnchanged) {
  for (const JointJet<double>& jet : pose_at(0.7)) {
    const JointJet<double> back = joint_jet(moving_transform(jet));
    EXPECT_LT(back.rotation.angularDistance(jet.rotation), 1e-7);
    EXPECT_LT((back.omega - jet.omega).norm(), 1e-13);
    EXPECT_LT((back.alpha - jet.alpha).norm(), 1e-12);
    EXPECT_EQ(back.acceleration, jet.acceleration);
  }
}

/// A limb of 0.4 and 0.3 m below a moving root.
struct Limb {
  static constexpr int kUpper = 1, kMiddle = 2, kEnd = 3;
  std::vector<int> parents{-1, 0, 1, 2};
  Clip clip = fixtures::smooth_clip(9, 4);

  Pose at(double t) const {
    Pose jets = fixtures::sampled(clip, t);
    const Vec bones[] = {{0.1, 0, 0}, {0, 0, -0.4}, {0, 0, -0.3}};
    for (int i = 1; i < 4; ++i) {
      jets[i].translation = bones[i - 1];
      jets[i].velocity.setZero();
      jets[i].acceleration.setZero();
    }
    return jets;
  }
  MovingTransform<double> model(const Pose& jets, int joint) const {
    return model_motion<double>(jets, parents, joint);
  }
  Vec position(const Pose& jets, int joint) const { return value_of<double>(model(jets, joint).translation); }
  TwoBoneJob<double> job(Pose& jets, const Moving& target) const {
    TwoBoneJob<double> job;
    job.parents = parents;
    job.jets = jets;
    job.upper = kUpper;
    job.middle = kMiddle;
    job.end = kEnd;
    job.target = target;
    return job;
  }
  /// Somewhere at `distance` from the upper joint.
  Vec target(const Pose& jets, double distance, const Vec& direction = {0.3, 0.8, -0.5}) const {
    return position(jets, kUpper) + distance * direction.normalized();
  }
};

TEST(TwoBone, ReachesEveryTargetWithinReach) {
  const Limb limb;
  for (const double distance : {0.12, 0.3, 0.5, 0.66})
    for (const bool hinge : {false, true}) {
      Pose jets = limb.at(0.7);
      const Pose before = jets;
      const Vec target = limb.target(jets, distance);
      auto job = limb.job(jets, still<double>(target));
      if (hinge) job.hinge = Vec::UnitY();
      ASSERT_TRUE(job.Run().ok());
      EXPECT_LT((limb.position(jets, Limb::kEnd) - target).norm(), 1e-12);
      EXPECT_NEAR((limb.position(jets, Limb::kMiddle) - limb.position(jets, Limb::kUpper)).norm(), 0.4,
                  1e-12);
      // The end keeps its orientation, the root is not touched.
      EXPECT_LT(joint_jet(limb.model(jets, Limb::kEnd))
                    .rotation.angularDistance(joint_jet(limb.model(before, Limb::kEnd)).rotation),
                1e-7);
      fixtures::expect_same_bits(jets[0], before[0]);
    }
}

TEST(TwoBone, StopsShortOfStraightTowardsATargetBeyondReach) {
  const Limb limb;
  for (const double distance : {0.7, 0.75, 5.0}) {
    Pose jets = limb.at(0.7);
    const Vec target = limb.target(jets, distance), hip = limb.position(jets, Limb::kUpper);
    ASSERT_TRUE(limb.job(jets, still<double>(target)).Run().ok());
    const Vec reached = limb.position(jets, Limb::kEnd) - hip;
    EXPECT_LT(reached.normalized().cross((target - hip).normalized()).norm(), 1e-12) << "wrong direction";
    EXPECT_LE(reached.norm(), 0.9995 * 0.7 + 1e-12);
    EXPECT_GE(reached.norm(), 0.95 * 0.7);
  }
}

TEST(TwoBone, TargetNearerThanTheLimbFoldsEndsAtTheNearest) {
  const Limb limb;
  Pose jets = limb.at(0.7);
  ASSERT_TRUE(limb.job(jets, still<double>(limb.target(jets, 0.05))).Run().ok());
  EXPECT_NEAR((limb.position(jets, Limb::kEnd) - limb.position(jets, Limb::kUpper)).norm(), 0.1, 5e-4);
}

TEST(TwoBone, KneePointsToThePoleAndBendsAboutItsHingeAlone) {
  const Limb limb;
  Pose jets = limb.at(0.7);
  jets[Limb::kMiddle].rotation = rotation_exp<double>({0, 0.4, 0});
  const Vec target = limb.target(jets, 0.5), hip = limb.position(jets, Limb::kUpper), pole{1, 0.2, 0.4};
  auto job = limb.job(jets, still<double>(target));
  job.pole = still<double>(pole);
  job.hinge = Vec::UnitY();
  ASSERT_TRUE(job.Run().ok());
  const Vec line = (target - hip).normalized(), knee = limb.position(jets, Limb::kMiddle) - hip;
  const Vec aside = knee - line * line.dot(knee), wanted = (pole - line * line.dot(pole)).normalized();
  EXPECT_NEAR(aside.normalized().dot(wanted), 1, 1e-12);
  EXPECT_NEAR(jets[Limb::kMiddle].rotation.x(), 0, 1e-12);
  EXPECT_NEAR(jets[Limb::kMiddle].rotation.z(), 0, 1e-12);
}

TEST(TwoBone, MovesAsItsDerivativesSayWithinReachAndWhereItSlowsDown) {
  const Limb limb;
  for (const double distance : {0.45, 0.72})
    for (const bool hinge : {false, true})
      fixtures::expect_consistent(
          [&](double t) {
            Pose jets = limb.at(t);
            auto job = limb.job(jets, path(t, limb.target(limb.at(0.7), distance), 0.02));
            if (hinge) job.hinge = Vec::UnitY();
            job.pole = still<double>({1, 0.2, 0.4});
            job.weight = EaseWeight<double>::at(t, 1.5);
            EXPECT_TRUE(job.Run().ok());
            return jets;
          },
          {0.5, 0.69, 0.72, 0.9}, 5e-4);  // h² times third derivatives near the straight limb
}

TEST(TwoBone, WeightOfZeroChangesNothing) {
  const Limb limb;
  Pose jets = limb.at(0.7);
  const Pose before = jets;
  auto job = limb.job(jets, still<double>({0, 0, 0}));
  job.weight = {0, 0, 0};
  ASSERT_TRUE(job.Run().ok());
  for (std::size_t i = 0; i < jets.size(); ++i) fixtures::expect_same_bits(jets[i], before[i]);
}

TEST(TwoBone, RefusesWhatCannotBeMeant) {
  const Limb limb;
  Pose jets = limb.at(0.7);
  const auto status_of = [&](auto change) {
    auto job = limb.job(jets, still<double>({0.2, 0.2, 0.2}));
    change(job);
    return job.Run();
  };
  EXPECT_EQ(status_of([](auto& job) { job.end = 9; }).index, 9);
  EXPECT_FALSE(status_of([](auto& job) { std::swap(job.upper, job.middle); }).ok());
  EXPECT_EQ(status_of([](auto& job) { job.target.x() = NAN; }).code, Code::kNotFinite);
  EXPECT_EQ(status_of([](auto& job) { job.weight = TimeJet<double>(1.5); }).code, Code::kOutOfRange);
  EXPECT_EQ(status_of([](auto& job) { job.softness = 0; }).code, Code::kOutOfRange);
  EXPECT_FALSE(status_of([&](auto& job) { job.target = still<double>(limb.position(jets, 1)); }).ok());
  EXPECT_FALSE(
      status_of([&](auto& job) { job.pole = job.target - still<double>(limb.position(jets, 1)); }).ok());
}

TEST(Aim, AxisPointsToTheTargetOrAsFarTowardsItAsTheLimit) {
  const Limb limb;
  for (const double limit : {3.0, 0.2}) {
    Pose jets = limb.at(0.7);
    const MovingTransform<double> before = limb.model(jets, 3);
    AimJob<double> job{limb.parents, jets, 3};
    job.axis = Vec(1, 2, 2) / 3;
    job.target = still<double>({1, 2, 3});
    job.limit = limit;
    ASSERT_TRUE(job.Run().ok());
    const Quat<double> now = joint_jet(limb.model(jets, 3)).rotation, old = joint_jet(before).rotation;
    const Vec wanted = Vec(1, 2, 3) - value_of<double>(before.translation);
    const double asked = std::acos((old * job.axis).dot(wanted.normalized()));
    ASSERT_GT(asked, 0.2);
    EXPECT_NEAR(std::acos(std::min(1.0, (now * job.axis).dot(wanted.normalized()))),
                std::max(0.0, asked - limit), 1e-7);
  }
}

TEST(Aim, MovesAsItsDerivativesSay) {
  const Limb limb;
  for (const double limit : {3.0, 0.2})
    fixtures::expect_consistent(
        [&](double t) {
          Pose jets = limb.at(t);
          AimJob<double> job{limb.parents, jets, 3};
          job.axis = Vec(1, 2, 2) / 3;
          job.target = path(t, {1, 2, 3}, 0.5);
          job.weight = EaseWeight<double>::at(t, 1.5);
          job.limit = limit;
          EXPECT_TRUE(job.Run().ok());
          return jets;
        },
        {0.5, 0.7, 0.9}, 1e-4);
}

TEST(Aim, RefusesATargetStraightBehind) {
  const Limb limb;
  Pose jets = limb.at(0.7);
  AimJob<double> job{limb.parents, jets, 3};
  const MovingTransform<double> frame = limb.model(jets, 3);
  job.target = frame.translation - frame.rotation * still<double>(job.axis);
  EXPECT_EQ(job.Run().code, Code::kOutOfRange);
  job.target = frame.translation;
  EXPECT_FALSE(job.Run().ok());
}

TEST(RootMotion, TravelAndBodyTogetherAreTheRootAndMoveAsTheySay) {
  for (const double t : {0.3, 0.7, 1.9}) {
    const JointJet<double> root = pose_at(t)[0];
    const RootMotion<double> split = split_root(root);
    const JointJet<double> again =
        joint_jet<double>(moving_transform(split.travel) * moving_transform(split.body));
    EXPECT_LT(again.rotation.angularDistance(root.rotation), 1e-7);
    EXPECT_LT((again.alpha - root.alpha).norm(), 1e-10);
    EXPECT_LT((again.acceleration - root.acceleration).norm(), 1e-10);
    EXPECT_EQ(split.travel.translation.z(), 0);
    EXPECT_LT((split.travel.rotation * Vec::UnitZ() - Vec::UnitZ()).norm(), 1e-14);
    EXPECT_NEAR(split.body.rotation.z(), 0, 1e-14) << "the body has no heading left";
  }
  fixtures::expect_consistent(
      [](double t) {
        const RootMotion<double> split = split_root(pose_at(t)[0]);
        return Pose{split.travel, split.body};
      },
      {0.31, 1.7}, 5e-5);
}

TEST(RootMotion, TravelAccumulatesOverTheSeamOfALoop) {
  Clip clip = kClip;
  clip.root_step = {1.5f, 0.5f, 0};
  const auto travel = [&](double t) { return split_root(fixtures::sampled(clip, t)[0]).travel; };
  Transform<double> place;
  for (double t = 0; t < 4 * clip.duration - 0.01; t += 0.05)
    place = place * travel_between(travel(t), travel(t + 0.05));
  const Transform<double> begin{travel(0).rotation, travel(0).translation};
  const Vec moved = (begin * place * begin.inverse() * begin).translation - begin.translation;
  EXPECT_LT((moved - Vec(6, 2, 0)).norm(), 1e-9);
}

TEST(Skinning, EqualsTheSlowFormula) {
  std::vector<Transform<float>> model, bind;
  for (const Transform<double>& frame : model_of(pose_at(0.7))) model.push_back(frame.cast<float>());
  for (const Transform<double>& frame : model_of(pose_at(2.1))) bind.push_back(frame.cast<float>());
  std::vector<SkinMatrix> palette(kJoints);
  skinning_palette(model, bind, palette);
  constexpr int kVertices = 37;
  std::mt19937 random(20261121);
  std::normal_distribution<float> normal;
  for (int influences = 1; influences <= 5; ++influences) {
    std::vector<std::uint16_t> joints(kVertices * influences);
    std::vector<float> weights(kVertices * influences), positions(3 * kVertices), normals(3 * kVertices);
    for (std::uint16_t& joint : joints) joint = std::uint16_t(random() % kJoints);
    for (float& x : positions) x = normal(random);
    for (int i = 0; i < kVertices; ++i) {
      Eigen::Map<Eigen::VectorXf> w(weights.data() + i * influences, influences);
      for (float& x : w) x = std::abs(normal(random));
      w /= w.sum();
      const Vec3<float> n = Vec3<float>(normal(random), normal(random), normal(random)).normalized();
      std::copy_n(n.data(), 3, normals.data() + 3 * i);
    }
    std::vector<float> out(3 * kVertices), out_normals(3 * kVertices);
    const SkinningJob job{palette, influences, joints, weights, positions, normals, out, out_normals};
    ASSERT_TRUE(job.Run().ok());
    for (int i = 0; i < kVertices; ++i) {
      const Eigen::Map<Vec3<float>> position(positions.data() + 3 * i), n(normals.data() + 3 * i);
      Vec wanted = Vec::Zero(), turned = Vec::Zero();
      for (int k = 0; k < influences; ++k) {
        const int joint = joints[i * influences + k];
        const double w = weights[i * influences + k];
        const Transform<double> bone = model[joint].cast<double>() * bind[joint].cast<double>().inverse();
        wanted += w * (bone * position.cast<double>());
        turned += w * (bone.rotation * n.cast<double>());
      }
      const Eigen::Map<Vec3<float>> placed(out.data() + 3 * i), facing(out_normals.data() + 3 * i);
      EXPECT_LT((placed.cast<double>() - wanted).norm(), 1e-5);  // float, metres
      EXPECT_LT((facing.cast<double>() - turned.normalized()).norm(), 1e-5 / turned.norm());
    }
  }
}

TEST(Skinning, RefusesWhatCannotBeMeant) {
  const std::vector<SkinMatrix> palette(3);
  std::vector<std::uint16_t> joints(8);
  std::vector<float> weights(8), positions(6), out(6);
  const auto job = [&] { return SkinningJob{palette, 4, joints, weights, positions, {}, out}; };
  EXPECT_TRUE(job().Run().ok());
  joints[6] = 3;
  EXPECT_EQ(job().Run().index, 1);
  joints[6] = 0;
  weights.pop_back();
  EXPECT_FALSE(job().Run().ok());
}

}  // namespace
}  // namespace sinew
