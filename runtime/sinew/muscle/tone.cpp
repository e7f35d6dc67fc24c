#include "sinew/muscle/tone.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>

namespace sinew {
namespace {

constexpr std::array<const char*, 4> kNames{"rigid", "relaxed", "alert", "braced"};

/// N·m/rad of a human of 75 kg, relaxed, alert and braced. Chosen: in the order of a tensed joint's 3 to 8
/// times its torque per radian, and of controllers that walk (SIMBICON: hip and knee 300, trunk 200, ankle
/// 75, shoulder 20, elbow 5).
struct Row {
  std::array<double, 3> stiffness;
};
constexpr Row kNeck{{10, 30, 80}}, kSpine{{100, 300, 800}}, kShoulder{{5, 20, 80}}, kElbow{{2, 8, 40}},
    kWrist{{0.5, 2, 8}}, kHip{{60, 300, 800}}, kKnee{{30, 300, 600}}, kAnkle{{40, 150, 400}};
constexpr std::array<double, 3> kDampingRatio{0.2, 0.3, 0.7};
/// 1/rad: of a muscle's limit, where nothing says what the joint is. As the table's knee and hip.
constexpr std::array<double, 3> kOfLimit{0.3, 1.5, 4};

const Row* row_of(Role role) {
  switch (role) {
    case Role::kNeck:
    case Role::kHead:
      return &kNeck;
    case Role::kSpine:
    case Role::kChest:
    case Role::kClavicleL:  // it carries the arm on the trunk
    case Role::kClavicleR:
      return &kSpine;
    case Role::kUpperArmL:
    case Role::kUpperArmR:
      return &kShoulder;
    case Role::kForearmL:
    case Role::kForearmR:
      return &kElbow;
    case Role::kHandL:
    case Role::kHandR:
    case Role::kToesL:
    case Role::kToesR:
      return &kWrist;
    case Role::kThighL:
    case Role::kThighR:
      return &kHip;
    case Role::kShinL:
    case Role::kShinR:
      return &kKnee;
    case Role::kFootL:
    case Role::kFootR:
      return &kAnkle;
    case Role::kPelvis:
    case Role::kNone:
      break;
  }
  return nullptr;
}

/// Whether a joint without a role is one of the spine's: what it carries ends in a head or chest.
bool is_spine(const Skeleton& s, int joint) {
  for (const Role role : {Role::kHead, Role::kChest})
    for (int i = s.find(role); i >= 0; i = s.joints[static_cast<std::size_t>(i)].parent)
      if (i == joint) return true;
  return false;
}

/// Whether a degree of freedom turns a joint within its body.
bool turns(JointType type, int dof) {
  constexpr int kSlides = 2;  // of a planar joint
  return type == JointType::kRevolute || type == JointType::kUniversal || type == JointType::kBall ||
         (type == JointType::kPlanar && dof >= kSlides);
}

}  // namespace

Status tone_named(const char* name, Tone& tone) {
  const auto found = std::find(kNames.begin(), kNames.end(), std::string_view(name));
  if (found == kNames.end())
    return Status::error(Code::kInvalidArgument, "a tone is rigid, relaxed, alert or braced");
  tone = static_cast<Tone>(std::distance(kNames.begin(), found));
  return {};
}

Stiffness stiffness_of(const Skeleton& s, const Scale<double>& scale, int joint, int dof, Tone tone) {
  Stiffness of;
  const Joint& j = s.joints[static_cast<std::size_t>(joint)];
  if (tone == Tone::kRigid || !turns(j.type, dof)) return of;
  const Row* row = row_of(j.role);
  if (!row && j.role == Role::kNone && is_spine(s, joint)) row = &kSpine;
  const auto preset = static_cast<std::size_t>(tone) - 1;
  const std::array<double, 2> limits = s.torque_limits(joint, dof);
  const double stiffness = row ? row->stiffness[preset] * scale.energy * scale.length
                               : kOfLimit[preset] * std::max(limits[0], limits[1]);
  if (!(stiffness > 0)) return of;  // nobody to be tense
  of.stiffness = stiffness;
  of.damping_ratio = kDampingRatio[preset];
  return of;
}

}  // namespace sinew
