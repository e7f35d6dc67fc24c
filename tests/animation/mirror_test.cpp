// Left and right exchanged: which joints change places, and what becomes of a motion.
#include <cmath>

#include "animation/moving_pose.h"
#include "sinew/animation/clip_event.h"
#include "sinew/animation/mirror_job.h"
#include "sinew/animation/model_pose_job.h"
#include "sinew/animation/side_names.h"

namespace sinew {
namespace {

using fixtures::Pose;
using fixtures::sampled;
using Vec = Vec3<double>;

/// Pelvis, two legs of three joints, a neck; the axes of the left leg point anywhere.
Skeleton rig(bool twisted) {
  Skeleton s;
  const auto add = [&](const char* name, int parent, const Vec& at) {
    Joint joint;
    joint.name = name;
    joint.parent = parent;
    joint.rest.translation = at;
    s.joints.push_back(joint);
  };
  add("pelvis", -1, {0, 0, 1});
  add("thigh_l", 0, {0, 0.1, -0.05});
  add("shin_l", 1, {0, 0.01, -0.45});
  add("foot_l", 2, {0, 0, -0.4});
  add("thigh_r", 0, {0, -0.1, -0.05});
  add("shin_r", 4, {0, -0.01, -0.45});
  add("foot_r", 5, {0, 0, -0.4});
  add("neck", 0, {0.02, 0, 0.5});
  if (!twisted) return s;
  Quat<double> above = Quat<double>::Identity();
  for (int i = 0; i <= 3; ++i) {  // the same places, other axes
    Joint& joint = s.joints[std::size_t(i)];
    const Quat<double> axes = rotation_exp<double>({0.3 * i + 0.2, 1.1, -0.7 * i});
    joint.rest = {above.conjugate() * axes, above.conjugate() * joint.rest.translation};
    above = axes;
  }
  for (const int i : {4, 7}) {  // hang on the pelvis, whose axes have turned
    const Quat<double> pelvis = s.joints[0].rest.rotation;
    s.joints[std::size_t(i)].rest = {pelvis.conjugate(),
                                     pelvis.conjugate() * s.joints[std::size_t(i)].rest.translation};
  }
  return s;
}
std::vector<int> parents_of(const Skeleton& s) {
  std::vector<int> parents;
  for (const Joint& joint : s.joints) parents.push_back(joint.parent);
  return parents;
}
/// Everything turns and shifts, about rest.
Pose motion(const Skeleton& s, double t) {
  Pose jets = sampled(fixtures::smooth_clip(3, int(s.joints.size())), t);
  for (std::size_t i = 0; i < jets.size(); ++i) {
    jets[i].rotation = s.joints[i].rest.rotation * jets[i].rotation;
    jets[i].translation += s.joints[i].rest.translation;
  }
  return jets;
}
template <class T>
MirrorMap<T> map_of(const Skeleton& s, std::vector<MirrorWarning>* warnings = nullptr) {
  MirrorMap<T> map;
  EXPECT_TRUE(build_mirror_map<T>(s, map, warnings).ok());
  return map;
}
Pose mirrored(const Skeleton& s, const Pose& jets) {
  const MirrorMap<double> map = map_of<double>(s);
  Pose out(jets.size());
  EXPECT_TRUE((MirrorJob<double>{&map, jets, out}.Run().ok()));
  return out;
}
std::vector<Transform<double>> model_of(const Skeleton& s, const Pose& jets) {
  std::vector<Transform<double>> model(jets.size());
  EXPECT_TRUE((ModelPoseJob<double>{parents_of(s), jets, {}, {}, model}.Run().ok()));
  return model;
}

TEST(MirroredName, ExchangesSidesThatAreWords) {
  const char* const pairs[][2] = {
      {"LeftFoot", "RightFoot"},  {"mixamorig:LeftHandThumb1", "mixamorig:RightHandThumb1"},
      {"hand_l", "hand_r"},       {"thigh.L", "thigh.R"},
      {"L_thigh", "R_thigh"},     {"Bip01 L Finger0", "Bip01 R Finger0"},
      {"LHipJoint", "RHipJoint"}, {"lThigh", "rThigh"},
      {"leftarm", "rightarm"},    {"arm_left_01", "arm_right_01"},
      {"ARM_LEFT", "ARM_RIGHT"},  {"toe_l2", "toe_r2"}};
  for (const auto& pair : pairs) {
    EXPECT_EQ(mirrored_name(pair[0]), pair[1]);
    EXPECT_EQ(mirrored_name(pair[1]), pair[0]);
  }
  for (const char* name : {"pelvis", "lowerback", "Root", "tail_01", "ulna", "", "_", "upright"})
    EXPECT_EQ(mirrored_name(name), name);
}

TEST(MirroredName, OfEventsIsLookedUpByNumber) {
  const std::vector<std::string> names = {"step_left",  "step_right", "hit",
                                          "left_alone", "lstrike",    "rstrike"};
  const EventMirror mirror = mirror_events(names);
  EXPECT_EQ(mirror(event_name("step_left")), event_name("step_right"));
  EXPECT_EQ(mirror(event_name("step_right")), event_name("step_left"));
  EXPECT_EQ(mirror(event_name("rstrike")), event_name("lstrike"));
  for (const char* name : {"hit", "left_alone", "unknown"})
    EXPECT_EQ(mirror(event_name(name)), event_name(name));
}

TEST(MirrorMap, FindsPartnersByNameByRoleAndByPlace) {
  Skeleton s = rig(false);
  const std::vector<std::uint16_t> wanted = {0, 4, 5, 6, 1, 2, 3, 7};
  std::vector<MirrorWarning> warnings;
  EXPECT_EQ(map_of<double>(s, &warnings).partners, wanted);
  for (Joint& joint : s.joints) joint.name.clear();
  EXPECT_EQ(map_of<double>(s, &warnings).partners, wanted) << "by place";
  EXPECT_TRUE(warnings.empty());
  s.joints[1].role = Role::kThighL;
  s.joints[4].role = Role::kThighR;
  s.joints[1].rest.translation.x() += 0.2;
  EXPECT_EQ(map_of<double>(s, &warnings).partners[1], 4) << "by role, then";
  ASSERT_FALSE(warnings.empty());
  EXPECT_EQ(warnings[0].joint, 1);
}

TEST(MirrorMap, SaysWhatHasNoPartnerAndLeavesItAlone) {
  Skeleton s = rig(false);
  Joint sword;
  sword.name = "sword";
  sword.parent = 6;
  sword.rest.translation << 0.2, 0, 0;
  s.joints.push_back(sword);
  std::vector<MirrorWarning> warnings;
  const MirrorMap<double> map = map_of<double>(s, &warnings);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].joint, 8);
  EXPECT_EQ(map.partners[8], kNoPartner);
  const Pose jets = motion(s, 0.7);
  Pose out(jets.size());
  ASSERT_TRUE((MirrorJob<double>{&map, jets, out}.Run().ok()));
  fixtures::expect_same_bits(out[8], jets[8]);
  // A pair whose parents are no pair is none: the left foot hangs on the thigh, the right one on the shin.
  s = rig(false);
  s.joints[3].parent = 1;
  warnings.clear();
  EXPECT_EQ(map_of<double>(s, &warnings).partners[3], kNoPartner);
  EXPECT_EQ(warnings.size(), 2u);
}

