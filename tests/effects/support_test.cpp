// Support: the floor bears the weight of a standing character and shares it between the feet.
#include "sinew/effects/support.h"

#include <gtest/gtest.h>

#include "fixtures/humanoid.h"

namespace sinew {
namespace {

using V = Vec3<double>;

struct Standing {
  Skeleton skeleton = fixtures::humanoid();
  Tree<double> tree{skeleton};
  Kinematics<double> kinematics{tree};
  Motion<double> motion{tree};
  std::vector<ContactPoint<double>> points;
  std::vector<V> force, moment;

  /// Standing at rest, shifted by `lift` (m) above the floor, with an extra acceleration of the whole body.
  explicit Standing(double lift = 0, const V& acceleration = V::Zero())
      : force(skeleton.body_count), moment(skeleton.body_count) {
    std::vector<JointJet<double>> jets(skeleton.joints.size());
    for (std::size_t i = 0; i < jets.size(); ++i) jets[i].translation = skeleton.joints[i].rest.translation;
    jets[0].translation.z() += lift;
    jets[0].acceleration = acceleration;
    for (const Collider& collider : skeleton.colliders) append_contact_points<double>(collider, points);
    inertial_wrenches<double>(tree, jets, {0, 0, -9.81}, V::Zero(), kinematics, motion, force, moment);
  }
  void share() {
    const SupportPoints<double> support(tree, points);
    std::vector<StandingPoint<double>> room(support.points.size());
    share_support<double>(support, kinematics.rotation, kinematics.origin, LevelGround<double>{0.0}, {}, room,
                          force, moment);
  }
  V total(const std::vector<V>& of) const {
    V sum = V::Zero();
    for (const V& x : of) sum += x;
    return sum;
  }
};

TEST(Support, BearsTheWholeWeight) {
  Standing s;
  const double weight = s.skeleton.total_mass() * 9.81;
  EXPECT_NEAR(s.total(s.force).z(), weight, 1e-9);
  s.share();
  EXPECT_NEAR(s.total(s.force).z(), 0, 1e-9 * weight);
  // 1e-6 regularisation of the balance of tilt.
  EXPECT_NEAR(s.total(s.moment).x(), 0, 1e-4 * weight);
  EXPECT_NEAR(s.total(s.moment).y(), 0, 1e-4 * weight);
}

TEST(Support, FeetOfASymmetricStanceBearEqualShares) {
  Standing s;
  const std::vector<V> before = s.force;
  s.share();
  const int left = s.skeleton.find("foot_l"), right = s.skeleton.find("foot_r");
  const double on_left = (before[left] - s.force[left]).z(), on_right = (before[right] - s.force[right]).z();
  EXPECT_GT(on_left, 300);
  EXPECT_NEAR(on_left, on_right, 1e-6 * on_left);
  for (int i = 0; i < s.tree.bodies; ++i)
    if (i != left && i != right) {
      EXPECT_EQ(before[i], s.force[i]) << s.skeleton.joints[i].name;
    }
}

TEST(Support, AccelerationToTheRightPushesOffTheLeftFoot) {
  // The point that balances an acceleration to the right (−y) lies to the left of the centre of mass.
  Standing s(0, {0, -1.0, 0});
  const std::vector<V> before = s.force;
  s.share();
  const int left = s.skeleton.find("foot_l"), right = s.skeleton.find("foot_r");
  EXPECT_GT((before[left] - s.force[left]).z(), (before[right] - s.force[right]).z() + 10);
  for (const int foot : {left, right}) EXPECT_GE((before[foot] - s.force[foot]).z(), 0);
}

TEST(Support, FeetOfAStrideLeanTowardsTheHipsAndAgainstEachOther) {
  Standing s;
  const int left = s.skeleton.find("foot_l"), right = s.skeleton.find("foot_r");
  s.kinematics.origin[left].x() += 0.2;
  s.kinematics.origin[right].x() -= 0.2;
  const std::vector<V> before = s.force;
  s.share();
  const V front = before[left] - s.force[left], back = before[right] - s.force[right];
  EXPECT_LT(front.x(), -0.1 * front.z());
  EXPECT_GT(back.x(), 0.1 * back.z());
  // Within 0.4 of the vertical by default, and no push that the motion does not ask for.
  EXPECT_LE(front.head<2>().norm(), 0.8 * front.z());
  EXPECT_NEAR((front + back).x(), 0, 1e-9 * front.z());
}

TEST(Support, DoesNothingInFlight) {
  Standing s(0.1);
  const std::vector<V> before = s.force;
  s.share();
  EXPECT_EQ(before, s.force);
}

TEST(Support, DoesNotPullDownABodyThatFallsFasterThanGravity) {
  Standing s(0, {0, 0, -15});
  const std::vector<V> before = s.force;
  s.share();
  EXPECT_EQ(before, s.force);
}

TEST(Support, FadesOutWithHeight) {
  // Statically the share is all or nothing, so look at one raised foot: between floor and reach it bears
  // less.
  Standing flat;
  const int left = flat.skeleton.find("foot_l");
  double last = 1e9;
  for (const double raised : {0.0, 0.005, 0.01, 0.02, 0.03}) {
    Standing s;
    s.kinematics.origin[left].z() += raised;
    const std::vector<V> before = s.force;
    s.share();
    const double borne = (before[left] - s.force[left]).z();
    EXPECT_LE(borne, last + 1e-9) << raised;
    last = borne;
  }
  EXPECT_EQ(last, 0);
}

}  // namespace
}  // namespace sinew
