#include "sinew/effects/contact.h"

#include <algorithm>

#include "sinew/effects/hull_distance.h"
#include "sinew/effects/solid_gap.h"
#include "sinew/effects/static_shape.h"
#include "sinew/skeleton/portable_math.h"

namespace sinew {

template <class T>
SignedDistance<T> signed_distance(Shape shape, const Vec3<T>& size, const Vec3<T>& point,
                                  const ConvexHull* hull) {
  switch (shape) {
    case Shape::kConvex: {
      const SignedDistance<double> d = hull_distance(*hull, point.template cast<double>());
      return {T(d.distance), d.normal.template cast<T>(), T(d.curvature), d.straight.template cast<T>()};
    }
    case Shape::kSphere:
    case Shape::kCapsule: {
      const T half = shape == Shape::kCapsule ? size.z() : T(0);
      const Vec3<T> offset = point - Vec3<T>(0, 0, std::clamp(point.z(), -half, half));
      const T length = offset.norm();
      // On the axis any direction is right; take one that is square to it.
      const Vec3<T> normal = length > T(1e-9) ? Vec3<T>(offset / length) : Vec3<T>(Vec3<T>::UnitX());
      const bool side = shape == Shape::kCapsule && std::abs(point.z()) < half;
      return {length - size.x(), normal, length > T(1e-9) ? 1 / length : T(0),
              side ? Vec3<T>(Vec3<T>::UnitZ()) : Vec3<T>(Vec3<T>::Zero())};
    }
    case Shape::kBox:
      break;
  }
  const Vec3<T> beyond = point.cwiseAbs() - size;
  if (beyond.maxCoeff() > T(0)) {  // outside: the nearest point of the box
    const Vec3<T> offset = point - point.cwiseMax(-size).cwiseMin(size);
    const T length = offset.norm();
    const Vec3<T> outside =
        (beyond.array() > T(0)).template cast<T>();  // one face, two at an edge, three at a corner
    const Vec3<T> edge = Vec3<T>::Ones() - outside;
    const bool face = outside.sum() < T(1.5);
    return {length, offset / length, face ? T(0) : 1 / length,
            outside.sum() > T(2.5) ? Vec3<T>(Vec3<T>::Zero()) : edge};
  }
  Eigen::Index axis = 0;
  const T depth = beyond.maxCoeff(&axis);
  Vec3<T> normal = Vec3<T>::Zero();
  normal[axis] = point[axis] < T(0) ? T(-1) : T(1);
  return {depth, normal, T(0), Vec3<T>::Zero()};
}

template <class T>
void append_contact_points(const Collider& collider, std::vector<ContactPoint<T>>& out, int index,
                           double unit) {
  const auto add = [&](PointKind kind, const Vec3<double>& in_shape, double radius, double half) {
    ContactPoint<T> point;
    point.body = collider.joint;
    point.kind = kind;
    point.local = (collider.local * in_shape).template cast<T>();
    point.half_axis = (collider.local.rotation * Vec3<double>(0, 0, half)).template cast<T>();
    point.radius = T(radius);
    point.friction = T(collider.friction);
    point.restitution = T(collider.restitution);
    point.collider = index;
    out.push_back(point);
  };
  const Vec3<double>& s = collider.size;
  switch (collider.shape) {
    case Shape::kSphere:
      add(PointKind::kTip, Vec3<double>::Zero(), s.x(), 0);
      add(PointKind::kAxis, Vec3<double>::Zero(), s.x(), 0);
      break;
    case Shape::kCapsule: {
      add(PointKind::kTip, {0, 0, s.z()}, s.x(), 0);
      if (s.z() > 0) add(PointKind::kTip, {0, 0, -s.z()}, s.x(), 0);
      add(PointKind::kAxis, Vec3<double>::Zero(), s.x(), s.z());
      const int inner = static_cast<int>(std::min(s.z() / std::max(s.x(), 1e-3 * unit), 6.0));
      for (int n = 1; n <= inner; ++n)
        add(PointKind::kInner, {0, 0, s.z() * (2.0 * n / (inner + 1) - 1)}, s.x(), 0);
      break;
    }
    case Shape::kBox: {
      const double round = box_rounding(s, unit);
      const Vec3<double> in = s.array() - round;
      for (int corner = 0; corner < 8; ++corner)
        add(PointKind::kCorner,
            {corner & 1 ? in.x() : -in.x(), corner & 2 ? in.y() : -in.y(), corner & 4 ? in.z() : -in.z()},
            round, 0);
      break;
    }
    case Shape::kConvex:
      for (const RoundedCorner& corner : rounded_corners(*collider.hull, box_rounding(s, unit)))
        add(PointKind::kCorner, corner.center, corner.radius, 0);
      break;
  }
}

namespace {

template <class T>
Vec3<T> at(const Kinematics<T>* k, int body, const Vec3<T>& local) {
  return k ? Vec3<T>(k->origin[body] + k->rotation[body] * local) : local;
}

}  // namespace

namespace {

constexpr double kParallel = 0.05;  ///< rad; lines that are nearer to parallel slide as those at that do

/// Distance between the axis of a (half length `a`, about `from`) and that of a sphere or capsule in its own
/// axes, and how far along the first the nearest point lies, in [−1, 1]. The distance of two skew axes does
/// not bend along either. `across`: see Sliding; zero where the nearest point is an end of a's.
template <class T>
SignedDistance<T> axis_distance(const Vec3<T>& size, T half, const Vec3<T>& from, const Vec3<T>& a, T& along,
                                Vec3<T>& across) {
  // Nearest points of from + s·a and (0, 0, t): alternating clamps on the exact minimiser.
  const T aa = a.squaredNorm(), az = a.z();
  const T sine = aa - az * az;  // squared, times aa
  const Vec3<T>& r = from;
  T s = T(0);
  bool inner = false;
  if (sine > T(1e-6) * aa) {
    const T free = (az * r.z() - a.dot(r)) / sine;
    s = std::clamp(free, T(-1), T(1));
    inner = free == s;
  }
  const T t_free = r.z() + s * az;
  const T t = std::clamp(t_free, -half, half);
  if (t != t_free || !inner) {
    s = std::clamp((az * t - a.dot(r)) / aa, T(-1), T(1));
    inner = false;
  }
  along = s;
  across.setZero();
  const Vec3<T> p = r + s * a;
  if (!inner || half <= T(0)) {
    auto d =
        signed_distance<T>(half > T(0) ? Shape::kCapsule : Shape::kSphere, {size.x(), size.y(), half}, p);
    if (std::abs(s) < T(1)) across = d.straight = a / std::sqrt(aa);
    return d;
  }
  const Vec3<T> offset(p.x(), p.y(), T(0));
  const T length = offset.norm();
  if (length > T(1e-6)) {
    across = Vec3<T>(offset.y(), -offset.x(), T(0)) / length;
    return {length - size.x(), offset / length, T(0), Vec3<T>::Zero()};
  }
  return {-size.x(), Vec3<T>(-a.y(), a.x(), T(0)).normalized(), T(0), Vec3<T>::Zero()};
}

}  // namespace

namespace {

/// Distance of a point inside a polyhedron to the face that it leaves by.
template <class T>
SignedDistance<T> below_face(const Contact<T>& c, const Vec3<T>& point) {
  if (c.hull) {
    const ConvexHull::Face& face = c.hull->faces()[static_cast<std::size_t>(c.face)];
    const double beyond = face.normal.dot(point.template cast<double>()) - face.offset;
    return {T(beyond), face.normal.template cast<T>(), T(0), Vec3<T>::Zero()};
  }
  const int axis = c.face / 2;
  const T side = c.face % 2 == 0 ? T(1) : T(-1);
  return {side * point[axis] - c.size[axis], side * Vec3<T>::Unit(axis), T(0), Vec3<T>::Zero()};
}

}  // namespace

template <class T>
void share_stiffness(std::vector<ContactPoint<T>>& points) {
  const auto touching = [&](int body) {
    T count = T(0);
    for (const ContactPoint<T>& p : points)
      if (p.body == body && p.meets_plane()) count += p.kind == PointKind::kCorner ? T(0.5) : T(1);
    return count;
  };
  for (ContactPoint<T>& p : points) p.share = T(4) / std::max(T(4), touching(p.body));
}

namespace {

template <class T>
Mat3<T> rotation_of(const Kinematics<T>* k, int body) {
  return k ? k->rotation[body] : Mat3<T>(Mat3<T>::Identity());
}

/// What a distance in axes that are turned by `rotation` says of how the contact's surface bends.
template <class T>
void bend(const Mat3<T>& rotation, const SignedDistance<T>& d, Contact<T>& c) {
  c.bends = d.curvature > T(0);
  if (!c.bends) return;
  const Vec3<T> straight = rotation * d.straight;
  c.bending =
      d.curvature * (Mat3<T>::Identity() - c.normal * c.normal.transpose() - straight * straight.transpose());
}

/// `axis`: unit, of a's line.
template <class T>
Sliding<T> sliding_along(const Vec3<T>& axis, const Vec3<T>& across, const Vec3<T>& normal, T lever) {
  const T sine = across.dot(axis);
  return {true, across, normal.cross(axis) * (sine / (sine * sine + T(kParallel * kParallel))), lever};
}

/// A point of a against a shape of b.
template <class T>
void measure_point(const Kinematics<T>& a, const Kinematics<T>* b, Contact<T>& c) {
  const Mat3<T> rotation = rotation_of(b, c.body_b) * c.shape_pose.rotation.toRotationMatrix();
  const Vec3<T> origin = at(b, c.body_b, c.shape_pose.translation);
  SignedDistance<T> d;
  Vec3<T> across = Vec3<T>::Zero();
  c.sliding.slides = false;
  if (c.half_axis_a.isZero(T(0)) || is_polyhedron(c.shape)) {
    const Vec3<T> at = rotation.transpose() * (c.point - origin);
    d = signed_distance<T>(c.shape, c.size, at, c.hull);
    if (c.face >= 0 && d.distance < T(0)) d = below_face(c, at);
  } else {
    const Vec3<T> axis = a.rotation[c.body_a] * c.half_axis_a;
    T along = T(0);
    d = axis_distance<T>(c.size, c.shape == Shape::kCapsule ? c.size.z() : T(0),
                         rotation.transpose() * (c.point - origin), rotation.transpose() * axis, along,
                         across);
    c.point += along * axis;
    if (!across.isZero(T(0)))
      c.sliding = sliding_along<T>(axis.normalized(), rotation * across, rotation * d.normal,
                                   d.distance + c.size.x());
  }
  c.normal = rotation * d.normal;
  c.gap = d.distance - c.radius + c.slack + c.offset;
  bend(rotation, d, c);
}

/// A corner of b against a shape of a: the force acts where that is nearest.
template <class T>
void measure_corner(const Kinematics<T>& a, const Kinematics<T>* b, Contact<T>& c) {
  const Mat3<T> rotation = a.rotation[c.body_a] * c.shape_pose.rotation.toRotationMatrix();
  const Vec3<T> corner = at(b, c.body_b, c.local_b);
  const SignedDistance<T> d = signed_distance<T>(
      c.shape, c.size, rotation.transpose() * (corner - at(&a, c.body_a, c.shape_pose.translation)), c.hull);
  c.normal = -(rotation * d.normal);
  c.point = corner + d.distance * c.normal;
  c.gap = d.distance - c.radius + c.slack + c.offset;
  bend(rotation, d, c);
}

/// Two lines: their signed distance along what is square to both.
template <class T>
void measure_edges(const Kinematics<T>& a, const Kinematics<T>* b, Contact<T>& c) {
  const Vec3<T> axis_a = a.rotation[c.body_a] * c.half_axis_a,
                axis_b = rotation_of(b, c.body_b) * c.half_axis_b,
                apart = at(b, c.body_b, c.local_b) - c.point;
  const Vec3<T> across = c.side * axis_a.cross(axis_b);
  const T size = across.norm();
  c.sliding.slides = false;
  if (size > std::numeric_limits<T>::epsilon() * axis_a.norm() * axis_b.norm()) {
    c.normal = across / size;
    c.sliding = sliding_along<T>(axis_a.normalized(), c.normal.cross(axis_b).normalized(), c.normal,
                                 -c.normal.dot(apart));
  }
  // Where a solve turns them parallel the nearest point goes to infinity.
  c.point += std::clamp(nearest_along(axis_a, axis_b, apart)[0], T(-2), T(2)) * axis_a;
  c.gap = -c.normal.dot(apart) - c.radius + c.slack + c.offset;
  c.bends = false;
}

/// Two solids, from so deep on that contacts of their points and edges should have borne.
template <class T>
void measure_solids(const Kinematics<T>& a, const Kinematics<T>* b, Contact<T>& c) {
  const Collider& own = *c.solid_a;
  const Transform<T> body_a{Quat<T>(a.rotation[c.body_a]), a.origin[c.body_a]},
      body_b = b ? Transform<T>{Quat<T>(b->rotation[c.body_b]), b->origin[c.body_b]} : Transform<T>();
  const PlacedShape<T> of_a(own.shape, own.size.template cast<T>(), body_a * own.local.template cast<T>(),
                            T(1), own.hull),
      of_b(c.shape, c.size, body_b * c.shape_pose, T(1), c.hull);
  const SolidGap<T> gap = solid_gap<T>(of_a, of_b, c.before);
  c.normal = gap.normal;
  c.point = gap.point;
  c.gap = gap.distance + c.slack + c.offset;
  c.bends = false;
}

}  // namespace

template <class T>
void measure(const Kinematics<T>& a, const Kinematics<T>* b, Contact<T>& c) {
  c.point = at(&a, c.body_a, c.local_a);
  if (c.plane) {
    c.normal = Vec3<T>::UnitZ();
    c.gap = c.point.z() - c.plane_height - c.radius + c.slack + c.offset;
    c.bends = false;
  } else if (c.host) {
    const SignedDistance<double> d =
        c.host->distance(*c.host_origin + (c.point - c.shape_pose.translation).template cast<double>());
    c.normal = d.normal.template cast<T>();
    c.gap = T(d.distance) - c.radius + c.slack + c.offset;
    c.bends = false;
  } else if (c.meeting == Meeting::kPoint) {
    measure_point(a, b, c);
  } else if (c.meeting == Meeting::kCorner) {
    measure_corner(a, b, c);
  } else if (c.meeting == Meeting::kEdges) {
    measure_edges(a, b, c);
  } else {
    measure_solids(a, b, c);
  }
  c.material_point = at(&a, c.body_a, c.material_a);
  c.material_point_b = at(b, c.body_b, c.material_b);
  const Vec3<T> apart = c.material_point - c.material_point_b;  // zero when the step began
  for (int k = 0; k < 2; ++k) c.slip[k] = c.elastic_slip[k] + c.frame.col(k).dot(apart);
}

namespace {

/// Fixes the points that touch at `touch`, about the common origin, to their bodies.
template <class T>
void fix_material_points(const Kinematics<T>& a, const Kinematics<T>* b, const Vec3<T>& touch,
                         Contact<T>& c) {
  c.material_a = a.rotation[c.body_a].transpose() * (touch - a.origin[c.body_a]);
  c.material_b = b ? Vec3<T>(b->rotation[c.body_b].transpose() * (touch - b->origin[c.body_b])) : touch;
}

/// rad in a step; of less the chord falls short by a thousandth of the way.
constexpr double kRollsLittle = 0.1, kRollsFurthest = 2;

}  // namespace

template <class T>
void roll(const Kinematics<T>& a, const Kinematics<T>* b, const Vec3<T>& turn, Contact<T>& c) {
  const T angle = turn.norm();
  if (angle < T(kRollsLittle)) return;
  const T half = std::min(angle, T(kRollsFurthest)) / 2;
  const Vec3<T> arm = rotation_exp<T>(-half / angle * turn) * Vec3<T>(-c.radius * c.normal);
  fix_material_points<T>(a, b, c.point + half / portable::sin(half) * arm, c);
}

template <class T>
void begin_step(const Kinematics<T>& a, const Kinematics<T>* b, Contact<T>& c) {
  c.before.setZero();
  measure(a, b, c);
  if (c.meeting == Meeting::kSolids) c.before = c.normal;
  const Vec3<T> touch = c.point - (c.radius + c.distance() / 2) * c.normal;
  fix_material_points<T>(a, b, touch, c);
  c.frame = contact_frame<T>(c.normal);
  measure(a, b, c);
  c.start_gap = c.gap;
}

SINEW_CONTACT_INSTANCES(template, float)
SINEW_CONTACT_INSTANCES(template, double)

}  // namespace sinew