TEST(MirrorMap, RefusesWhatCannotBeMeant) {
  MirrorMap<double> map;
  EXPECT_EQ(build_mirror_map<double>({}, map).code, Code::kInvalidArgument);
  Skeleton s = rig(false);
  s.joints[2].rest.translation.x() = NAN;
  EXPECT_EQ(build_mirror_map<double>(s, map).index, 2);
  s = rig(false);
  s.joints[2].parent = 2;
  EXPECT_EQ(build_mirror_map<double>(s, map).index, 2);
  s = rig(false);
  map = map_of<double>(s);
  Pose jets = motion(s, 0.7), out(8);
  EXPECT_TRUE((MirrorJob<double>{&map, jets, out}.Run().ok()));
  EXPECT_FALSE((MirrorJob<double>{nullptr, jets, out}.Run().ok()));
  EXPECT_FALSE((MirrorJob<double>{&map, std::span(jets).first(5), out}.Run().ok()));
  out.resize(9);
  EXPECT_FALSE((MirrorJob<double>{&map, jets, out}.Run().ok()));
}

TEST(Mirror, ModelPoseIsTheMirrorImage) {
  for (const bool twisted : {false, true}) {
    const Skeleton s = rig(twisted);
    const Pose jets = motion(s, 0.7);
    const auto before = model_of(s, jets), after = model_of(s, mirrored(s, jets));
    const std::vector<int> partners = {0, 4, 5, 6, 1, 2, 3, 7};
    for (std::size_t i = 0; i < jets.size(); ++i) {
      Vec image = before[std::size_t(partners[i])].translation;
      image.y() = -image.y();
      EXPECT_LT((after[i].translation - image).norm(), 1e-14) << i << twisted;
    }
  }
}

