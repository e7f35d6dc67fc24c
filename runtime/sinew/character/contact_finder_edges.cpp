// Edges and corners in ContactFinder: what the signed distances of points do not see.
#include <cmath>

#include "sinew/character/contact_finder.h"
#include "sinew/skeleton/convex_hull.h"

namespace sinew {
namespace {

constexpr int kOtherSide = 0x8000;  ///< of contact identities: edges that are on the other side of each other
constexpr int kMostWithEdges = 127;  ///< colliders of a skeleton whose edges identities have room for
constexpr int kCornerNumber = kAxisNumber + 1, kSolidNumber = kAxisNumber + 2;
/// m, or of the thinnest half extent: what solids may lie in each other before they bear as wholes.
constexpr double kSlack = 3.5e-3, kSlackPart = 0.2;
constexpr double kBeyond =
    5e-4;  ///< m of a human, deeper than all that was found of a pair: see leave_to_others()
/// In place of a point in contact_id(): an edge or axis of a collider and an edge or corner of what it meets.
int feature(int own, int others, int collider) {
  return 0x8000 | own << 11 | others << 7 | collider;
}
/// The same where one is a hull, which has more than there is room for: scattered over all of it. Two of the
/// handful that touch share a number once in a thousand times, and then what the last step bore.
int feature_of_hull(int own, int others, int collider) {
  constexpr std::uint32_t kOwn = 2654435761u, kOthers = 2246822519u, kCollider = 3266489917u;
  const std::uint32_t mixed = std::uint32_t(own + 1) * kOwn ^ std::uint32_t(others + 1) * kOthers ^
                              std::uint32_t(collider) * kCollider;
  return 0x8000 | static_cast<int>((mixed ^ mixed >> 15) & 0x7fff);
}

}  // namespace

/// Where a collider is.
template <class T>
PlacedShape<T> ContactFinder<T>::placed(int n, int collider) const {
  const CharacterState<T>& s = *states_[n];
  const Collider& own = s.colliders[collider];
  const Kinematics<T>& k = s.problem.kinematics;
  const Transform<T> body{Quat<T>(k.rotation[own.joint]), k.origin[own.joint]};
  return {own.shape, own.size.template cast<T>(), body * own.local.template cast<T>(), s.tree.scale.length,
          own.hull};
}

/// And what it meets; `unit`: of what it meets.
template <class T>
PlacedShape<T> ContactFinder<T>::placed(const Met& met, T unit) const {
  return {met.shape, met.size, pose_of(met), met.tree < 0 ? unit : states_[met.tree]->tree.scale.length,
          met.hull};
}

namespace {

/// rad between the axes of capsules that lie along each other: ends of limbs then end a millimetre beside
/// where they would cross.
constexpr double kAlong = 0.07;

/// m that the ends of b are beside a, along a's axis; 0 unless they lie along each other.
template <class T>
T overlap_along(const PlacedShape<T>& a, const PlacedShape<T>& b) {
  const Vec3<T> axis = a.rotation.col(2), other = b.rotation.col(2);
  if (axis.cross(other).squaredNorm() > T(kAlong * kAlong)) return T(0);
  const T middle = axis.dot(b.center - a.center);
  return std::min(a.size.z(), middle + b.size.z()) - std::max(-a.size.z(), middle - b.size.z());
}

}  // namespace

/// Whether a collider and what it meets are capsules that lie along each other: the nearest points of their
/// axes leap from one end to the other as they rock, and no solve finds where they come to rest. Their ends
/// meet then, each what is beside it, and the axes only what lies deeper (kLeftToEnds). What is static has no
/// points: beside it both ends have to be.
template <class T>
bool ContactFinder<T>::lie_along(int n, int collider, const Met& met) const {
  const CharacterState<T>& s = *states_[n];
  const Collider& capsule = s.colliders[collider];
  if (met.shape != Shape::kCapsule || capsule.shape != Shape::kCapsule) return false;
  const Vec3<T> axis = s.problem.kinematics.rotation[capsule.joint] *
                       (capsule.local.rotation.template cast<T>() * Vec3<T>::UnitZ());
  Vec3<T> others = met.local.rotation * Vec3<T>::UnitZ();
  if (met.tree >= 0) others = states_[met.tree]->problem.kinematics.rotation[met.body] * others;
  if (axis.cross(others).squaredNorm() > T(2 * kAlong * kAlong)) return false;  // nearly all
  const PlacedShape<T> own = placed(n, collider), other = placed(met, s.tree.scale.length);
  // Either asks: the answer is the same to the last digit.
  const T beside = met.second ? overlap_along(other, own) : overlap_along(own, other);
  if (met.tree < 0) return beside > T(1.99) * own.size.z() && beside > T(0);
  return beside > std::min(own.size.x(), other.size.x());
}

/// The edges of a polyhedron across those of another or the axis of a capsule that cross now; of others that
/// come to cross within the step, meet_solids() knows.
template <class T>
void ContactFinder<T>::meet_edges(int n, int collider, const Met& met, T reach) {
  const CharacterState<T>& s = *states_[n];
  const Collider& own = s.colliders[collider];
  if ((met.second && is_polyhedron(own.shape)) || collider > kMostWithEdges) return;
  const Kinematics<T>& k = s.problem.kinematics;
  const T unit = s.tree.scale.length;
  const PlacedShape<T> a = placed(n, collider), b = placed(met, unit);
  const Kinematics<T>* other = met.tree < 0 ? nullptr : &states_[met.tree]->problem.kinematics;
  const Contact<T> made = contact_with(met, contact_of(n, own), T(own.friction));
  const auto contact = [&](const Edge<T>& of_a, const Edge<T>& of_b, const EdgePair<T>& pair) {
    Contact<T> c = made;
    c.meeting = Meeting::kEdges;
    c.local_a = k.rotation[own.joint].transpose() * (of_a.center - k.origin[own.joint]);
    c.half_axis_a = k.rotation[own.joint].transpose() * of_a.half_axis;
    c.local_b = of_b.center;
    c.half_axis_b = of_b.half_axis;
    if (other) {
      c.local_b = other->rotation[met.body].transpose() * (c.local_b - other->origin[met.body]);
      c.half_axis_b = other->rotation[met.body].transpose() * c.half_axis_b;
    }
    c.side = pair.side;
    c.radius = pair.radius;
    c.solid_a = &own;
    c.shape = met.shape;
    c.size = met.size;
    c.hull = met.hull;
    c.shape_pose = met.local;
    const auto number = own.hull || met.hull ? feature_of_hull : feature;
    c.id = id_of(n, number(of_a.number, of_b.number, collider), met) ^
           std::uint64_t(pair.side < T(0) ? kOtherSide : 0);
    return c;
  };
  const bool round_first = !is_polyhedron(b.shape);
  edges_.find(round_first ? b : a, round_first ? a : b);
  for (int p = 0; p < edges_.count; ++p) {
    EdgePair<T>& pair = edges_.pairs[p];
    if (round_first) std::swap(pair.a, pair.b);  // the normal turns round with the product of the axes
    Contact<T> c = contact(pair.a, pair.b, pair);
    add(c, reach);
  }
}

/// Whether one of two does not yield.
template <class T>
bool ContactFinder<T>::crushes(int n, int m) const {
  return m < 0 || states_[n]->root_is_kinematic() || states_[m]->root_is_kinematic();
}

/// What crushes a limb has many points of it as deep as the whole: they bear, and the solids as wholes only
/// what is deeper than all that was found of the pair. What yields comes free the sooner for both.
template <class T>
void ContactFinder<T>::leave_to_others(Contact<T>& solids) const {
  T depth = T(0);
  for (const Contact<T>& c : contacts_) {
    const bool same = c.tree_a == solids.tree_a && c.body_a == solids.body_a && c.tree_b == solids.tree_b &&
                      c.body_b == solids.body_b && (c.tree_b >= 0 || ((c.id ^ solids.id) & 0xffff) == 0);
    const bool turned = c.tree_a == solids.tree_b && c.body_a == solids.body_b && c.tree_b == solids.tree_a &&
                        c.body_b == solids.body_a;
    if (same || turned) depth = std::max(depth, -c.distance());
  }
  const T more = depth + T(kBeyond) * solids.length_scale - solids.slack;
  if (!(more > T(0))) return;
  solids.slack += more;
  solids.gap += more;
  solids.start_gap = solids.gap;
}

/// Two solids as wholes, for what the step leads to and nobody looked for. Once for a pair, see
/// leave_to_others().
template <class T>
void ContactFinder<T>::meet_solids(int n, int collider, const Met& met, T reach) {
  const CharacterState<T>& s = *states_[n];
  const Collider& own = s.colliders[collider];
  if (met.tree >= 0 && met.second != crushes(n, met.tree)) return;
  if (collider > kMostWithEdges) return;
  Contact<T> c = contact_with(met, contact_of(n, own), T(own.friction));
  c.meeting = Meeting::kSolids;
  c.solid_a = &own;
  c.shape = met.shape;
  c.size = met.size;
  c.hull = met.hull;
  c.shape_pose = met.local;
  c.slack = std::min(T(kSlack) * c.length_scale, T(kSlackPart) * std::min(T(thinnest(own.shape, own.size)),
                                                                          thinnest(met.shape, met.size)));
  c.id = id_of(n, feature(kSolidNumber, 0, collider), met);
  add(c, reach);
}

/// The corners of an obstacle, or the points of its axis, against a collider: those of what moves are points
/// of its own.
template <class T>
void ContactFinder<T>::meet_corners(int n, int collider, const Met& met, T reach) {
  const Bound& bound = bounds_[first_bound_[n] + collider];
  const Collider& own = states_[n]->colliders[collider];
  if (collider > kMostWithEdges) return;
  Contact<T> c = contact_with(met, contact_of(n, own), T(own.friction));
  c.meeting = Meeting::kCorner;
  c.shape = own.shape;
  c.shape_pose = own.local.template cast<T>();
  c.size = own.size.template cast<T>();
  c.hull = own.hull;
  const auto meet_point = [&](int number, const Vec3<T>& in_shape) {
    Contact<T> at_point = c;
    at_point.local_b = met.local * in_shape;
    if ((at_point.local_b - bound.center).norm() > bound.radius + c.radius + reach) return;
    at_point.id = id_of(n, (met.hull ? feature_of_hull : feature)(kCornerNumber, number, collider), met);
    add(at_point, reach);
  };
  if (!is_polyhedron(met.shape)) {
    c.radius = met.size.x();
    const T half = met.shape == Shape::kCapsule ? met.size.z() : T(0);
    // The nearest of the axis, and its ends: where they lie on a face, two bear.
    const Vec3<T> at = met.local.inverse() * bound.center;
    meet_point(0, {0, 0, half});
    if (!(half > T(0))) return;
    meet_point(1, {0, 0, -half});
    meet_point(2, {0, 0, std::clamp(at.z(), -half, half)});
    return;
  }
  if (own.shape == Shape::kBox) {  // as rounded as its own corners
    c.radius = T(box_rounding(own.size, double(states_[n]->tree.scale.length)));
    c.size.array() -= c.radius;
  }
  if (met.hull) {
    int number = 0;
    for (const Vec3<double>& corner : met.hull->corners()) meet_point(number++, corner.template cast<T>());
    return;
  }
  for (int corner = 0; corner < 8; ++corner)
    meet_point(corner, met.size.cwiseProduct(Vec3<T>(corner & 1 ? T(1) : T(-1), corner & 2 ? T(1) : T(-1),
                                                     corner & 4 ? T(1) : T(-1))));
}

#define SINEW_EDGE_INSTANCES(T)                                          \
  template PlacedShape<T> ContactFinder<T>::placed(int, int) const;      \
  template PlacedShape<T> ContactFinder<T>::placed(const Met&, T) const; \
  template bool ContactFinder<T>::lie_along(int, int, const Met&) const; \
  template void ContactFinder<T>::meet_edges(int, int, const Met&, T);   \
  template bool ContactFinder<T>::crushes(int, int) const;               \
  template void ContactFinder<T>::leave_to_others(Contact<T>&) const;    \
  template void ContactFinder<T>::meet_solids(int, int, const Met&, T);  \
  template void ContactFinder<T>::meet_corners(int, int, const Met&, T);
SINEW_EDGE_INSTANCES(float)
SINEW_EDGE_INSTANCES(double)

}  // namespace sinew
