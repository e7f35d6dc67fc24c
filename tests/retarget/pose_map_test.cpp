// Forward kinematics from one skeleton to another: rest poses, bone axes, numbers of joints.
#include <random>

#include "retarget/figures.h"

namespace sinew::retarget::test {
namespace {

Motion moved(const Skeleton& from, const Skeleton& to, const Motion& motion) {
  PoseMap map;
  const Error error = map_poses(from, true, to, true, {}, map);
  EXPECT_FALSE(error) << error.message;
  return retarget_motion(map, motion, {}, false).motion;
}

TEST(PoseMap, TheSameSkeletonGetsTheSameMotion) {
  const Asset& figure = mannequin();
  for (const Clip& clip : figure.clips) {
    const Motion motion = sample_motion(clip, figure.skeleton);
    const Motion same = moved(figure.skeleton, figure.skeleton, motion);
    EXPECT_LT(apart(motion, same), 1e-6) << clip.name;     // rad, the figure asked for
    EXPECT_LT(distance(motion, same), 1e-6) << clip.name;  // m
  }
}

/// The mannequin rests with its arms a little off its sides.
Skeleton with_arms_level() {
  Skeleton level = mannequin().skeleton;
  for (const Role role : {Role::kUpperArmL, Role::kUpperArmR}) {
    const auto rest = model_rest(level);
    const int arm = level.find(role),
              elbow = level.find(role == Role::kUpperArmL ? Role::kForearmL : Role::kForearmR);
    const Vec3<double> bone = (rest[elbow].translation - rest[arm].translation).normalized();
    const Vec3<double> side(0, role == Role::kUpperArmL ? 1 : -1, 0);
    turn_rest(level, role, std::acos(bone.dot(side)) * bone.cross(side).normalized());
  }
  return level;
}

TEST(PoseMap, ArmsThatRestLevelMoveAsThoseThatHang) {
  const Skeleton &hanging = mannequin().skeleton, level = with_arms_level();
  for (const Clip& clip : mannequin().clips) {
    const Motion motion = sample_motion(clip, hanging);
    // The same body but for its rest: the same poses, and back again.
    const Motion there = moved(hanging, level, motion), back = moved(level, hanging, there);
    EXPECT_LT(apart(motion, there), 0.1 * kDegree) << clip.name;
    EXPECT_LT(apart(motion, back), 0.1 * kDegree) << clip.name;  // the figure asked for
  }
}

TEST(PoseMap, ArmsAndTrunkComeBackFromARestThatIsNeither) {
  Skeleton odd = mannequin().skeleton;
  turn_rest(odd, Role::kUpperArmL, {0.4, 0.9, -0.3});
  turn_rest(odd, Role::kForearmL, {0.2, -0.8, 0.5});
  turn_rest(odd, Role::kSpine, {0, 0.5, 0});
  for (const Clip& clip : mannequin().clips) {
    const Motion motion = sample_motion(clip, mannequin().skeleton);
    const Motion back = moved(odd, mannequin().skeleton, moved(mannequin().skeleton, odd, motion));
    EXPECT_LT(apart(motion, back), 0.1 * kDegree) << clip.name;
  }
}

TEST(PoseMap, BonesPointWhereTheSourcesDoWhateverTheAxesOfTheirJoints) {
  const Skeleton& from = mannequin().skeleton;
  Skeleton to = with_arms_level();
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<Transform<double>> model = model_rest(to);
  for (std::size_t j = 0; j < model.size(); ++j) {
    const Quat<double> axes =
        Quat<double>(normal(random), normal(random), normal(random), normal(random)).normalized();
    to.joints[j].axis = axes.conjugate() * to.joints[j].axis;
    for (Collider& collider : to.colliders)
      if (collider.joint == int(j))
        collider.local = Transform<double>{axes, {0, 0, 0}}.inverse() * collider.local;
    model[j].rotation = model[j].rotation * axes;
  }
  for (std::size_t j = 0; j < model.size(); ++j) {
    const int parent = to.joints[j].parent;
    to.joints[j].rest = parent < 0 ? model[j] : model[parent].inverse() * model[j];
  }
  const Clip& clip = mannequin().clips[std::size_t(mannequin().find_clip("run"))];
  const Motion motion = sample_motion(clip, from), there = moved(from, to, motion);
  for (const Role role : {Role::kForearmL, Role::kHandR, Role::kShinL, Role::kFootR, Role::kHead}) {
    const int joint = from.find(role), parent = from.joints[joint].parent;
    for (std::size_t f = 0; f < motion.model.size(); ++f) {
      const Vec3<double> a = motion.model[f][joint].translation - motion.model[f][parent].translation,
                         b = there.model[f][joint].translation - there.model[f][parent].translation;
      EXPECT_LT(std::atan2(a.cross(b).norm(), a.dot(b)), 0.1 * kDegree) << from.joints[joint].name;
    }
  }
}

/// The mannequin with every spine joint cut in two.
Skeleton with_more_spine() {
  const Skeleton& from = mannequin().skeleton;
  Skeleton to;
  std::vector<int> moved_to(from.joints.size());
  for (std::size_t j = 0; j < from.joints.size(); ++j) {
    Joint joint = from.joints[j];
    joint.parent = joint.parent < 0 ? -1 : moved_to[joint.parent];
    const bool spine = joint.role == Role::kSpine || joint.role == Role::kChest;
    if (spine) {
      Joint half = joint;
      half.name += "_half";
      half.rest.translation *= 0.5;
      half.rest.rotation.setIdentity();
      half.role = Role::kNone;
      joint.rest.translation *= 0.5;
      joint.parent = static_cast<int>(to.joints.size());
      to.joints.push_back(half);
    }
    moved_to[j] = static_cast<int>(to.joints.size());
    to.joints.push_back(joint);
  }
  to.body_count = static_cast<int>(to.joints.size());
  return to;
}

TEST(PoseMap, ATrunkOfMoreJointsBendsInAllOfThemAndAsFar) {
  const Skeleton &from = mannequin().skeleton, to = with_more_spine();
  PoseMap map;
  ASSERT_FALSE(map_poses(from, true, to, true, {}, map));
  ASSERT_EQ(map.from[Role::kSpine].joints.size(), 3u);
  ASSERT_EQ(map.to[Role::kSpine].joints.size(), 6u);
  std::vector<Transform<double>> local;
  for (const Joint& joint : from.joints) local.push_back(joint.rest);
  for (const int j : map.from[Role::kSpine].joints)
    local[j].rotation = local[j].rotation * Quat<double>(Eigen::AngleAxisd(0.3, Vec3<double>::UnitX()));
  const auto model = model_of(from, local);
  const auto out = model_of(to, follow(map, local, model));
  double before = 0;
  for (const int j : map.to[Role::kSpine].joints) {
    const double turned = out[j].rotation.angularDistance(map.to_rest[j].rotation);
    EXPECT_GE(turned, before - 1e-9);
    EXPECT_LT(turned - before,
              0.31);  // no joint bends more than the source's, and the first as far as its own
    before = turned;
  }
  const int head = to.find(Role::kHead), theirs = from.find(Role::kHead);
  EXPECT_LT(out[head].rotation.angularDistance(model[theirs].rotation), 1e-9);
  EXPECT_NEAR(before, 0.9, 1e-6);
}

TEST(PoseMap, SaysWhichPartIsMissing) {
  PoseMap map;
  Skeleton nameless = mannequin().skeleton;
  for (Joint& joint : nameless.joints) joint.role = Role::kNone;
  const Error none = map_poses(nameless, true, mannequin().skeleton, true, {}, map);
  EXPECT_NE(none.message.find("the clips' skeleton: none of its 22 joints"), std::string::npos)
      << none.message;
  Skeleton legless = mannequin().skeleton;
  legless.joints[std::size_t(legless.find(Role::kShinR))].role = Role::kNone;
  const Error leg = map_poses(mannequin().skeleton, true, legless, true, {}, map);
  EXPECT_NE(leg.message.find("the target: no joint is known as its shin_r"), std::string::npos)
      << leg.message;
}

TEST(PoseMap, FindsWhatStandsAboveAKnownJoint) {
  Skeleton figure = mannequin().skeleton;
  const int thigh = figure.find(Role::kThighL), arm = figure.find(Role::kUpperArmR);
  figure.joints[thigh].role = figure.joints[arm].role = Role::kNone;
  infer_roles(figure);
  EXPECT_EQ(figure.find(Role::kThighL), thigh);
  EXPECT_EQ(figure.find(Role::kUpperArmR), arm);
}

}  // namespace
}  // namespace sinew::retarget::test
