#include "render/muscles.h"

#include <cmath>

#include "render/shapes.h"

namespace sinew::render {
namespace {

constexpr float kPi = 3.14159265f;

/// Joint places in model space at rest.
std::vector<Transform<float>> rest_model(const Skeleton& s) {
  std::vector<Transform<float>> rest;
  for (const Joint& joint : s.joints) {
    const Transform<float> local = joint.rest.cast<float>();
    rest.push_back(joint.parent < 0 ? local : rest[static_cast<std::size_t>(joint.parent)] * local);
  }
  return rest;
}

/// A muscle of the trunk or a limb's root: both ends fixed to a joint at an offset from it (shares of
/// stature; forward, outward, up at rest), coloured by the joint that it moves. Limbs get theirs from the
/// bones' own shapes.
struct Strand {
  Role from;
  float from_offset[3];
  Role to;
  float to_offset[3];
  float radius;
  Role moves;
};
constexpr Strand kStrands[] = {
    {Role::kPelvis,
     {0.062f, 0.018f, -0.012f},
     Role::kChest,
     {0.068f, 0.024f, 0.012f},
     0.017f,
     Role::kSpine},  // abdominals
    {Role::kPelvis,
     {0.030f, 0.062f, 0.010f},
     Role::kChest,
     {0.040f, 0.070f, -0.010f},
     0.018f,
     Role::kSpine},  // obliques
    {Role::kPelvis,
     {-0.050f, 0.020f, 0.020f},
     Role::kChest,
     {-0.052f, 0.024f, 0.060f},
     0.017f,
     Role::kSpine},  // erectors
    {Role::kChest,
     {0.062f, 0.012f, 0.040f},
     Role::kUpperArmL,
     {0.020f, 0.004f, -0.035f},
     0.026f,
     Role::kUpperArmL},  // pectorals
    {Role::kChest,
     {0.030f, 0.020f, 0.078f},
     Role::kUpperArmL,
     {0.005f, 0.028f, -0.060f},
     0.024f,
     Role::kUpperArmL},  // deltoids
    {Role::kChest,
     {-0.048f, 0.020f, -0.010f},
     Role::kUpperArmL,
     {-0.018f, 0.000f, -0.040f},
     0.026f,
     Role::kUpperArmL},  // latissimus
    {Role::kChest,
     {-0.030f, 0.022f, 0.085f},
     Role::kNeck,
     {-0.022f, 0.016f, 0.030f},
     0.014f,
     Role::kNeck},  // trapezius
    {Role::kChest,
     {0.026f, 0.012f, 0.092f},
     Role::kHead,
     {0.002f, 0.030f, 0.010f},
     0.009f,
     Role::kHead},  // sternomastoid
    {Role::kPelvis,
     {-0.050f, 0.030f, 0.010f},
     Role::kThighL,
     {-0.022f, 0.018f, -0.070f},
     0.032f,
     Role::kThighL},  // gluteus
    {Role::kPelvis,
     {0.028f, 0.045f, 0.020f},
     Role::kThighL,
     {0.032f, 0.008f, -0.060f},
     0.018f,
     Role::kThighL},  // hip flexors
};

Role mirrored(Role role) {
  const int r = static_cast<int>(role), first = static_cast<int>(Role::kClavicleL);
  return r >= first && (r - first) % 2 == 0 ? static_cast<Role>(r + 1) : role;
}

bool is_trunk(Role role) {
  return role == Role::kPelvis || role == Role::kSpine || role == Role::kChest || role == Role::kNeck ||
         role == Role::kClavicleL || role == Role::kClavicleR;
}

/// Trunk muscles by role, on both sides. False where the skeleton has no chest and pelvis to carry them.
bool append_strands(const Asset& asset, const scene::CharacterFrame& frame, Geometry& out) {
  const Skeleton& s = asset.skeleton;
  int chest = s.find(Role::kChest);
  for (std::size_t i = 0; chest < 0 && i < s.joints.size(); ++i)  // no chest by name: the highest spine
    if (s.joints[i].role == Role::kSpine && s.find(Role::kUpperArmL) >= 0) chest = static_cast<int>(i);
  const int head = s.find(Role::kHead), foot = s.find(Role::kFootL), pelvis = s.find(Role::kPelvis);
  if (chest < 0 || head < 0 || foot < 0) return false;
  const std::vector<Transform<float>> rest = rest_model(s);
  const auto joint = [&](Role role) {
    return role == Role::kChest ? chest : (role == Role::kPelvis && pelvis < 0 ? 0 : s.find(role));
  };
  const float height = (rest[static_cast<std::size_t>(head)].translation.z() -
                        rest[static_cast<std::size_t>(foot)].translation.z()) /
                       0.86f;
  if (!(height > 0.1f)) return false;
  for (const Strand& strand : kStrands)
    for (const bool left : {true, false}) {
      const int from = joint(left ? strand.from : mirrored(strand.from)),
                to = joint(left ? strand.to : mirrored(strand.to));
      const int moves = joint(left ? strand.moves : mirrored(strand.moves));
      if (from < 0 || to < 0) continue;
      const auto at = [&](int j, const float* offset) {
        const auto k = static_cast<std::size_t>(j);
        const Vec3<float> place =
            rest[k].translation + height * Vec3<float>(offset[0], left ? offset[1] : -offset[1], offset[2]);
        return Vec3<float>(frame.model[k] * (rest[k].inverse() * place));
      };
      append_spindle(at(from, strand.from_offset), at(to, strand.to_offset), strand.radius * height,
                     moves >= 0 ? frame.load[static_cast<std::size_t>(moves)] : 0, out);
    }
  return true;
}

}  // namespace

void append_muscles(const Asset& asset, const scene::CharacterFrame& frame, Geometry& out) {
  const std::size_t first = out.indices.size();
  const Skeleton& s = asset.skeleton;
  const bool trunk_done = append_strands(asset, frame, out);
  for (const Collider& c : s.colliders) {
    if (c.joint >= s.body_count) continue;
    const auto joint = static_cast<std::size_t>(c.joint);
    const Transform<float> world = frame.model[joint] * c.local.cast<float>();
    const Role role = s.joints[joint].role;
    if (c.shape == Shape::kBox || role == Role::kToesL || role == Role::kToesR) {
      if (c.shape == Shape::kBox)
        append_capsule(
            {world.rotation * Quat<float>::FromTwoVectors(Vec3<float>::UnitZ(), Vec3<float>::UnitX()),
             world.translation},
            0.6f * float(c.size.z()), 0.75f * float(c.size.x()), kBone, 0, out);
      continue;
    }
    const float radius = float(c.size.x()), half = float(c.size.z()) + 0.5f * radius;
    if (role == Role::kHead) {
      append_capsule(world, 0.82f * radius, float(c.size.z()), kBone, 0, out);
      continue;
    }
    append_capsule(world, (is_trunk(role) ? 0.32f : 0.28f) * radius, half, kBone, 0, out);
    if (trunk_done && is_trunk(role)) continue;
    const Vec3<float> along = world.rotation * Vec3<float>::UnitZ();
    for (int k = 0; k < 3; ++k) {
      const float angle = 2 * kPi * (float(k) + 0.25f) / 3;
      const Vec3<float> side = world.rotation * Vec3<float>(std::cos(angle), std::sin(angle), 0);
      const Vec3<float> middle = world.translation + side * (0.5f * radius);
      append_spindle(middle - along * (half * 1.02f), middle + along * (half * 1.02f), 0.5f * radius,
                     frame.load[joint], out);
    }
  }
  out.close_draw(first, {.closed = true});
}

}  // namespace sinew::render
