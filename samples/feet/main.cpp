// A character walks up a ramp that its clip knows nothing of: rays find the ground under its feet, which are
// put on it, turned as it leans, and kept in their places while the clip says that they bear.
// Usage: feet ASSET.sinew [SLOPE, m of rise by m]
#include <sinew/animation/foot_placement_job.h>
#include <sinew/animation/sampling_job.h>
#include <sinew/character/queries.h>
#include <sinew/character/world.h>
#include <sinew/io/asset.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <utility>

namespace {

using Vec = sinew::Vec3<float>;

int fail(const char* what, const char* why) {
  std::fprintf(stderr, "feet: %s: %s\n", what, why);
  return 1;
}

/// What a ray meets that falls from half a metre above a point.
sinew::Status ground_under(const sinew::World<float>& world, int hero, const Vec& point,
                           sinew::GroundHit<float>& out) {
  sinew::Cast ray;
  ray.from = point.cast<double>() + sinew::Vec3<double>(0, 0, 0.5);
  ray.motion = {0, 0, -1.5};
  ray.filter.without_character = hero;
  std::array<sinew::QueryHit, 1> hit;
  int count = 0;
  if (sinew::Status s = sinew::cast(world, ray, hit, count); !s) return s;
  if (count == 0) return sinew::Status::error(sinew::Code::kOutOfRange, "there is no ground under a foot");
  out.point = hit[0].position.cast<float>();
  out.normal = hit[0].normal.cast<float>();
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: feet ASSET.sinew [SLOPE]\n");
    return 2;
  }
  sinew::Asset asset;
  if (sinew::Status s = sinew::load_asset(argv[1], asset); !s) return fail(argv[1], s.reason);
  const int walk = asset.find_clip("walk");
  if (walk < 0) return fail(argv[1], "the asset has no clip walk");
  const sinew::Clip& clip = asset.clips[walk];
  const float slope = argc > 2 ? static_cast<float>(std::atof(argv[2])) : 0.2f;
  const sinew::Skeleton& skeleton = asset.skeleton;
  std::array<sinew::FootLeg<float>, 2> legs;
  for (int side = 0; side < 2; ++side)
    if (sinew::Status s =
            sinew::find_foot_leg(skeleton, side == 0 ? sinew::Role::kFootL : sinew::Role::kFootR, legs[side]);
        !s)
      return fail(argv[1], s.reason);
  std::vector<int> parents;
  for (const sinew::Joint& joint : skeleton.joints) parents.push_back(joint.parent);

  // A ramp through the origin, up along x.
  sinew::Status status;
  sinew::WorldSettings settings;
  settings.ground = false;
  sinew::World<float> world(settings);
  sinew::CharacterSettings played;
  played.strength = std::numeric_limits<double>::infinity();  // its muscles are fitted to a walk on the flat
  const int index = world.add_character(skeleton, played, status);
  if (!status) return fail(argv[1], status.reason);
  sinew::Character<float> hero = world.character(index);
  sinew::Collider ramp;
  ramp.shape = sinew::Shape::kBox;
  ramp.size = {20, 3, 0.5};
  ramp.local.rotation = Eigen::AngleAxisd(-std::atan(double(slope)), sinew::Vec3<double>::UnitY());
  ramp.local.translation = ramp.local.rotation * sinew::Vec3<double>(0, 0, -0.5);
  if (status = world.add_obstacle(ramp); !status) return fail("ramp", status.reason);
  const float length = std::sqrt(1 + slope * slope);
  const auto above = [&](const Vec& p) { return (p.z() - slope * p.x()) / length; };  // m

  std::vector<sinew::JointJet<float>> jets(parents.size());
  std::array<sinew::FootState<float>, 2> states;  // what feet remember: a snapshot copies it
  sinew::SmoothInput<float> drop;                 // of the pelvis
  std::array<std::array<sinew::GroundHit<float>, 2>, 2> hits;
  std::array<sinew::FootInput<float>, 2> inputs;
  std::array<bool, 2> rests{};  // a sole is on the ramp, and does not move any more
  std::array<Vec, 2> stood;     // where it was when it came to that
  float deepest = 0, slid = 0;
  int steps = 0;
  constexpr float h = 1 / 60.f;
  for (int frame = 0; frame <= 300; ++frame) {
    const double now = frame / 60.0;
    status = sinew::SamplingJob<float>{&clip, now, jets}.Run();
    if (!status) return fail("walk", status.reason);
    // The game moves the root over the ramp, and says by how much, with the rates of that.
    sinew::MovingTransform<float> root = sinew::moving_transform(jets[0]);
    const sinew::TimeJet<float> level = slope * root.translation.x();
    root.translation.z() += level;
    jets[0] = sinew::joint_jet(root);

    for (int side = 0; side < 2; ++side) {
      const sinew::FootLeg<float>& leg = legs[side];
      const auto foot = sinew::model_motion<float>(jets, parents, leg.foot);
      const std::array<Vec, 2> sole = {leg.toe, leg.heel};
      for (int end = 0; end < 2; ++end) {
        const Vec point = sinew::value_of(sinew::MovingVector<float>(foot * sinew::still(sole[end])));
        if (status = ground_under(world, index, point, hits[side][end]); !status)
          return fail("ray", status.reason);
      }
      inputs[side] = {sinew::in_contact(clip, now, leg.foot) ? 1.f : 0.f, hits[side]};
    }
    const std::array<sinew::FootState<float>, 2> before = states;
    sinew::FootPlacementJob<float> place{parents, jets, 0, legs, inputs, states, &drop};
    place.level = level;
    place.step = frame == 0 ? 0 : h;
    if (status = place.Run(); !status) return fail("feet", status.reason);
    status = hero.set_target(jets);
    if (status) status = frame == 0 ? hero.reset() : world.step(h);
    if (!status) return fail("step", status.reason);

    // How the feet that are shown stand on the ramp.
    for (int side = 0; side < 2; ++side) {
      const sinew::Transform<float>& foot = hero.model()[legs[side].foot];
      const Vec toe = foot * legs[side].toe, heel = foot * legs[side].heel;
      deepest = std::max({deepest, -above(toe), -above(heel)});
      const bool rested =
          std::exchange(rests[side], states[side].at_rest() && states[side].hold == before[side].hold);
      if (!rests[side]) continue;
      const Vec end = states[side].hold == sinew::FootHold::kHeel ? heel : toe;
      if (rested) {
        slid = std::max(slid, (end - stood[side]).norm());
      } else {
        stood[side] = end;
        ++steps;
      }
    }
    if (frame % 30 == 0)
      std::printf("%5.2f s  root at %.2f m, %.2f m up; pelvis lowered by %4.1f cm\n", now,
                  hero.position().x(), hero.position().z(), 100 * double(drop.x.value));
  }
  std::printf("%d times a sole came to rest; slid by %.2f mm, %.2f mm deep at most\n", steps,
              1000 * double(slid), 1000 * double(deepest));
  if (steps < 8) return fail("feet", "they rest less than a walk of 5 s does");
  if (slid > 0.001f) return fail("feet", "one that bears slid by more than 1 mm");
  if (deepest > 0.001f) return fail("feet", "a sole was more than 1 mm deep in the ramp");
  return 0;
}
