// The demo character's walk, mirrored: a symmetric body that walks symmetrically.
#include <gtest/gtest.h>

#include <algorithm>

#include "convert/convert.h"
#include "fixtures/paths.h"
#include "sinew/animation/mirror_job.h"
#include "sinew/animation/moving_transform.h"
#include "sinew/animation/sampling_job.h"

namespace sinew {
namespace {

using Vec = Vec3<double>;
using Pose = std::vector<JointJet<double>>;

class MirroredWalk : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    nlohmann::json report;
    const auto error =
        convert::convert_files({source_dir() + "/assets/character/mannequin.glb"}, {}, asset, report);
    ASSERT_FALSE(error) << error.message;
    ASSERT_TRUE(build_mirror_map<double>(asset.skeleton, map, &warnings).ok());
    for (const Joint& joint : asset.skeleton.joints) parents.push_back(joint.parent);
  }
  static const Clip& walk() { return asset.clips[std::size_t(asset.find_clip("walk"))]; }
  static Pose at(double t) {
    Pose jets(parents.size());
    EXPECT_TRUE((SamplingJob<double>{&walk(), t, jets}.Run().ok()));
    return jets;
  }
  static Pose mirrored(double t) {
    Pose jets = at(t);
    EXPECT_TRUE((MirrorJob<double>{&map, jets, jets}.Run().ok()));
    return jets;
  }
  static std::vector<MovingTransform<double>> model_of(const Pose& jets) {
    std::vector<MovingTransform<double>> model;
    for (int i = 0; i < int(jets.size()); ++i) model.push_back(model_motion<double>(jets, parents, i));
    return model;
  }
  inline static Asset asset;
  inline static MirrorMap<double> map;
  inline static std::vector<MirrorWarning> warnings;
  inline static std::vector<int> parents;
};

Vec image(const Vec& v) {
  return {v.x(), -v.y(), v.z()};
}

TEST_F(MirroredWalk, EveryJointHasAPartner) {
  for (const MirrorWarning& w : warnings)
    ADD_FAILURE() << asset.skeleton.joints[std::size_t(w.joint)].name << ": " << w.reason;
}

TEST_F(MirroredWalk, IsTheWalkHalfACycleLater) {
  // How far the clip itself is from symmetric is found without the job: by the image of partners' origins in
  // model space. What the job adds to that is rounding.
  const double half = walk().duration / 2;
  const Vec step = 0.5 * walk().root_step.cast<double>();
  double own = 0, job = 0, most = 0;
  for (double t = 0; t < walk().duration; t += walk().duration / 50) {
    const auto now = model_of(at(t)), later = model_of(at(t + half)), other = model_of(mirrored(t));
    for (std::size_t i = 0; i < now.size(); ++i) {
      const Vec place = value_of<double>(later[i].translation) - step;
      own = std::max(own, (image(value_of<double>(now[map.partners[i]].translation)) - place).norm());
      job = std::max(job, (value_of<double>(other[i].translation) - place).norm());
      most = std::max(most, (value_of<double>(now[i].translation) - place).norm());
    }
  }
  EXPECT_LT(job, own + 1e-4) << "m; rests of the demo character are symmetric to 0.1 mm";
  EXPECT_LT(own, 2.5e-3) << "m; each side is within 1 mm of a source that is symmetric";
  EXPECT_GT(most, 0.3) << "m; it does move";
}

/// The skeleton with masses that are each other's mirror image: those of the demo character are fitted to a
/// mesh whose triangles are not.
Skeleton with_symmetric_masses(Skeleton s, const MirrorMap<double>& map) {
  const Skeleton source = s;
  std::vector<Mat3<double>> rest;
  for (const Joint& joint : s.joints) {
    const Mat3<double> local = joint.rest.rotation.toRotationMatrix();
    rest.push_back(joint.parent < 0 ? local : rest[std::size_t(joint.parent)] * local);
  }
  const Mat3<double> mirror = Vec(1, -1, 1).asDiagonal().toDenseMatrix();
  for (std::size_t i = 0; i < std::size_t(s.body_count); ++i) {
    const std::size_t j = map.partners[i];
    const Mat3<double> across = rest[i].transpose() * (mirror * rest[j]);
    Joint& body = s.joints[i];
    const Joint& other = source.joints[j];
    body.mass = 0.5 * (body.mass + other.mass);
    body.center_of_mass = 0.5 * (body.center_of_mass + across * other.center_of_mass);
    body.inertia = 0.5 * (body.inertia + across * other.inertia * across.transpose());
  }
  return s;
}

/// Moment about each joint, in model axes, that moves everything below it as the jets say: Newton and Euler
/// body by body.
std::vector<Vec> moments(const Skeleton& s, const std::vector<int>& parents,
                         const std::vector<MovingTransform<double>>& model) {
  std::vector<Vec> total(model.size(), Vec::Zero());
  for (int b = 0; b < s.body_count; ++b) {
    const Joint& body = s.joints[std::size_t(b)];
    const MovingTransform<double>& frame = model[std::size_t(b)];
    const JointJet<double> jet = joint_jet(frame);
    const MovingVector<double> centre = frame * still<double>(body.center_of_mass);
    const Vec force = body.mass * (acceleration_of<double>(centre) + Vec(0, 0, 9.81));
    const Vec spin = jet.rotation * (body.inertia * jet.alpha + jet.omega.cross(body.inertia * jet.omega));
    for (int j = b; j >= 0; j = parents[std::size_t(j)]) {
      const Vec arm = value_of<double>(centre) - value_of<double>(model[std::size_t(j)].translation);
      total[std::size_t(j)] += spin + arm.cross(force);
    }
  }
  return total;
}

TEST_F(MirroredWalk, TorquesSwapSides) {
  const Skeleton body = with_symmetric_masses(asset.skeleton, map);
  double worst = 0, largest = 0;
  for (double t = 0; t < walk().duration; t += walk().duration / 20) {
    const auto plain = moments(body, parents, model_of(at(t)));
    const auto other = moments(body, parents, model_of(mirrored(t)));
    for (std::size_t i = 0; i < std::size_t(body.body_count); ++i) {
      const Vec wanted = -image(plain[map.partners[i]]);  // moments are axial
      worst = std::max(worst, (other[i] - wanted).norm());
      largest = std::max(largest, wanted.norm());
    }
  }
  EXPECT_LT(worst, 1e-4 * largest) << largest << " N·m";
}

}  // namespace
}  // namespace sinew
