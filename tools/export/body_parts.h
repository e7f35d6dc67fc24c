// What descriptions of physical bodies in XML share: names, numbers in digits, which joint hangs on which,
// and joints taken apart into those that the formats have.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "sinew/skeleton/skeleton.h"

namespace sinew::exporting {

constexpr double kUnlimited = 1e9;  ///< as DofLimits has it

/// A number with as many digits as it takes to read the same one again.
std::string in_digits(double number);
std::string in_digits(const Vec3<double>& v);
std::string in_digits(const Quat<double>& q);  ///< w x y z

/// Names of joints, made unique and none of `taken`: "hand", "hand_2".
std::vector<std::string> unique_names(const Skeleton& skeleton, std::set<std::string> taken = {});
/// What moves each body: Joint::source_joint, or the body's own name; made unique.
std::vector<std::string> unique_joint_names(const Skeleton& skeleton);

/// [joint] simulated joints that hang on it.
std::vector<std::vector<int>> simulated_children(const Skeleton& skeleton);

/// One of the simple joints that together move as a Sinew joint does, the first of them first. Their axes are
/// those of the child at rest.
struct JointPart {
  enum class Kind { kHinge, kSlide, kBall, kFree };
  Kind kind = Kind::kHinge;
  Vec3<double> axis = Vec3<double>::UnitZ();
  int dof = 0;              ///< the first that it stands for
  const char* suffix = "";  ///< of its name
};
std::vector<JointPart> parts_of(const Joint& joint);

/// The largest angle that a ball joint's limits allow, rad; π where they allow any.
double largest_angle(const Joint& joint);

/// Says the same of several joints once, and names the first of them.
class BodyNotes {
 public:
  void add(const std::string& joint, const std::string& what);
  void append_to(std::vector<std::string>& notes) const;

 private:
  std::map<std::string, std::vector<std::string>> joints_;
};

}  // namespace sinew::exporting
