#include "sinew/skeleton/skeleton.h"

#include <cmath>

#include "sinew/skeleton/convex_hull.h"
#include "sinew/skeleton/principal_axes.h"

namespace sinew {

int Skeleton::dof_total() const {
  int total = 0;
  for (int i = 0; i < body_count; ++i) total += dof_count(joints[i].type);
  return total;
}

int Skeleton::find(const char* joint_name) const {
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (joints[i].name == joint_name) return static_cast<int>(i);
  return -1;
}

int Skeleton::find(Role role) const {
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (joints[i].role == role) return static_cast<int>(i);
  return -1;
}

int Skeleton::find_muscle(const char* muscle_name) const {
  for (std::size_t i = 0; i < muscles.size(); ++i)
    if (muscles[i].name == muscle_name) return static_cast<int>(i);
  return -1;
}

std::array<double, 2> Skeleton::torque_limits(int joint, int dof) const {
  const DofLimits& own = joints[joint].dofs[dof];
  std::array<double, 2> sum{own.torque_minus, own.torque_plus};
  for (const Muscle& muscle : muscles) {
    if (muscle.joint != joint || muscle.dof != dof) continue;
    sum[0] += muscle.torque_minus;
    sum[1] += muscle.torque_plus;
  }
  return sum;
}

double Skeleton::total_mass() const {
  double total = 0;
  for (const Joint& joint : joints) total += joint.mass;
  return total;
}

namespace {

bool is_unit(const Vec3<double>& v) {
  return std::abs(v.norm() - 1) < 1e-6;
}

bool is_finite(const Transform<double>& x) {
  return x.rotation.coeffs().allFinite() && x.translation.allFinite() &&
         std::abs(x.rotation.norm() - 1) < 1e-6;
}

/// Second moment P = ½ tr(I)·1 − I positive semidefinite, up to rounding: a body with this inertia can exist.
bool can_exist(const Mat3<double>& inertia) {
  const Vec3<double> principal = principal_axes(inertia).values;
  const double slack = 1e-9 * principal[2];
  return principal[0] >= -slack && principal[0] + principal[1] >= principal[2] - slack;
}

Status check_dof(const DofLimits& dof, int index) {
  if (std::isnan(dof.lower) || std::isnan(dof.upper))
    return Status::error(Code::kNotFinite, "limit is NaN", index);
  if (dof.lower > dof.upper) return Status::error(Code::kInvalidArgument, "lower limit above upper", index);
  for (const double strength : {dof.torque_minus, dof.torque_plus, dof.damping, dof.dry_friction}) {
    if (std::isnan(strength)) return Status::error(Code::kNotFinite, "muscle limit or damping is NaN", index);
    if (strength < 0)
      return Status::error(Code::kInvalidArgument, "muscle limit or damping is negative", index);
  }
  return {};
}

Status check_joint(const Skeleton& skeleton, int i) {
  const Joint& joint = skeleton.joints[i];
  if (joint.parent >= i || joint.parent < -1)
    return Status::error(Code::kInvalidArgument, "parent does not come before its child", i);
  if (!is_finite(joint.rest))
    return Status::error(Code::kNotFinite, "rest transform is not a finite rotation", i);
  const bool simulated = i < skeleton.body_count;
  if (!simulated && joint.mass != 0)
    return Status::error(Code::kInvalidArgument, "ride-along joint has mass", i);
  if (simulated && joint.parent >= skeleton.body_count)
    return Status::error(Code::kInvalidArgument, "simulated joint hangs on a ride-along joint", i);
  if (!is_unit(joint.axis) || !is_unit(joint.axis2) || !is_unit(joint.swing_axis))
    return Status::error(Code::kInvalidArgument, "axis is not of length 1", i);
  if (!std::isfinite(joint.mass) || !joint.center_of_mass.allFinite() || !joint.inertia.allFinite())
    return Status::error(Code::kNotFinite, "mass, centre of mass or inertia is not finite", i);
  if (joint.mass < 0) return Status::error(Code::kInvalidArgument, "negative mass", i);
  if (!joint.inertia.isApprox(joint.inertia.transpose(), 1e-9) && joint.inertia.norm() > 0)
    return Status::error(Code::kInvalidArgument, "inertia is not symmetric", i);
  if (!can_exist(joint.inertia))
    return Status::error(Code::kInvalidArgument, "inertia breaks the triangle inequality", i);
  if (joint.type == JointType::kUniversal && std::abs(joint.axis.dot(joint.axis2)) > 1e-6)
    return Status::error(Code::kInvalidArgument, "axes of a universal joint are not square to each other", i);
  if (std::isnan(joint.swing_limit) || std::isnan(joint.twist_lower) || std::isnan(joint.twist_upper))
    return Status::error(Code::kNotFinite, "swing or twist limit is NaN", i);
  if (joint.ellipsoidal_limit && joint.type != JointType::kBall)
    return Status::error(Code::kInvalidArgument, "ellipsoidal limit of a joint that is no ball joint", i);
  if (joint.twist_lower > joint.twist_upper)
    return Status::error(Code::kInvalidArgument, "lower twist limit above upper", i);
  for (int k = 0; k < dof_count(joint.type); ++k)
    if (Status status = check_dof(joint.dofs[k], i); !status) return status;
  return {};
}

Status check_muscle(const Skeleton& skeleton, const Muscle& muscle) {
  const int joint = muscle.joint;
  if (joint < 0 || joint >= skeleton.body_count)
    return Status::error(Code::kInvalidArgument, "muscle on a joint that is not simulated", joint);
  const JointType type = skeleton.joints[joint].type;
  if (type == JointType::kFree || muscle.dof < 0 || muscle.dof >= dof_count(type))
    return Status::error(Code::kInvalidArgument, "muscle on a degree of freedom that does not exist", joint);
  if (!(muscle.torque_minus >= 0) || !(muscle.torque_plus >= 0))
    return Status::error(Code::kInvalidArgument, "muscle's limit is negative or NaN", joint);
  return {};
}

}  // namespace

double bounding_radius(const Collider& c) {
  if (c.shape == Shape::kConvex) return c.hull->bounding_radius();
  if (c.shape == Shape::kBox) return c.size.norm();
  return c.size.x() + (c.shape == Shape::kCapsule ? c.size.z() : 0);
}

Status validate(const Collider& c) {
  if (!is_finite(c.local) || !c.size.allFinite() || c.size.minCoeff() < 0 || !std::isfinite(c.friction) ||
      c.friction < 0)
    return Status::error(Code::kInvalidArgument, "collider has no meaningful size, place or friction",
                         c.joint);
  if (c.shape == Shape::kConvex &&
      (!c.hull || c.hull->corners().empty() || c.size != Vec3<double>::Constant(c.hull->inner_radius())))
    return Status::error(Code::kInvalidArgument, "convex collider has no hull, or not its size", c.joint);
  return {};
}

Status validate(const Skeleton& skeleton) {
  const int count = static_cast<int>(skeleton.joints.size());
  if (count == 0) return Status::error(Code::kInvalidArgument, "no joints");
  if (skeleton.body_count < 1 || skeleton.body_count > count)
    return Status::error(Code::kInvalidArgument, "body_count out of range");
  for (int i = 0; i < count; ++i)
    if (Status status = check_joint(skeleton, i); !status) return status;

  // Every degree of freedom must move some mass, or its inertia is singular.
  std::vector<double> subtree(skeleton.body_count, 0.0);
  for (int i = skeleton.body_count - 1; i >= 0; --i) {
    subtree[i] += skeleton.joints[i].mass;
    if (skeleton.joints[i].parent >= 0) subtree[skeleton.joints[i].parent] += subtree[i];
    if (subtree[i] <= 0 && dof_count(skeleton.joints[i].type) > 0)
      return Status::error(Code::kInvalidArgument, "joint moves no mass", i);
  }
  for (const Muscle& muscle : skeleton.muscles)
    if (Status status = check_muscle(skeleton, muscle); !status) return status;
  for (const Collider& collider : skeleton.colliders) {
    if (collider.joint < 0 || collider.joint >= count)
      return Status::error(Code::kInvalidArgument, "collider on a joint that does not exist", collider.joint);
    if (Status status = validate(collider); !status) return status;
  }
  return {};
}

}  // namespace sinew
