// A step takes no memory from the heap.
#include "character/scenes.h"
#include "fixtures/counting_new.h"

namespace sinew {
namespace {

using fixtures::allocations;

TEST(Allocation, CounterCounts) {
  const long before = allocations;
  std::vector<int> memory(100);
  EXPECT_EQ(allocations - before, 1);
}

TEST(Allocation, PlaybackPushAndReturnAllocateNothing) {
  fixtures::Playing<float> scene;
  const int hand = scene.skeleton.find("hand_r");
  std::vector<std::vector<JointJet<float>>> frames;
  frames.reserve(120);
  for (int n = 0; n < 120; ++n) frames.push_back(fixtures::idle<float>(scene.skeleton, n / 60.0));
  Character<float> c = scene.character();
  const long before = allocations;
  bool pushed = false;
  for (int n = 0; n < 120; ++n) {
    (void)c.set_target(frames[n]);
    if (n % 30 == 3) (void)c.apply_impulse(hand, c.model()[hand].translation, {15, 0, 0});
    (void)scene.world.step(1 / 60.f);
    pushed = pushed || c.report().unknown_dofs > 0;
  }
  EXPECT_EQ(allocations - before, 0);
  EXPECT_TRUE(pushed);
}

TEST(Allocation, LimpFallOnPropsAndObstaclesAllocatesNothing) {
  for (const double x : {-0.1, 0.2}) {  // beside the step; within it
    fixtures::Limp<float> fall({}, 0.3, 3, 5);
    Status status;
    PropSettings box;
    box.shape = Shape::kBox;
    box.pose.translation = {x, 0.1, 0.15};
    ASSERT_EQ(fall.world.add_prop(box, status), 0) << status.reason;
    Collider step;
    step.shape = Shape::kBox;
    step.size = {0.5, 0.5, 0.1};
    step.local.translation = {0.5, 0, 0.1};
    ASSERT_TRUE(fall.world.add_obstacle(step).ok());
    const long before = allocations;
    int contacts = 0;
    for (int n = 0; n < 180; ++n) {
      (void)fall.world.step(1 / 60.f);
      contacts = std::max(contacts, fall.world.character(0).report().contacts);
    }
    EXPECT_EQ(allocations - before, 0);
    EXPECT_GT(contacts, 2);
  }
}

}  // namespace
}  // namespace sinew
