// A walker with a sword in its right hand and a lantern in its left. The sword is in a socket: it moves
// exactly as the hand does, weighs nothing, and becomes a prop with the hand's velocity when it is let go.
// The lantern is a prop from the beginning, and a loop welds it to the hand: muscles bear it.
// Usage: attach ASSET.sinew [LANTERN in kg]
#include <sinew/animation/model_motion_job.h>
#include <sinew/animation/sampling_job.h>
#include <sinew/animation/socket.h>
#include <sinew/character/world.h>
#include <sinew/io/asset.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace {

constexpr float kStep = 1 / 60.f;              // s
constexpr int kThrown = 75, kLast = 240;       // frames
constexpr float kBlade = 0.4f, kGrip = 0.55f;  // m: half of the blade; from its middle to the grip
constexpr float kQuarter = 1.5707964f;         // rad, of a turn
constexpr double kHandle = 0.15;               // m, from the lantern's middle up to its handle

int fail(const char* what, const char* why) {
  std::fprintf(stderr, "attach: %s: %s\n", what, why);
  return 1;
}

sinew::Vec3<float> place(const sinew::MovingTransform<float>& item) {
  return sinew::value_of(item.translation);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: attach ASSET.sinew [LANTERN]\n");
    return 2;
  }
  sinew::Asset asset;
  if (sinew::Status s = sinew::load_asset(argv[1], asset); !s) return fail(argv[1], s.reason);
  if (asset.clips.empty()) return fail(argv[1], "the asset has no clip");
  const sinew::Skeleton& skeleton = asset.skeleton;
  const int right = skeleton.find(sinew::Role::kHandR), left = skeleton.find(sinew::Role::kHandL);
  if (right < 0 || left < 0) return fail(argv[1], "the character lacks a hand");
  const double lantern_mass = argc > 2 ? std::atof(argv[2]) : 1.5;

  sinew::Status status;
  sinew::World<float> world({});
  const int hero = world.add_character(skeleton, {}, status);
  if (!status) return fail(argv[1], status.reason);
  sinew::Character<float> walker = world.character(hero);
  std::vector<int> parents;
  for (const sinew::Joint& joint : skeleton.joints) parents.push_back(joint.parent);
  std::vector<sinew::JointJet<float>> jets(parents.size());
  std::vector<sinew::MovingTransform<float>> model(parents.size());
  status = sinew::SamplingJob<float>{&asset.clips.front(), 0, jets}.Run();
  if (status) status = walker.set_target(jets);
  if (status) status = walker.reset();
  if (!status) return fail(argv[1], status.reason);

  // The sword: a socket in the palm, in which the blade (its z axis) points ahead at first, and a prop that
  // is put aside until it is thrown.
  sinew::Socket<float> palm{right, {}};
  palm.offset.translation = skeleton.joints[right].center_of_mass.cast<float>();
  palm.offset.rotation =
      walker.model()[right].rotation.conjugate() * Eigen::AngleAxisf(kQuarter, sinew::Vec3<float>::UnitY());
  sinew::Transform<float> grip;  // grip → sword, whose origin is its centre of mass
  grip.translation = {0, 0, -kGrip};
  sinew::PropSettings blade;
  blade.shape = sinew::Shape::kBox;
  blade.size = {0.02, 0.04, double(kBlade)};
  const int sword = world.add_prop(blade, status);
  if (status) status = world.park_prop(sword);
  if (!status) return fail("sword", status.reason);

  // The lantern: below the hand and upright when it is welded.
  sinew::PropSettings ball;
  ball.size.x() = 0.06;
  ball.mass = lantern_mass;
  const sinew::Vec3<double> hand = skeleton.joints[left].center_of_mass;
  ball.pose.translation = walker.model()[left].cast<double>() * hand - sinew::Vec3<double>(0, 0, kHandle);
  const int lantern = world.add_prop(ball, status);
  sinew::LoopSettings weld;
  weld.kind = sinew::LoopKind::kWeld;
  weld.a = {sinew::AnchorKind::kCharacter, hero, left, {}};
  weld.a.frame.rotation = walker.model()[left].rotation.conjugate().cast<double>();
  weld.a.frame.translation = hand;
  weld.b = {sinew::AnchorKind::kProp, lantern, 0, {}};
  weld.b.frame.translation = {0, 0, kHandle};
  const int bond = status ? world.add_loop(weld, status) : -1;
  if (!status) return fail("lantern", status.reason);
  const int cycle = int(std::lround(60 * double(asset.clips.front().duration)));  // frames

  double lag = 0, slip = 0, gap = 0, pull = 0;             // m, m/s, m, N
  sinew::Vec3<float> before = sinew::Vec3<float>::Zero();  // where the sword was a frame ago
  for (int frame = 1; frame <= kLast; ++frame) {
    status = sinew::SamplingJob<float>{&asset.clips.front(), frame / 60.0, jets}.Run();
    if (status) status = walker.set_target(jets);
    if (status) status = world.step(kStep);
    if (!status) return fail("step", status.reason);

    // Where the sword is at the end of this frame, how fast it is and how that changes: no lag of a frame.
    status = sinew::ModelMotionJob<float>{parents, jets, {}, model}.Run();
    if (!status) return fail("hands", status.reason);
    using Model = std::span<const sinew::MovingTransform<float>>;
    const auto item = sinew::attached<float>(sinew::socket_motion<float>(palm, Model(model)), grip);
    if (frame <= kThrown) {
      const sinew::Transform<float> shown = walker.model()[right] * palm.offset * grip.inverse();
      lag = std::max(lag, double((shown.translation - place(item)).norm()));
    }
    if (frame == kThrown) {
      const sinew::Release<float> thrown = sinew::release<float>(item, {0, 0, 0});
      status = world.set_prop(sword, thrown.pose, thrown.velocity, thrown.angular_velocity);
      if (!status) return fail("sword", status.reason);
      // Over the last frame it went at v − a·h/2 in the mean, to second order.
      const sinew::Vec3<float> mean = thrown.velocity - kStep / 2 * sinew::acceleration_of(item.translation);
      slip = double(((place(item) - before) / kStep - mean).norm());
      slip += double((world.prop_velocity(sword) - thrown.velocity).norm());
      std::printf("%5.2f s  lets the sword go at %.2f m/s\n", frame / 60.0, double(thrown.velocity.norm()));
    }
    before = place(item);

    gap = std::max(gap, world.loop_gap(bond));
    if (frame > kLast - cycle)
      pull -= double(world.loop_force(bond).z()) / cycle;  // mean of a cycle: its weight
    if (frame % 30 == 0)
      std::printf("%5.2f s  sword at height %.2f m; lantern pulls with %4.1f N, unknown DOFs %d\n",
                  frame / 60.0,
                  frame <= kThrown ? double(place(item).z()) : double(world.prop_pose(sword).translation.z()),
                  double(world.loop_force(bond).norm()), walker.report().unknown_dofs);
  }
  std::printf(
      "sword %.3f mm from the palm, released within %.3f m/s of it; lantern %.2f mm, pulls down with %.1f "
      "N\n",
      1000 * lag, slip, 1000 * gap, pull);
  if (lag > 0.001) return fail("sword", "it was not where the hand is");
  if (slip > 0.02) return fail("sword", "it was not released with the velocity that it had");
  if (gap > 0.0005) return fail("lantern", "it came off the hand by more than 0.5 mm");
  if (std::abs(pull - lantern_mass * 9.81) > 0.05 * lantern_mass * 9.81)
    return fail("lantern", "it does not pull with its weight");
  return 0;
}
