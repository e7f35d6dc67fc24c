#include "study/scenes/judge.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew::study {
namespace {

using Eigen::Isometry3d, Eigen::Matrix3d, Eigen::Vector3d;

template <class S>
Isometry3d isometry(const Transform<S>& from) {
  Isometry3d to = Isometry3d::Identity();
  to.linear() = from.rotation.template cast<double>().normalized().toRotationMatrix();
  to.translation() = from.translation.template cast<double>();
  return to;
}

template <class V>
Solid solid_of(Shape shape, const V& size, const Isometry3d& pose) {
  Solid s;
  s.shape = shape;
  s.pose = pose;
  if (shape == Shape::kBox)
    s.half = size.template cast<double>();
  else
    s.radius = double(size.x());
  if (shape == Shape::kCapsule) s.half.z() = double(size.z());
  return s;
}

Vector3d end(const Solid& capsule, double along) {
  return capsule.pose * Vector3d(0, 0, along * capsule.half.z());
}

/// Distance of a point from a box, negative inside; convex in the point.
double distance(const Solid& box, const Vector3d& point) {
  const Vector3d out = (box.pose.inverse() * point).cwiseAbs() - box.half;
  return out.cwiseMax(0).norm() + std::min(out.maxCoeff(), 0.0);
}

/// The least distance from a box along a segment, by golden sections: distance is convex along it.
double distance(const Solid& box, const Vector3d& from, const Vector3d& to) {
  const double golden = (std::sqrt(5.0) - 1) / 2;
  double low = 0, high = 1;
  const auto at = [&](double t) { return distance(box, from + t * (to - from)); };
  while (high - low > 1e-6) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    if (at(a) < at(b))
      high = b;
    else
      low = a;
  }
  return std::min({at(0), at(1), at((low + high) / 2)});
}

double distance(const Vector3d& p1, const Vector3d& q1, const Vector3d& p2, const Vector3d& q2) {
  const Vector3d d1 = q1 - p1, d2 = q2 - p2, r = p1 - p2;
  const auto to_segment = [](const Vector3d& p, const Vector3d& a, const Vector3d& d) {
    const double t = d.squaredNorm() > 0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
    return (p - a - t * d).norm();
  };
  double least = std::min(
      {to_segment(p1, p2, d2), to_segment(q1, p2, d2), to_segment(p2, p1, d1), to_segment(q2, p1, d1)});
  const double a = d1.squaredNorm(), b = d1.dot(d2), c = d2.squaredNorm(), det = a * c - b * b;
  if (det > 1e-12 * a * c) {
    const double s = (b * d2.dot(r) - c * d1.dot(r)) / det, t = (a * d2.dot(r) - b * d1.dot(r)) / det;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) least = std::min(least, (r + s * d1 - t * d2).norm());
  }
  return least;
}

/// Separating axes: faces of both, and crossed edges.
double box_overlap(const Solid& a, const Solid& b) {
  const Matrix3d ra = a.pose.linear(), rb = b.pose.linear();
  const Vector3d between = b.pose.translation() - a.pose.translation();
  double least = std::numeric_limits<double>::infinity();
  const auto try_axis = [&](const Vector3d& axis) {
    const double length = axis.norm();
    if (length < 1e-6) return;
    const double reach =
        (ra.transpose() * axis).cwiseAbs().dot(a.half) + (rb.transpose() * axis).cwiseAbs().dot(b.half);
    least = std::min(least, (reach - std::abs(between.dot(axis))) / length);
  };
  for (int i = 0; i < 3; ++i) {
    try_axis(ra.col(i));
    try_axis(rb.col(i));
    for (int k = 0; k < 3; ++k) try_axis(ra.col(i).cross(rb.col(k)));
  }
  return least;
}

double reach(const Solid& s) {
  return s.half.norm() + s.radius;
}

}  // namespace

double overlap(const Solid& a, const Solid& b) {
  if (a.shape == Shape::kBox && b.shape == Shape::kBox) return box_overlap(a, b);
  if (b.shape == Shape::kBox) return overlap(b, a);
  if (a.shape == Shape::kBox) return b.radius - distance(a, end(b, -1), end(b, 1));
  return a.radius + b.radius - distance(end(a, -1), end(a, 1), end(b, -1), end(b, 1));
}

