#include "study/audit/member.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew::audit {
namespace {

using Eigen::Vector3d;

bool near(const Solid& a, const Solid& b) {
  return (a.pose.translation() - b.pose.translation()).norm() < reach(a) + reach(b);
}

/// rad, between two directions; exact where they are nearly the same.
double angle_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// rad, by how much a joint turns about what it is no hinge for. `turned`: child → rest.
double across(const Body& body, const Eigen::Quaterniond& turned) {
  switch (body.type) {
    case JointType::kFixed:
    case JointType::kPrismatic:
      return Eigen::AngleAxisd(turned).angle();
    case JointType::kRevolute:
    case JointType::kPlanar:
      return angle_between(turned * body.axis, body.axis);
    case JointType::kUniversal: {  // the second axis, which the child carries, stays square to the first
      const double square = body.axis.dot(body.axis2);
      return std::abs(std::acos(std::clamp((turned * body.axis2).dot(body.axis), -1.0, 1.0)) -
                      std::acos(std::clamp(square, -1.0, 1.0)));
    }
    default:
      return 0;
  }
}

/// m, of a joint's way from rest (rest axes), the part that it cannot slide.
double apart(const Body& body, const Vector3d& way) {
  switch (body.type) {
    case JointType::kFree:
    case JointType::kTranslation:
      return 0;
    case JointType::kPrismatic:
      return (way - body.axis * body.axis.dot(way)).norm();
    case JointType::kPlanar:
      return std::abs(body.axis.dot(way));
    default:
      return way.norm();
  }
}

/// Whether two bodies of a member may meet: neither neighbours nor in each other at rest.
class Meeting {
 public:
  explicit Meeting(const Member& member) : count_(member.bodies.size()), meet_(count_ * count_, 1) {
    std::vector<Transform<double>> rest;
    for (const Body& body : member.bodies)
      rest.push_back(body.parent < 0 ? body.rest : rest[static_cast<std::size_t>(body.parent)] * body.rest);
    std::vector<int> whose;
    const std::vector<Solid> solids = placed(member, rest, &whose);
    for (std::size_t i = 0; i < solids.size(); ++i)
      for (std::size_t k = 0; k < solids.size(); ++k)
        if (near(solids[i], solids[k]) && overlap(solids[i], solids[k]) > 0) forbid(whose[i], whose[k]);
    for (std::size_t b = 0; b < count_; ++b)
      if (member.bodies[b].parent >= 0) forbid(static_cast<int>(b), member.bodies[b].parent);
  }
  bool operator()(int a, int b) const { return meet_[index(a, b)] != 0; }

 private:
  std::size_t index(int a, int b) const {
    return static_cast<std::size_t>(a) * count_ + static_cast<std::size_t>(b);
  }
  void forbid(int a, int b) { meet_[index(a, b)] = meet_[index(b, a)] = 0; }

  std::size_t count_;
  std::vector<char> meet_;
};

double depth_in_itself(const Member& member, Poses poses) {
  const Meeting meet(member);
  std::vector<int> whose;
  const std::vector<Solid> solids = placed(member, poses, &whose);
  double deepest = 0;
  for (std::size_t i = 0; i < solids.size(); ++i)
    for (std::size_t k = i + 1; k < solids.size(); ++k)
      if (meet(whose[i], whose[k]) && near(solids[i], solids[k]))
        deepest = std::max(deepest, overlap(solids[i], solids[k]));
  return deepest;
}

}  // namespace

Member member_of(const Skeleton& skeleton) {
  Member member;
  for (int i = 0; i < skeleton.body_count; ++i) {
    const Joint& joint = skeleton.joints[static_cast<std::size_t>(i)];
    Body body;
    body.mass = joint.mass;
    body.center = joint.center_of_mass;
    body.inertia = joint.inertia;
    body.type = joint.type;
    body.parent = joint.parent;
    body.rest = joint.rest;
    body.axis = joint.axis;
    body.axis2 = joint.axis2;
    body.first_dof = member.dofs;
    member.dofs += dof_count(joint.type);
    member.bodies.push_back(std::move(body));
  }
  for (const Collider& c : skeleton.colliders)
    if (c.joint < skeleton.body_count)
      member.bodies[static_cast<std::size_t>(c.joint)].solids.push_back(solid_of(c));
  return member;
}

