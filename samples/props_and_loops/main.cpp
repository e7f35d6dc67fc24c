// Things and what ties them: a stack of crates, a ball on a rope that swings against a door on a hinge, and a
// limp character that hangs by its hands from a bar. Usage: props_and_loops ASSET.sinew [SECONDS, at least 3]
#include <sinew/animation/inverse_kinematics.h>
#include <sinew/character/world.h>
#include <sinew/io/asset.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace {

using V = sinew::Vec3<double>;

constexpr float kStep = 1 / 60.f;  // s
constexpr int kCrates = 4;         // one on the other
constexpr double kCrate = 0.25;    // m, half of its edge
constexpr double kRope = 2;        // m

int fail(const char* what, const char* why) {
  std::fprintf(stderr, "props_and_loops: %s: %s\n", what, why);
  return 1;
}

sinew::Anchor on_prop(int index, const V& at) {
  sinew::Anchor anchor;
  anchor.kind = sinew::AnchorKind::kProp;
  anchor.index = index;
  anchor.frame.translation = at;
  return anchor;
}

sinew::Anchor in_world(const V& at) {
  sinew::Anchor anchor;
  anchor.frame.translation = at;
  return anchor;
}

/// A limp character in mid-air, arms above its head. Returns its index, or −1.
int add_hanging(sinew::World<float>& world, const sinew::Skeleton& skeleton, sinew::Status& status) {
  sinew::CharacterSettings limp;
  limp.root = sinew::RootDrive::kFree;
  limp.strength = 0;
  const int index = world.add_character(skeleton, limp, status);
  if (!status) return -1;
  std::vector<int> parents;
  std::vector<sinew::JointJet<float>> jets;
  for (const sinew::Joint& joint : skeleton.joints) {
    parents.push_back(joint.parent);
    jets.emplace_back();
    jets.back().rotation = joint.rest.rotation.cast<float>();
    jets.back().translation = joint.rest.translation.cast<float>();
  }
  jets[0].translation += sinew::Vec3<float>(0, -3, 0.6f);
  using sinew::Role;
  constexpr std::array<std::array<Role, 3>, 2> kArms = {
      {{Role::kUpperArmL, Role::kForearmL, Role::kHandL}, {Role::kUpperArmR, Role::kForearmR, Role::kHandR}}};
  for (const auto& [upper, middle, end] : kArms) {
    sinew::TwoBoneJob<float> arm{parents, jets, skeleton.find(upper), skeleton.find(middle),
                                 skeleton.find(end)};
    if (status = arm.Validate(); !status) return -1;
    arm.target = sinew::model_motion<float>(jets, parents, arm.upper).translation;
    arm.target.z() += sinew::TimeJet<float>(0.5f);
    arm.pole = sinew::still<float>({1, 0, 0});  // elbows ahead
    if (status = arm.Run(); !status) return -1;
  }
  status = world.character(index).set_target(jets);
  if (status) status = world.character(index).reset();
  return index;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: props_and_loops ASSET.sinew [SECONDS]\n");
    return 2;
  }
  sinew::Asset asset;
  if (sinew::Status s = sinew::load_asset(argv[1], asset); !s) return fail(argv[1], s.reason);
  const int frames = static_cast<int>(60 * (argc > 2 ? std::max(3.0, std::atof(argv[2])) : 6));
  sinew::Status status;
  sinew::World<float> world({});

  // Crates, one on the other.
  sinew::PropSettings crate;
  crate.shape = sinew::Shape::kBox;
  crate.size = V::Constant(kCrate);
  crate.mass = 20;
  std::array<int, kCrates> stack{};
  for (int n = 0; n < kCrates && status; ++n) {
    crate.pose.translation = {-2, 0, kCrate * (2 * n + 1)};
    stack[n] = world.add_prop(crate, status);
  }

  // A door that turns about the z axis of its hinge.
  sinew::PropSettings slab;
  slab.shape = sinew::Shape::kBox;
  slab.size = {0.02, 0.4, 1};
  slab.mass = 20;
  slab.pose.translation = {2, 0, 1.02};
  const int door = status ? world.add_prop(slab, status) : -1;
  sinew::LoopSettings hinge;
  hinge.kind = sinew::LoopKind::kHinge;
  hinge.a = on_prop(door, {0, 0.4, 0});
  hinge.b = in_world({2, 0.4, 1.02});
  if (status) (void)world.add_loop(hinge, status);

  // A ball on a rope, pulled back until the rope is level.
  const V hook(1.9, -0.2, 3.2);
  sinew::PropSettings bob;
  bob.mass = 10;
  bob.pose.translation = hook - V(kRope, 0, 0);
  const int ball = status ? world.add_prop(bob, status) : -1;
  sinew::LoopSettings rope;
  rope.kind = sinew::LoopKind::kRope;
  rope.length = kRope;
  rope.a = on_prop(ball, V::Zero());
  rope.b = in_world(hook);
  if (status) (void)world.add_loop(rope, status);
  if (!status) return fail("props", status.reason);

  // Both hands to where they are: the bar.
  const int hanging = add_hanging(world, asset.skeleton, status);
  std::array<sinew::LoopSettings, 2> grips;  // points, unless told otherwise
  std::array<int, 2> hands{};
  for (int side = 0; side < 2 && status; ++side) {
    const int hand = asset.skeleton.find(side == 0 ? sinew::Role::kHandL : sinew::Role::kHandR);
    const V palm = asset.skeleton.joints[hand].center_of_mass;
    grips[side].a = {sinew::AnchorKind::kCharacter, hanging, hand, {}};
    grips[side].a.frame.translation = palm;
    grips[side].b = in_world(world.character(hanging).model()[hand].cast<double>() * palm);
    hands[side] = world.add_loop(grips[side], status);
  }
  if (!status) return fail(argv[1], status.reason);

  // World::loop_gap() tells how far a loop is open; here it is measured from what is shown.
  const auto gap = [](const sinew::Transform<float>& body, const sinew::LoopSettings& loop) {
    return (body.cast<double>() * loop.a.frame.translation - loop.b.frame.translation).norm();
  };
  double open = 0, longer = 0, borne = 0, turned = 0;  // m, m, N, degrees
  for (int frame = 1; frame <= frames; ++frame) {
    if (status = world.step(kStep); !status) return fail("step", status.reason);
    open = std::max(open, gap(world.prop_pose(door), hinge));
    for (const sinew::LoopSettings& grip : grips)
      open = std::max(open, gap(world.character(hanging).model()[grip.a.joint], grip));
    longer = std::max(longer, gap(world.prop_pose(ball), rope) - kRope);
    const V across = world.prop_pose(door).rotation.cast<double>() * V::UnitX();
    const double angle = std::atan2(across.y(), across.x()) * 57.3;
    turned = std::max(turned, std::abs(angle));
    const double force = double(world.loop_force(hands[0]).z() + world.loop_force(hands[1]).z());
    if (frame > frames - 120) borne += force / 120;  // the mean of two seconds: it swings a little
    if (frame % 60 == 0)
      std::printf("%5.2f s  top crate at %.3f m, door at %4.0f degrees, hands bear %4.0f N\n", frame / 60.0,
                  double(world.prop_pose(stack.back()).translation.z()), angle, force);
  }
  const double weight = asset.skeleton.total_mass() * 9.81;
  const V top = world.prop_pose(stack.back()).translation.cast<double>();
  const double moved = (top - V(-2, 0, kCrate * (2 * kCrates - 1))).norm();
  std::printf(
      "top crate %.1f mm from its place; loops open by %.2f mm, rope longer by %.2f mm; hands bear %.0f of "
      "%.0f N\n",
      1000 * moved, 1000 * open, 1000 * longer, borne, weight);
  if (moved > 0.005) return fail("stack", "it has moved by more than 5 mm");
  if (turned < 20) return fail("door", "the ball did not open it");
  if (open > 0.0005) return fail("loops", "one came open by more than 0.5 mm");
  if (longer > 0.0005) return fail("rope", "it became longer by more than 0.5 mm");
  if (std::abs(borne - weight) > 0.03 * weight)
    return fail("bar", "hands do not bear the character's weight");
  return 0;
}
