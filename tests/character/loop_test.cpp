// Loops: what they hold, what they conserve, and that both sides feel them.
#include <gtest/gtest.h>

#include <cmath>

#include "character/scenes.h"
#include "study/linkage.h"

namespace sinew {
namespace {

using V = Vec3<double>;
using study::Linkage;

constexpr double kH = 1.0 / 60;

WorldSettings no_floor() {
  WorldSettings settings;
  settings.ground = false;
  return settings;
}

CharacterSettings limp() {
  CharacterSettings settings;
  settings.root = RootDrive::kFree;
  settings.strength = 0;
  return settings;
}

/// One rod; a hinge turns about y.
Linkage rod(JointType type, const V& from, const V& to, double mass) {
  Linkage l;
  l.add_rod(-1, type, from, to, V::UnitY(), mass);
  return l;
}

template <class T>
struct Hung {
  World<T> world;
  Linkage linkage;

  explicit Hung(const Linkage& l, const WorldSettings& settings = no_floor())
      : world(settings), linkage(l) {
    Status status;
    EXPECT_EQ(world.add_character(l.skeleton, limp(), status), 0) << status.reason;
    world.character(0).reset();
  }
  int tie(LoopKind kind, int body, const V& point, double length = 0) {
    LoopSettings loop;
    loop.kind = kind;
    loop.a = linkage.anchor(body, point);
    loop.b.frame.translation = point;
    loop.length = length;
    Status status;
    const int index = world.add_loop(loop, status);
    EXPECT_TRUE(status.ok()) << status.reason;
    return index;
  }
  double energy() {
    const CharacterReport& r = world.character(0).report();
    return r.kinetic_energy + r.potential_energy + r.elastic_energy;
  }
};

TEST(Loop, PendulumOnALoopSwingsAsOneOnAJoint) {
  // A rod hinged to the world by the tree, and a free rod held at the same point by a loop.
  for (const LoopKind kind : {LoopKind::kPoint, LoopKind::kHinge}) {
    Hung<double> hinged(rod(JointType::kRevolute, {0, 0, 0}, {1, 0, 0}, 2));
    Hung<double> tied(rod(JointType::kFree, {0, 0, 0}, {1, 0, 0}, 2));
    LoopSettings loop;
    loop.kind = kind;
    loop.a = tied.linkage.anchor(0, {0, 0, 0});
    loop.a.frame.rotation = loop.b.frame.rotation = Quat<double>::FromTwoVectors(V::UnitZ(), V::UnitY());
    Status status;
    ASSERT_EQ(tied.world.add_loop(loop, status), 0) << status.reason;
    double gap = 0;
    for (int n = 0; n < 60; ++n) {
      ASSERT_TRUE(hinged.world.step(kH).ok());
      ASSERT_TRUE(tied.world.step(kH).ok());
      gap = std::max(gap, tied.world.loop_gap(0));
      const V a = hinged.world.character(0).model()[0] * V(1, 0, 0);
      const V b = tied.world.character(0).model()[0] * V(1, 0, 0);
      // The loop gives by 0.1 mm under the weight; bdf1 and bdf2 see different charts only in rounding.
      EXPECT_LT((a - b).norm(), 5e-3) << n;
      EXPECT_TRUE(tied.world.character(0).report().converged);
    }
    EXPECT_LT(gap, 3e-4);
  }
}

}  // namespace
}  // namespace sinew