double below(const Solid& s, double height) {
  const Eigen::RowVector3d up = s.pose.linear().row(2);
  return height - (s.pose.translation().z() - up.cwiseAbs().dot(s.half) - s.radius);
}

Judge::Judge(const scene::Recording& recording) : recording_(recording) {
  for (const auto& asset : recording.characters) {
    const Skeleton& skeleton = asset->skeleton;
    Member member(static_cast<std::size_t>(skeleton.body_count));
    for (std::size_t i = 0; i < member.size(); ++i) {
      const Joint& joint = skeleton.joints[i];
      member[i] = {joint.mass, joint.center_of_mass, joint.inertia, joint.parent, joint.rest.translation, {}};
      if (joint.type == JointType::kFree || joint.type == JointType::kPlanar ||
          joint.type == JointType::kPrismatic)
        member[i].parent = -1;
    }
    for (const Collider& c : skeleton.colliders)
      if (c.joint < skeleton.body_count)
        member[static_cast<std::size_t>(c.joint)].solids.push_back(
            solid_of(c.shape, c.size, isometry(c.local)));
    members_.push_back(std::move(member));
  }
  for (const scene::Prop& prop : recording.props) {
    Body body;
    body.mass = double(prop.mass);
    body.solids.push_back(solid_of(prop.shape, prop.size, Isometry3d::Identity()));
    members_.push_back({body});
  }
  for (const Collider& c : recording.obstacles)
    obstacles_.push_back(solid_of(c.shape, c.size, isometry(c.local)));
}

int Judge::frame_at(double seconds) const {
  return std::min(frames() - 1, static_cast<int>(std::lround(seconds * recording_.frame_rate)));
}

Isometry3d Judge::pose(int frame, int member, int body) const {
  const scene::Frame& at = recording_.frames[static_cast<std::size_t>(frame)];
  const auto characters = static_cast<int>(recording_.characters.size());
  if (member < characters) return isometry(at.characters[member].model[static_cast<std::size_t>(body)]);
  return isometry(at.props[static_cast<std::size_t>(member - characters)].world);
}

std::vector<Solid> Judge::placed(int frame, int member) const {
  std::vector<Solid> all;
  for (std::size_t b = 0; b < members_[member].size(); ++b)
    for (Solid s : members_[member][b].solids) {
      s.pose = pose(frame, member, static_cast<int>(b)) * s.pose;
      all.push_back(s);
    }
  return all;
}

double Judge::depth_in_surroundings(int frame, int member) const {
  double deepest = 0;
  for (int m = 0; m < members(); ++m) {
    if (member >= 0 && m != member) continue;
    for (const Solid& s : placed(frame, m)) {
      if (recording_.ground) deepest = std::max(deepest, below(s, double(*recording_.ground)));
      for (const Solid& o : obstacles_)
        if ((s.pose.translation() - o.pose.translation()).norm() < reach(s) + reach(o))
          deepest = std::max(deepest, overlap(s, o));
    }
  }
  return deepest;
}

double Judge::depth_between(int frame, int a, int b) const {
  double deepest = 0;
  const std::vector<Solid> others = placed(frame, b);
  for (const Solid& s : placed(frame, a))
    for (const Solid& o : others)
      if ((s.pose.translation() - o.pose.translation()).norm() < reach(s) + reach(o))
        deepest = std::max(deepest, overlap(s, o));
  return deepest;
}

double Judge::distance_from_others(int frame, int member) const {
  double least = std::numeric_limits<double>::infinity();
  const std::vector<Solid> own = placed(frame, member);
  for (int m = 0; m < members(); ++m)
    if (m != member)
      for (const Solid& o : placed(frame, m))
        for (const Solid& s : own) least = std::min(least, -overlap(s, o));
  return least;
}

