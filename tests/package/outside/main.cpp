// A game that only has the installed package: one body falls for a tenth of a second.
#include <sinew/character/world.h>
#include <sinew/io/asset.h>

int main() {
  sinew::Status status;
  sinew::World<float> world({});
  sinew::PropSettings ball;
  ball.pose.translation = {0, 0, 2};
  const int index = world.add_prop(ball, status);
  for (int i = 0; i < 6; ++i) world.step(1 / 60.f);
  const float z = world.prop_pose(index).translation.z();
  return status && z < 1.99f && z > 1.9f ? 0 : 1;
}