Member loose_solid(Shape shape, const Vector3d& size, double mass, const ConvexHull* hull) {
  Body body;
  body.mass = mass;
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  body.solids.push_back(hull ? solid_of(*hull, here) : solid_of(shape, size, here));
  body.inertia = hull ? inertia_of(*hull, mass, body.center) : inertia_of(body.solids[0], mass);
  Member member;
  member.dofs = dof_count(body.type);
  member.bodies.push_back(std::move(body));
  return member;
}

std::vector<Solid> placed(const Member& member, Poses poses, std::vector<int>* bodies) {
  std::vector<Solid> all;
  for (std::size_t b = 0; b < member.bodies.size(); ++b) {
    const Eigen::Isometry3d pose = isometry(poses[b]);
    for (Solid s : member.bodies[b].solids) {
      s.pose = pose * s.pose;
      all.push_back(s);
      if (bodies) bodies->push_back(static_cast<int>(b));
    }
  }
  return all;
}

namespace {

constexpr double kTurned = 6;  ///< roundings of a vector that a quaternion turns: twelve halves, at most

}  // namespace

Gap joint_gap(const Member& member, Poses poses, double precision) {
  Gap widest;
  for (std::size_t b = 0; b < member.bodies.size(); ++b) {
    const Body& body = member.bodies[b];
    if (body.parent < 0) continue;
    const Transform<double>& parent = poses[static_cast<std::size_t>(body.parent)];
    const Eigen::Isometry3d socket = isometry(parent) * isometry(body.rest);
    const Eigen::Isometry3d from_rest = socket.inverse() * isometry(poses[b]);
    // Both places are rounded, and so is the arm between them, in the dozen operations that turn it: a slide
    // that has gone 600 m is known to 0.4 mm in float.
    const double rounding =
        precision * (2 * (parent.translation.norm() + poses[b].translation.norm()) +
                     kTurned * (body.rest.translation.norm() + from_rest.translation().norm()));
    widest.distance = std::max(widest.distance, apart(body, from_rest.translation()) - rounding);
    widest.angle =
        std::max(widest.angle, across(body, Eigen::Quaterniond(from_rest.linear())) - 2 * precision);
  }
  return widest;
}

Vector3d center_of_mass(const Member& member, Poses poses) {
  Vector3d sum = Vector3d::Zero();
  double mass = 0;
  for (std::size_t b = 0; b < member.bodies.size(); ++b) {
    sum += member.bodies[b].mass * (isometry(poses[b]) * member.bodies[b].center);
    mass += member.bodies[b].mass;
  }
  return sum / mass;
}

double depth_in(const Surroundings& around, const Member& member, Poses poses) {
  double deepest = 0;
  for (const Solid& s : placed(member, poses)) {
    if (around.ground && member.touches_ground) deepest = std::max(deepest, below(s, around.ground_height));
    for (const Solid& o : around.obstacles)
      if (near(s, o)) deepest = std::max(deepest, overlap(s, o));
  }
  return deepest;
}

double depth_between(const Member& a, Poses at_a, const Member& b, Poses at_b) {
  double deepest = 0;
  const std::vector<Solid> others = placed(b, at_b);
  for (const Solid& s : placed(a, at_a))
    for (const Solid& o : others)
      if (near(s, o)) deepest = std::max(deepest, overlap(s, o));
  return deepest;
}

double distance_between(const Member& a, Poses at_a, const Member& b, Poses at_b) {
  double least = std::numeric_limits<double>::infinity();
  const std::vector<Solid> others = placed(b, at_b);
  for (const Solid& s : placed(a, at_a))
    for (const Solid& o : others) least = std::min(least, -overlap(s, o));
  return least;
}

double deepest_between(std::span<const Member> members, std::span<const Poses> poses) {
  struct Placed {
    Solid solid;
    std::size_t member;
    double low, high;
  };
  std::vector<Placed> all;
  double deepest = 0;
  for (std::size_t m = 0; m < members.size(); ++m) {
    if (members[m].touches_itself) deepest = std::max(deepest, depth_in_itself(members[m], poses[m]));
    for (const Solid& s : placed(members[m], poses[m])) {
      const double x = s.pose.translation().x(), r = reach(s);
      all.push_back({s, m, x - r, x + r});
    }
  }
  std::sort(all.begin(), all.end(), [](const Placed& a, const Placed& b) { return a.low < b.low; });
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t k = i + 1; k < all.size() && all[k].low < all[i].high; ++k)
      if (all[i].member != all[k].member && near(all[i].solid, all[k].solid))
        deepest = std::max(deepest, overlap(all[i].solid, all[k].solid));
  return deepest;
}

}  // namespace sinew::audit