TEST(Mirror, RestStaysRestAndTwiceIsTheMotionAgain) {
  for (const bool twisted : {false, true}) {
    Skeleton s = rig(twisted);
    s.joints[2].rest.translation *= 1.1;  // and a longer left leg, with a bent foot
    s.joints[3].rest.rotation = rotation_exp<double>({0.2, 0.3, 0}) * s.joints[3].rest.rotation;
    Pose rest(s.joints.size());
    for (std::size_t i = 0; i < rest.size(); ++i) {
      rest[i].rotation = s.joints[i].rest.rotation;
      rest[i].translation = s.joints[i].rest.translation;
    }
    const Pose still = mirrored(s, rest);
    for (std::size_t i = 0; i < rest.size(); ++i) {
      EXPECT_LT((still[i].translation - rest[i].translation).norm(), 1e-14);
      EXPECT_LT(still[i].rotation.angularDistance(rest[i].rotation), 1e-7);
    }
    const MirrorMap<float> map = map_of<float>(s);
    const Pose jets = motion(s, 0.7);
    std::vector<JointJet<float>> twice(jets.size()), once;
    for (std::size_t i = 0; i < jets.size(); ++i) {
      twice[i].rotation = jets[i].rotation.cast<float>();
      twice[i].omega = jets[i].omega.cast<float>();
      twice[i].alpha = jets[i].alpha.cast<float>();
      twice[i].translation = jets[i].translation.cast<float>();
      twice[i].velocity = jets[i].velocity.cast<float>();
    }
    once = twice;
    for (int n = 0; n < 2; ++n) ASSERT_TRUE((MirrorJob<float>{&map, twice, twice}.Run().ok()));
    for (std::size_t i = 0; i < jets.size(); ++i) {  // 1e-6: what the specification asks of float
      const auto close = [&](const auto& a, const auto& b) {
        EXPECT_LT((a - b).norm(), 1e-6 * (1 + b.norm())) << i;
      };
      close(twice[i].rotation.coeffs(), once[i].rotation.coeffs());
      close(twice[i].omega, once[i].omega);
      close(twice[i].alpha, once[i].alpha);
      close(twice[i].translation, once[i].translation);
      close(twice[i].velocity, once[i].velocity);
    }
  }
}

TEST(Mirror, JetsAreTheDerivativesOfTheMirroredPoses) {
  const Skeleton s = rig(true);
  fixtures::expect_consistent([&](double t) { return mirrored(s, motion(s, t)); }, {0.31, 0.7, 1.7});
}

TEST(Mirror, ShorterOutputMeansFewerJointsAlsoInPlace) {
  const Skeleton s = rig(true);
  const MirrorMap<double> map = map_of<double>(s);
  Pose jets = motion(s, 0.7);
  const Pose whole = mirrored(s, jets);
  ASSERT_TRUE((MirrorJob<double>{&map, jets, std::span(jets).first(5)}.Run().ok()));
  for (std::size_t i = 0; i < 5; ++i) fixtures::expect_same_bits(jets[i], whole[i]);
}

}  // namespace
}  // namespace sinew
