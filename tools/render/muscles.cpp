#include "render/muscles.h"

#include <algorithm>
#include <cmath>

#include "render/shapes.h"
#include "sinew/skeleton/rotation.h"

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

/// Trunk muscles by role, on both sides; none where the skeleton has no chest and pelvis to carry them.
void append_strands(const Skeleton& s, const std::vector<Transform<float>>& rest,
                    const scene::CharacterFrame& frame, Geometry& out) {
  int chest = s.find(Role::kChest);
  for (std::size_t i = 0; chest < 0 && i < s.joints.size(); ++i)  // no chest by name: the highest spine
    if (s.joints[i].role == Role::kSpine && s.find(Role::kUpperArmL) >= 0) chest = static_cast<int>(i);
  const int head = s.find(Role::kHead), foot = s.find(Role::kFootL), pelvis = s.find(Role::kPelvis);
  if (chest < 0 || head < 0 || foot < 0) return;
  const auto joint = [&](Role role) {
    return role == Role::kChest ? chest : (role == Role::kPelvis && pelvis < 0 ? 0 : s.find(role));
  };
  const float height = (rest[static_cast<std::size_t>(head)].translation.z() -
                        rest[static_cast<std::size_t>(foot)].translation.z()) /
                       0.86f;
  if (!(height > 0.1f)) return;
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
                     moves >= 0 ? frame.effort_of(static_cast<std::size_t>(moves)) : 0, out);
    }
}

/// Half the thickness of the body's flesh: its shape's smallest radius, m; 0 without a shape.
float girth(const Skeleton& s, std::size_t joint) {
  for (const Collider& c : s.colliders)
    if (c.joint == static_cast<int>(joint))
      return float(c.shape == Shape::kBox ? c.size.minCoeff() : c.size.x());
  return 0;
}

bool is_long_bone(Role role) {
  return role == Role::kUpperArmL || role == Role::kUpperArmR || role == Role::kForearmL ||
         role == Role::kForearmR || role == Role::kThighL || role == Role::kThighR || role == Role::kShinL ||
         role == Role::kShinR;
}

/// Bones from every joint to its children, and around the limbs' long bones two muscles in front and one
/// behind, which move the joint at their far end; over the shoulders the deltoids.
void append_bones(const Skeleton& s, const std::vector<Transform<float>>& rest,
                  const scene::CharacterFrame& frame, Geometry& out) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(s.body_count); ++i) {
    if (s.joints[i].parent < 0) continue;
    const auto p = static_cast<std::size_t>(s.joints[i].parent);
    const Vec3<float> a = frame.model[p].translation, b = frame.model[i].translation;
    const float length = (b - a).norm(), flesh = girth(s, p);
    if (length < 1e-3f) continue;
    const float radius = flesh > 0 ? std::min(0.26f * flesh, 0.2f * length) : 0.07f * length;
    append_capsule(between(a, b), radius, length / 2, kBone, 0, out);
    if (!is_long_bone(s.joints[p].role)) continue;
    const Vec3<float> along = (b - a) / length;
    Vec3<float> front =
        frame.model[p].rotation * (rest[p].rotation.conjugate() * Vec3<float>(Vec3<float>::UnitX()));
    front = (front - front.dot(along) * along).normalized();
    const Vec3<float> left = along.cross(front);
    for (const float angle : {0.25f * kPi, -0.45f * kPi, 0.9f * kPi}) {
      const Vec3<float> side = (std::cos(angle) * front + std::sin(angle) * left) * (0.5f * flesh);
      append_spindle(a + side + 0.03f * length * along, b + 0.5f * side - 0.04f * length * along,
                     0.52f * flesh, frame.effort_of(i), out);
    }
    const Role role = s.joints[p].role;
    if (role != Role::kUpperArmL && role != Role::kUpperArmR) continue;
    // The deltoid lies over the shoulder: above it in a T-pose, outside of it where the arm hangs at rest.
    const Vec3<float> outward(0, role == Role::kUpperArmL ? 1 : -1, 1);
    Vec3<float> over = frame.model[p].rotation * (rest[p].rotation.conjugate() * outward);
    over = (over - over.dot(along) * along).normalized();
    append_spindle(a + 0.35f * flesh * over - 0.20f * length * along,
                   a + 0.55f * flesh * over + 0.58f * length * along, 0.62f * flesh, frame.effort_of(p), out);
  }
}

/// A shape whose body has no child or no known role: its bone, and three muscles around it when its role is
/// unknown.
void append_part(const Collider& c, Role role, const Transform<float>& world, float load, Geometry& out) {
  const float radius = float(c.size.x()), half = float(c.size.z());
  if (c.shape == Shape::kBox) {
    append_capsule({world.rotation * rotation_between<float>(Vec3<float>::UnitZ(), Vec3<float>::UnitX()),
                    world.translation},
                   0.6f * half, 0.75f * radius, kBone, 0, out);
    return;
  }
  if (role != Role::kNone) {
    append_capsule(world, (role == Role::kHead ? 0.82f : 0.5f) * radius, half, kBone, 0, out);
    return;
  }
  const float reach = half + 0.5f * radius;
  append_capsule(world, 0.28f * radius, reach, kBone, 0, out);
  const Vec3<float> along = world.rotation * Vec3<float>::UnitZ();
  for (int k = 0; k < 3; ++k) {
    const float angle = 2 * kPi * (float(k) + 0.25f) / 3;
    const Vec3<float> side = world.rotation * Vec3<float>(std::cos(angle), std::sin(angle), 0);
    const Vec3<float> middle = world.translation + side * (0.5f * radius);
    append_spindle(middle - along * reach, middle + along * reach, 0.5f * radius, load, out);
  }
}

}  // namespace

void append_muscles(const Asset& asset, const scene::CharacterFrame& frame, Geometry& out) {
  const std::size_t first = out.indices.size();
  const Skeleton& s = asset.skeleton;
  const std::vector<Transform<float>> rest = rest_model(s);
  append_bones(s, rest, frame, out);
  append_strands(s, rest, frame, out);
  std::vector<bool> carries(s.joints.size(), false);  // a body further out
  for (std::size_t i = 0; i < static_cast<std::size_t>(s.body_count); ++i)
    if (s.joints[i].parent >= 0) carries[static_cast<std::size_t>(s.joints[i].parent)] = true;
  for (const Collider& c : s.colliders) {
    const auto joint = static_cast<std::size_t>(c.joint);
    const Role role = s.joints[joint].role;
    const bool foot = role == Role::kFootL || role == Role::kFootR;
    if (c.joint >= s.body_count || (role != Role::kNone && carries[joint] && !foot)) continue;
    append_part(c, role, frame.model[joint] * c.local.cast<float>(), frame.effort_of(joint), out);
  }
  out.close_draw(first, {.closed = true});
}

}  // namespace sinew::render
