#include "study/audit/work.h"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>

namespace sinew::audit {
namespace {

using Eigen::Quaterniond, Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;

Vector3d logarithm(const Quaterniond& q) {
  const Eigen::AngleAxisd turn(q);
  return turn.angle() * turn.axis();
}

/// rad, in (−π, π]: how far q turns about an axis.
double twist(const Quaterniond& q, const Vector3d& axis) {
  return std::remainder(2 * std::atan2(axis.dot(q.vec()), q.w()), 2 * kPi);
}

/// The two directions that a planar joint slides along, rest axes: as Skeleton has them.
std::array<Vector3d, 2> in_plane(const Vector3d& normal) {
  const Vector3d first = normal.unitOrthogonal();
  return {first, normal.cross(first)};
}

Transform<double> relative(const Transform<double>& parent, const Transform<double>& child) {
  return parent.inverse() * child;
}

/// Angles of a universal joint from rest: R = exp(axis·a)·exp(axis2·b).
std::array<double, 2> universal(const Body& body, const Quaterniond& from_rest) {
  const double second = twist(from_rest, body.axis2);
  const Quaterniond first = from_rest * Quaterniond(Eigen::AngleAxisd(-second, body.axis2));
  return {twist(first, body.axis), second};
}

/// World motion per unit of a degree of freedom: turning about an axis through a point, and sliding.
struct Axis {
  Vector3d turn = Vector3d::Zero(), slide = Vector3d::Zero(), point = Vector3d::Zero();
};

void axes_of(const Member& member, Poses poses, int b, std::vector<Axis>& axes) {
  const Body& body = member.bodies[static_cast<std::size_t>(b)];
  const Transform<double> parent =
      body.parent < 0 ? Transform<double>() : poses[static_cast<std::size_t>(body.parent)];
  const Quaterniond rest = parent.rotation * body.rest.rotation, own = poses[b].rotation;
  const Vector3d at = poses[b].translation;
  const auto turn = [&](const Vector3d& axis) { axes.push_back({axis, Vector3d::Zero(), at}); };
  const auto slide = [&](const Vector3d& axis) { axes.push_back({Vector3d::Zero(), axis, at}); };
  const auto all = [&](const auto& add, const Quaterniond& frame) {
    for (int k = 0; k < 3; ++k) add(frame * Vector3d::Unit(k));
  };
  switch (body.type) {
    case JointType::kFixed:
      break;
    case JointType::kRevolute:
      turn(own * body.axis);
      break;
    case JointType::kPrismatic:
      slide(own * body.axis);
      break;
    case JointType::kUniversal:
      turn(rest * body.axis);
      turn(own * body.axis2);
      break;
    case JointType::kBall:
      all(turn, own);
      break;
    case JointType::kPlanar:
      for (const Vector3d& way : in_plane(body.axis)) slide(rest * way);
      turn(rest * body.axis);
      break;
    case JointType::kFree:
      all(slide, parent.rotation);
      all(turn, parent.rotation);
      break;
    case JointType::kTranslation:
      all(slide, parent.rotation);
      break;
  }
}

bool hangs_on(const Member& member, int body, int joint) {
  while (body > joint) body = member.bodies[static_cast<std::size_t>(body)].parent;
  return body == joint;
}

/// How a unit of each joint's rate, from dof `first` on, moves a point of a body, and turns it.
struct Moves {
  Eigen::Matrix3Xd slides, turns;

