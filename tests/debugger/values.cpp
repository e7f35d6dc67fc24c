// A program to look into with a debugger: one of each type that people look at (check.py says how they are
// shown).
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

#include "sinew/animation/moving_transform.h"
#include "sinew/character/body_ref.h"
#include "sinew/character/state.h"  // as a runtime that was built with debug information knows it
#include "sinew/character/world.h"

namespace {

sinew::Skeleton one_ball() {
  sinew::Skeleton skeleton;
  skeleton.joints.resize(1);
  sinew::Joint& joint = skeleton.joints[0];
  joint.name = "ball";
  joint.type = sinew::JointType::kFree;
  joint.mass = 1;
  joint.inertia = sinew::Mat3<double>::Identity();
  skeleton.body_count = 1;
  return skeleton;
}

/// Where the debugger stops.
template <class... Values>
[[gnu::noinline]] void look_here(const Values&... values) {
  std::printf("%zu values\n", sizeof...(values));
}

}  // namespace

int main() {
  const float root = std::sqrt(0.5f);
  const sinew::Vec3<float> vector(1, -2.5f, 0);
  const sinew::Vec3<double> vector_of_doubles(0.1, 1e-9, -0.0);
  sinew::Mat3<double> matrix;
  matrix << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  const sinew::Quat<float> rotation(root, 0, 0, root);        // w x y z: a quarter about z
  const sinew::Quat<double> other_side(-0.5, 0.5, 0.5, 0.5);  // −q, of 120 degrees about −(1, 1, 1)
  const sinew::Quat<float> none(1, 0, 0, 0), too_long(2, 0, 0, 0),
      broken(std::numeric_limits<float>::quiet_NaN(), 0, 0, 0);
  const sinew::Transform<float> transform{rotation, vector};
  sinew::JointJet<double> jet;
  jet.translation = {3, 2, 1};
  jet.omega = {0, 0, 1.5};
  const sinew::TimeJet<float> weight(0.5f, 2, -4);
  const sinew::MovingVector<float> moving(weight, sinew::TimeJet<float>(1), sinew::TimeJet<float>(2));
  const sinew::MovingTransform<double> moving_frame = sinew::moving_transform(jet);
  const sinew::Status ok;
  const sinew::Status refused = sinew::Status::error(sinew::Code::kNotFinite, "target is not finite", 3);
  const sinew::Status unread = sinew::Status::error(sinew::Code::kIo, "no such file");
  sinew::Status status;
  sinew::World<float> world({});
  const sinew::Skeleton skeleton = one_ball();
  const sinew::Character<float> hero = world.character(world.add_character(skeleton, {}, status));
  const sinew::Character<float> nobody = world.character(5);
  const sinew::EffectId no_effect, effect{2, 7};
  const sinew::BodyRef ground, wall{sinew::BodyKind::kObstacle, 3, 0},
      hand{sinew::BodyKind::kCharacter, 1, 9};
  const sinew::Displacement displacement{1, 2, 0.5};
  look_here(vector, vector_of_doubles, matrix, rotation, other_side, none, too_long, broken, transform, jet,
            weight, moving, moving_frame, ok, refused, unread, hero, nobody, no_effect, effect, ground, wall,
            hand, displacement);
  return 0;
}