double Judge::depth_between(int frame) const {
  struct Placed {
    Solid solid;
    int member;
    double low, high;
  };
  std::vector<Placed> all;
  for (int m = 0; m < members(); ++m)
    for (const Solid& s : placed(frame, m)) {
      const double x = s.pose.translation().x(), r = reach(s);
      all.push_back({s, m, x - r, x + r});
    }
  std::sort(all.begin(), all.end(), [](const Placed& a, const Placed& b) { return a.low < b.low; });
  double deepest = 0;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t k = i + 1; k < all.size() && all[k].low < all[i].high; ++k) {
      const Solid &s = all[i].solid, &o = all[k].solid;
      if (all[i].member != all[k].member &&
          (s.pose.translation() - o.pose.translation()).norm() < reach(s) + reach(o))
        deepest = std::max(deepest, overlap(s, o));
    }
  return deepest;
}

double Judge::joint_gap(int frame) const {
  double widest = 0;
  for (int m = 0; m < members(); ++m)
    for (std::size_t b = 0; b < members_[m].size(); ++b) {
      const Body& body = members_[m][b];
      if (body.parent < 0) continue;
      const Vector3d socket = pose(frame, m, body.parent) * body.socket;
      widest = std::max(widest, (pose(frame, m, static_cast<int>(b)).translation() - socket).norm());
    }
  return widest;
}

double Judge::fastest(int frame, int member) const {
  double most = 0;
  for (int m = 0; m < members(); ++m) {
    if (member >= 0 && m != member) continue;
    for (std::size_t b = 0; b < members_[m].size(); ++b) {
      const Vector3d& center = members_[m][b].center;
      const int body = static_cast<int>(b);
      most =
          std::max(most, (pose(frame, m, body) * center - pose(frame - 1, m, body) * center).norm() / step());
    }
  }
  return most;
}

double Judge::kinetic(int frame, int member) const {
  double sum = 0;
  for (std::size_t b = 0; b < members_[member].size(); ++b) {
    const Body& body = members_[member][b];
    const Isometry3d before = pose(frame - 1, member, static_cast<int>(b)),
                     after = pose(frame, member, static_cast<int>(b));
    const Vector3d velocity = (after * body.center - before * body.center) / step();
    const Eigen::AngleAxisd turn(before.linear().transpose() * after.linear());
    const Vector3d spin = turn.angle() / step() * turn.axis();
    sum += 0.5 * (body.mass * velocity.squaredNorm() + spin.dot(body.inertia * spin));
  }
  return sum;
}

Vector3d Judge::center_of_mass(int frame, int member) const {
  Vector3d sum = Vector3d::Zero();
  double mass = 0;
  for (std::size_t b = 0; b < members_[member].size(); ++b) {
    const Body& body = members_[member][b];
    sum += body.mass * (pose(frame, member, static_cast<int>(b)) * body.center);
    mass += body.mass;
  }
  return sum / mass;
}

Vector3d Judge::velocity(int frame, int member) const {
  return (center_of_mass(frame, member) - center_of_mass(frame - 1, member)) / step();
}

bool Judge::finite(int frame) const {
  for (int m = 0; m < members(); ++m)
    for (std::size_t b = 0; b < members_[m].size(); ++b)
      if (!pose(frame, m, static_cast<int>(b)).matrix().allFinite()) return false;
  return true;
}

double apart(const scene::Recording& a, int member_a, const scene::Recording& b, int member_b, int frame) {
  const auto points = [frame](const scene::Recording& r, int member) {
    const scene::Frame& at = r.frames[static_cast<std::size_t>(frame)];
    const auto characters = static_cast<int>(r.characters.size());
    std::vector<Vector3d> all;
    if (member >= characters) {
      all.emplace_back(
          at.props[static_cast<std::size_t>(member - characters)].world.translation.cast<double>());
      return all;
    }
    for (const Transform<float>& joint : at.characters[member].model)
      all.emplace_back(joint.translation.cast<double>());
    return all;
  };
  const std::vector<Vector3d> p = points(a, member_a), q = points(b, member_b);
  double furthest = p.size() == q.size() ? 0 : std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < std::min(p.size(), q.size()); ++i)
    furthest = std::max(furthest, (p[i] - q[i]).norm());
  return furthest;
}

}  // namespace sinew::study