  Moves(const Member& member, const std::vector<Axis>& axes, int first, int body, const Vector3d& point) {
    slides.setZero(3, member.dofs - first);
    turns.setZero(3, member.dofs - first);
    for (int b = 0; b <= body; ++b) {
      if (!hangs_on(member, body, b)) continue;
      const Body& joint = member.bodies[static_cast<std::size_t>(b)];
      for (int dof = std::max(first, joint.first_dof); dof < joint.first_dof + dof_count(joint.type); ++dof) {
        const Axis& axis = axes[static_cast<std::size_t>(dof)];
        turns.col(dof - first) = axis.turn;
        slides.col(dof - first) = axis.slide + axis.turn.cross(point - axis.point);
      }
    }
  }
};

}  // namespace

void joint_way(const Body& body, const Transform<double>& parent_before, const Transform<double>& before,
               const Transform<double>& parent_after, const Transform<double>& after, std::span<double> way) {
  const Transform<double> from = relative(parent_before, before), to = relative(parent_after, after);
  const Quaterniond unrest = body.rest.rotation.conjugate();
  const Vector3d shift = to.translation - from.translation;
  const auto put = [&](std::size_t at, const Vector3d& v) {
    for (int k = 0; k < 3; ++k) way[at + static_cast<std::size_t>(k)] = v[k];
  };
  const auto turned = [&] {
    return std::remainder(twist(unrest * to.rotation, body.axis) - twist(unrest * from.rotation, body.axis),
                          2 * kPi);
  };
  switch (body.type) {
    case JointType::kFixed:
      break;
    case JointType::kRevolute:
      way[0] = turned();
      break;
    case JointType::kPrismatic:
      way[0] = (to.rotation * body.axis).dot(shift);
      break;
    case JointType::kUniversal: {
      const auto a = universal(body, unrest * from.rotation), b = universal(body, unrest * to.rotation);
      for (std::size_t k = 0; k < 2; ++k) way[k] = std::remainder(b[k] - a[k], 2 * kPi);
      break;
    }
    case JointType::kBall:
      put(0, logarithm(from.rotation.conjugate() * to.rotation));
      break;
    case JointType::kPlanar: {
      const auto plane = in_plane(body.axis);
      for (std::size_t k = 0; k < 2; ++k) way[k] = plane[k].dot(unrest * shift);
      way[2] = turned();
      break;
    }
    case JointType::kFree:
      put(0, shift);
      put(3, logarithm(to.rotation * from.rotation.conjugate()));
      break;
    case JointType::kTranslation:
      put(0, shift);
      break;
  }
}

double work_of_torques(const Member& member, Poses before, Poses after, std::span<const double> torques) {
  const Transform<double> world;
  double work = 0;
  for (std::size_t b = 0; b < member.bodies.size(); ++b) {
    const Body& body = member.bodies[b];
    const auto parent = static_cast<std::size_t>(body.parent);
    std::array<double, 6> way{};
    joint_way(body, body.parent < 0 ? world : before[parent], before[b],
              body.parent < 0 ? world : after[parent], after[b], way);
    for (int k = 0; k < dof_count(body.type); ++k) work += torques[body.first_dof + k] * way[k];
  }
  return work;
}

double work_of_impulses(const Member& member, Poses poses, bool root_is_driven,
                        std::span<const PointImpulse> impulses) {
  const int bodies = static_cast<int>(member.bodies.size());
  std::vector<Axis> axes;
  for (int b = 0; b < bodies; ++b) axes_of(member, poses, b, axes);
  const int first = root_is_driven && member.bodies[0].type == JointType::kFree ? 6 : 0;
  const int count = member.dofs - first;
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd given = Eigen::VectorXd::Zero(count);
  double work = 0;
  for (int b = 0; b < bodies; ++b) {
    const Body& body = member.bodies[static_cast<std::size_t>(b)];
    const Moves moves(member, axes, first, b, poses[b] * body.center);
    const Eigen::Matrix3d turn = poses[b].rotation.toRotationMatrix();
    const Eigen::Matrix3d inertia = turn * body.inertia * turn.transpose();
    mass += body.mass * moves.slides.transpose() * moves.slides;
    mass += moves.turns.transpose() * inertia * moves.turns;
  }
  for (const PointImpulse& p : impulses) {
    given += Moves(member, axes, first, p.body, p.point).slides.transpose() * p.impulse;
    work += p.impulse.dot(p.speed);
  }
  return count > 0 ? work + 0.5 * given.dot(mass.ldlt().solve(given)) : work;
}

}  // namespace sinew::audit
