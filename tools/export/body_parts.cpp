#include "export/body_parts.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

namespace sinew::exporting {
namespace {

std::string made_unique(std::string name, std::set<std::string>& taken) {
  if (name.empty()) name = "joint";
  const std::string first = name;
  for (int k = 2; !taken.insert(name).second; ++k) name = first + "_" + std::to_string(k);
  return name;
}

}  // namespace

std::string in_digits(double number) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number == 0 ? 0.0 : number).ptr;
  return {text.data(), end};
}

std::string in_digits(const Vec3<double>& v) {
  return in_digits(v.x()) + " " + in_digits(v.y()) + " " + in_digits(v.z());
}

std::string in_digits(const Quat<double>& q) {
  return in_digits(q.w()) + " " + in_digits(Vec3<double>(q.vec()));
}

std::vector<std::string> unique_names(const Skeleton& skeleton, std::set<std::string> taken) {
  std::vector<std::string> names;
  for (const Joint& joint : skeleton.joints) names.push_back(made_unique(joint.name, taken));
  return names;
}

std::vector<std::string> unique_joint_names(const Skeleton& skeleton) {
  std::set<std::string> taken;
  std::vector<std::string> names;
  for (const Joint& joint : skeleton.joints)
    names.push_back(made_unique(joint.source_joint.empty() ? joint.name : joint.source_joint, taken));
  return names;
}

std::vector<std::vector<int>> simulated_children(const Skeleton& skeleton) {
  std::vector<std::vector<int>> children(skeleton.joints.size());
  for (int i = 0; i < skeleton.body_count; ++i)
    if (const int parent = skeleton.joints[static_cast<std::size_t>(i)].parent; parent >= 0)
      children[static_cast<std::size_t>(parent)].push_back(i);
  return children;
}

std::vector<JointPart> parts_of(const Joint& joint) {
  using enum JointPart::Kind;
  const Quat<double> to_child = joint.rest.rotation.conjugate();
  const auto along_parent = [&](int k) {
    return Vec3<double>(to_child * Vec3<double>(Vec3<double>::Unit(k)));
  };
  std::vector<JointPart> slides;
  for (const auto& [k, suffix] : {std::pair(0, "_x"), std::pair(1, "_y"), std::pair(2, "_z")})
    slides.push_back({kSlide, along_parent(k), k, suffix});
  switch (joint.type) {
    case JointType::kRevolute:
      return {{kHinge, joint.axis}};
    case JointType::kPrismatic:
      return {{kSlide, joint.axis}};
    case JointType::kUniversal:
      return {{kHinge, joint.axis, 0, "_1"}, {kHinge, joint.axis2, 1, "_2"}};
    case JointType::kBall:
      return {{kBall}};
    case JointType::kPlanar: {
      const Vec3<double> x = joint.axis.unitOrthogonal();
      return {{kSlide, x, 0, "_x"}, {kSlide, joint.axis.cross(x), 1, "_y"}, {kHinge, joint.axis, 2, "_turn"}};
    }
    case JointType::kFree:
      if (joint.parent < 0) return {{kFree}};
      slides.push_back({kBall, Vec3<double>::UnitZ(), 3, "_turn"});
      return slides;
    case JointType::kTranslation:
      return slides;
    case JointType::kFixed:
      break;
  }
  return {};
}

double largest_angle(const Joint& joint) {
  constexpr double kAny = std::numbers::pi;
  if (joint.swing_limit >= 0) {
    const double twist = std::max(std::abs(joint.twist_lower), std::abs(joint.twist_upper));
    if (joint.swing_limit >= kAny || twist >= kAny) return kAny;
    return 2 * std::acos(std::cos(joint.swing_limit / 2) * std::cos(twist / 2));
  }
  double square = 0;
  for (int k = 0; k < 3; ++k) {
    const double most = std::max(std::abs(joint.dofs[k].lower), std::abs(joint.dofs[k].upper));
    square += most * most;
  }
  return std::min(std::sqrt(square), kAny);
}

void BodyNotes::add(const std::string& joint, const std::string& what) {
  std::vector<std::string>& joints = joints_[what];
  if (joints.empty() || joints.back() != joint) joints.push_back(joint);
}

void BodyNotes::append_to(std::vector<std::string>& notes) const {
  constexpr std::size_t kNamed = 3;
  for (const auto& [what, joints] : joints_) {
    std::string names;
    for (std::size_t k = 0; k < joints.size() && k < kNamed; ++k) names += (k > 0 ? ", " : "") + joints[k];
    if (joints.size() > kNamed) names += " and " + std::to_string(joints.size() - kNamed) + " more";
    notes.push_back(what + " (" + names + ")");
  }
}

}  // namespace sinew::exporting
