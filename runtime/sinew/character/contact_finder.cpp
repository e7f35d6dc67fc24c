#include "sinew/character/contact_finder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sinew/character/contacts.h"
#include "sinew/character/nearby.h"
#include "sinew/effects/hull_distance.h"
#include "sinew/effects/polyhedron.h"
#include "sinew/optimizer/contact_rows.h"
#include "sinew/skeleton/hooks.h"

namespace sinew {
namespace {

/// m beyond what the present speed covers, from what stands still, and between two trees: a solve may move a
/// light limb far.
constexpr double kMargin = 0.2, kMarginBetween = 0.1;
constexpr double kFacesDown = 0.7, kOnFloor = 0.02;  ///< cosine and m: a face that a box stands on
constexpr double kBelowFloor = 1;                    ///< m, that such a box goes on
constexpr double kPasses = 1e-3;                     ///< m/s, at which something comes past a face at least
constexpr double kPiled =
    8;  ///< times the heaviest of those who touch: what a contact may have to bear of a pile
constexpr double kMostGripped =
    4;  ///< weights that a contact may have to bear, in friction by what is driven
constexpr double kSlides =
    20;  ///< what slips by as much less than it turns rolls, the more the less it slips
constexpr double kLeftToEnds =
    2e-3;  ///< m, that the axes of capsules that lie along each other leave to these
constexpr double kImpactDepth = 0.005;  ///< m, or half the thickness of what is met
/// m, where something is driven as a whole: it presses on whatever has stopped what strikes, and loads it.
constexpr double kImpactDepthDriven = 0.025;

/// Contact identity that survives from step to step.
std::uint64_t contact_id(int tree_a, int point, int tree_b, int shape) {
  return first_contact_id(tree_a) ^ (std::uint64_t(point + 1) << 32) ^ (std::uint64_t(tree_b + 1) << 16) ^
         std::uint64_t(shape + 1);
}

template <class T>
bool between_trees(const Contact<T>& c) {
  return c.tree_b >= 0;
}

}  // namespace

template <class T>
void ContactFinder<T>::reserve(const SolveCapacity& capacity, int obstacles) {
  near_.reserve(static_cast<std::size_t>(obstacles));
  contacts_.reserve(capacity.contacts);
  gaps_.reserve(capacity.contacts);
  capacity_ = static_cast<std::size_t>(capacity.contacts);
  bounds_.reserve(capacity.colliders);
  follows_.reserve(capacity.bodies);
  for (auto* v : {&first_bound_, &first_body_}) v->reserve(capacity.trees);
  depenetrating_.reserve(capacity.trees);
}

template <class T>
void ContactFinder<T>::bound(const CharacterState<T>& s, T h) {
  for (std::size_t c = 0; c < s.colliders.size(); ++c) {
    const int body = s.colliders[c].joint;
    Bound b;
    b.center = s.problem.kinematics.origin[body] + s.problem.kinematics.rotation[body] * s.bound_center[c];
    b.radius = s.bound_radius[c];
    const T arm = (b.center - s.problem.kinematics.center[body]).norm() + b.radius;
    b.reach = T(kMargin) * s.tree.scale.length +
              h * (s.history.velocity[body].norm() + s.history.rotation_rate[body].norm() * arm + T(5) * h);
    for (int i = body; i >= 0 && !b.moved; i = s.tree.parent[i])
      b.moved =
          s.tree.dof_count(i) > 0 && (s.problem.free[s.tree.first_dof[i]] || !s.deviation[i].on_animation);
    bounds_.push_back(b);
  }
}

template <class T>
Contact<T> ContactFinder<T>::contact_of(int n, const ContactPoint<T>& point) const {
  Contact<T> c;
  c.tree_a = n;
  c.body_a = point.body;
  c.local_a = point.local;
  c.half_axis_a = point.half_axis;
  c.radius = point.radius;
  c.restitution = point.restitution;
  c.stiffness = point.share * states_[n]->contact_stiffness(*world_, bears_);
  c.length_scale = states_[n]->tree.scale.length;
  c.speed_scale = states_[n]->tree.scale.time;
  return c;
}

template <class T>
Contact<T> ContactFinder<T>::contact_of(int n, const Collider& collider) const {
  Contact<T> c;
  c.tree_a = n;
  c.body_a = collider.joint;
  c.restitution = T(collider.restitution);
  c.length_scale = states_[n]->tree.scale.length;
  c.speed_scale = states_[n]->tree.scale.time;
  c.stiffness = states_[n]->contact_stiffness(*world_, bears_);
  return c;
}

/// See roll(). What slides turns about a point that is somewhere else; limbs never roll far, and with their
/// points chosen so falls take a fifth more passes.
template <class T>
void ContactFinder<T>::let_roll(Contact<T>& c) const {
  if (c.meeting != Meeting::kPoint || !(c.radius > T(0)) || states_[c.tree_a]->tree.bodies > 1) return;
  const CharacterState<T>&a = *states_[c.tree_a], *b = c.tree_b < 0 ? nullptr : states_[c.tree_b];
  const Vec3<T> touch = c.point - c.radius * c.normal;
  Vec3<T> spin = angular_velocity(a.history, c.body_a), slip = a.point_velocity(c.body_a, touch);
  if (b) {
    spin -= angular_velocity(b->history, c.body_b);
    slip -= b->point_velocity(c.body_b, touch);
  }
  spin -= c.normal.dot(spin) * c.normal;
  slip -= c.normal.dot(slip) * c.normal;
  const T rolls = 1 - T(kSlides) * slip.norm() / (c.radius * spin.norm());
  if (rolls > T(0)) roll<T>(a.problem.kinematics, b ? &b->problem.kinematics : nullptr, rolls * h_ * spin, c);
}

template <class T>
void ContactFinder<T>::add(Contact<T>& c, T reach) {
  const CharacterState<T>* b = c.tree_b < 0 ? nullptr : states_[c.tree_b];
  begin_step<T>(states_[c.tree_a]->problem.kinematics, b ? &b->problem.kinematics : nullptr, c);
  if (c.gap > reach) return;
  let_roll(c);
  if (c.meeting == Meeting::kSolids && c.gap < T(0) && crushes(c.tree_a, c.tree_b)) leave_to_others(c);
  allow_pressed(c);
  const T& most_gap = most_gap_[between_trees(c)];
  while (c.gap < most_gap && contacts_.size() >= most_)
    if (!reserve()) break;
  if (!(c.gap < most_gap) || contacts_.size() >= most_) {
    ++left_out_;
    return;
  }
  remember(c);
  SINEW_ASSERT(contacts_.size() < contacts_.capacity());
  contacts_.push_back(c);
}

/// Drops the further half of the contacts between trees, or, if there are none, of the static ones; further
/// ones are not taken any more. False where all are as near.
template <class T>
bool ContactFinder<T>::reserve() {
  const bool any_between = std::any_of(contacts_.begin(), contacts_.end(), between_trees<T>);
  T& most_gap = most_gap_[any_between];
  gaps_.clear();
  for (const Contact<T>& c : contacts_)
    if (between_trees(c) == any_between) gaps_.push_back(c.distance());
  if (gaps_.empty()) return false;
  const auto middle = gaps_.begin() + static_cast<std::ptrdiff_t>(gaps_.size() / 2);
  std::nth_element(gaps_.begin(), middle, gaps_.end());
  if (!(*std::min_element(gaps_.begin(), middle + 1) < *middle)) return false;
  most_gap = *middle;
  const auto further = [&](const Contact<T>& c) {
    return between_trees(c) == any_between && !(c.distance() < most_gap);
  };
  const auto kept = std::remove_if(contacts_.begin(), contacts_.end(), further);
  left_out_ += static_cast<int>(contacts_.end() - kept);
  contacts_.erase(kept, contacts_.end());
  return true;
}

namespace {

/// See ContactFinder::way_out(); a hull at `pose` in the box's axes.
template <class T>
int way_out_of_box(const Collider& convex, const Transform<T>& pose, const Vec3<T>& size) {
  const Polyhedron hull(
      PlacedShape<double>(convex.shape, convex.size, pose.template cast<double>(), 1, convex.hull));
  int best = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (int face = 0; face < 6; ++face) {
    const Vec3<double> inwards = (face % 2 ? 1 : -1) * Vec3<double>::Unit(face / 2);
    const double apart = -hull.support(inwards) - double(size[face / 2]);
    if (apart > most) most = apart, best = face;
  }
  return best;
}

}  // namespace

/// The face by which the points of a collider that are inside a box leave it (see Contact::face): the one
/// that parts the two best, as solids. Each by the nearest of its own, what has been pressed through a box
/// would hang in it for good, and a corner beside an edge leave by the face that the boxes do not touch with.
/// `pose` is about the common origin.
template <class T>
int ContactFinder<T>::way_out(int n, int collider, const Vec3<T>& size, const Transform<T>& pose) const {
  const Collider& own = states_[n]->colliders[collider];
  const Kinematics<T>& k = states_[n]->problem.kinematics;
  const Transform<T> body{Quat<T>(k.rotation[own.joint]), k.origin[own.joint]};
  const Transform<T> in_box = pose.inverse() * (body * own.local.template cast<T>());
  const Mat3<T> turned = in_box.rotation.toRotationMatrix();
  const Vec3<T> own_size = own.size.template cast<T>();
  Vec3<T> reach = Vec3<T>::Zero();
  if (own.shape == Shape::kBox)
    reach = turned.cwiseAbs() * own_size;
  else if (own.shape == Shape::kCapsule)
    reach = turned.col(2).cwiseAbs() * own_size.z();
  Eigen::Index axis = 0;
  if (own.hull) return way_out_of_box<T>(own, in_box, size);
  (in_box.translation.cwiseAbs() - size - reach).maxCoeff(&axis);
  return static_cast<int>(2 * axis) + (in_box.translation[axis] < T(0) ? 1 : 0);
}

namespace {

/// The face that a box stands on the floor with, a unit vector in its axes; zero where it does not.
template <class T>
Vec3<T> face_on_floor(const Transform<T>& pose, const Vec3<T>& size, T floor, T unit) {
  const Vec3<T> down = pose.rotation.conjugate() * Vec3<T>(0, 0, -1);
  Eigen::Index axis = 0;
  if (down.cwiseAbs().maxCoeff(&axis) < T(kFacesDown)) return Vec3<T>::Zero();
  const Vec3<T> face = std::copysign(T(1), down[axis]) * Vec3<T>::Unit(axis);
  const T height = (pose * Vec3<T>(size[axis] * face)).z() - floor;
  return height > T(kOnFloor) * unit ? Vec3<T>(Vec3<T>::Zero()) : face;
}

}  // namespace

/// A box that stands on the floor goes on below it: else what is pressed under its edge leaves by the face
/// that it stands on, into the floor. Not for what lies under that face, with its middle `other` (about the
/// common origin): the box stands on that, a thin plate say.
template <class T>
void ContactFinder<T>::go_on_below(T unit, const Vec3<T>& other, Met& box) const {
  if (!world_->ground) return;
  const Transform<T> pose = pose_of(box);
  const Vec3<T> face = face_on_floor<T>(pose, box.size, T(world_->ground_height - common_origin_.z()), unit);
  Eigen::Index axis = 0;
  if (!(face.cwiseAbs().maxCoeff(&axis) > T(0))) return;
  if ((pose.inverse() * other).dot(face) > box.size[axis]) return;
  box.local.translation += box.local.rotation * Vec3<T>(T(kBelowFloor) / 2 * unit * face);
  box.size[axis] += T(kBelowFloor) / 2 * unit;
}

/// The same of a hull; not by a face that it stands on the floor with, but for what lies under that. Where no
/// point of the collider is inside, way_in().
template <class T>
int ContactFinder<T>::way_out_of_hull(int n, int collider, const Met& met) const {
  const Transform<T> pose = pose_of(met);
  const Bound& bound = bounds_[first_bound_[n] + collider];
  const Transform<double> to_hull = pose.inverse().template cast<double>();
  const Vec3<double> middle = to_hull * bound.center.template cast<double>();
  if (hull_distance(*met.hull, middle).distance >= double(bound.radius)) return way_in(n, collider, met);
  const PlacedShape<T> own = placed(n, collider);
  const Polyhedron solid(own.template cast<double>());
  const T ground = T(world_->ground_height - common_origin_.z()), on_floor = T(kOnFloor) * own.unit;
  int best = -1;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < met.hull->faces().size(); ++f) {
    const ConvexHull::Face& face = met.hull->faces()[f];
    const Vec3<T> normal = pose.rotation * face.normal.template cast<T>();
    const int corner = met.hull->boundary(face)[0];
    const Vec3<T> place = pose * met.hull->corners()[static_cast<std::size_t>(corner)].template cast<T>();
    const bool stands = world_->ground && normal.z() < T(-kFacesDown) && place.z() - ground < on_floor;
    if (stands && !(face.normal.dot(middle) > face.offset)) continue;
    const Vec3<double> down = -normal.template cast<double>();
    const double apart = -solid.support(down) + down.dot(place.template cast<double>());
    if (apart > most) most = apart, best = static_cast<int>(f);
  }
  return best;
}

/// The face by which a collider comes into a box or hull that it is outside of, and leaves it again: of those
/// that it is beyond, the one that it passes last at its speed; −1 where the step does not take it as far as
/// the middle. Each of its points by the nearest, a foot that kicks a door would stick half way through it.
template <class T>
int ContactFinder<T>::way_in(int n, int collider, const Met& met) const {
  const CharacterState<T>& s = *states_[n];
  const int body = s.colliders[collider].joint;
  const Bound& bound = bounds_[first_bound_[n] + collider];
  Vec3<T> velocity = s.point_velocity(body, bound.center);
  if (met.tree >= 0) velocity -= states_[met.tree]->point_velocity(met.body, bound.center);
  const T fastest = velocity.norm() + angular_velocity(s.history, body).norm() * bound.radius;
  if (!(h_ * fastest > thinnest(met.shape, met.size))) return -1;
  const Polyhedron own(placed(n, collider).template cast<double>()),
      other(placed(met, s.tree.scale.length).template cast<double>());
  int last = -1;
  double latest = 0;
  for (std::size_t f = 0; f < other.normals().size(); ++f) {
    const Vec3<double>& normal = other.normals()[f];
    const double gap = -own.support(-normal) - own.radius() - other.offset(f);
    const double time = gap / std::max(-normal.dot(velocity.template cast<double>()), kPasses);
    if (time > latest) latest = time, last = static_cast<int>(f);
  }
  return last;
}

/// About the common origin.
template <class T>
Transform<T> ContactFinder<T>::pose_of(const Met& met) const {
  if (met.tree < 0) return met.local;
  const Kinematics<T>& k = states_[met.tree]->problem.kinematics;
  return Transform<T>{Quat<T>(k.rotation[met.body]), k.origin[met.body]} * met.local;
}

template <class T>
std::uint64_t ContactFinder<T>::id_of(int n, int point, const Met& met) const {
  return contact_id(indices_[n], point, met.tree < 0 ? -1 : indices_[met.tree], met.number);
}

template <class T>
Contact<T> ContactFinder<T>::contact_with(const Met& met, Contact<T> c, T friction) const {
  c.tree_b = met.tree;
  c.body_b = met.body;
  if (met.tree >= 0) {
    const CharacterState<T>& other = *states_[met.tree];
    c.stiffness = std::min(c.stiffness, other.contact_stiffness(*world_, bears_));
    c.length_scale = std::min(c.length_scale, other.tree.scale.length);
    c.speed_scale = std::min(c.speed_scale, other.tree.scale.time);
  }
  c.friction = std::sqrt(friction * met.friction);
  c.restitution = std::max(c.restitution, met.restitution);
  return c;
}

/// All of a collider of tree n that a shape may meet. `reach` is beyond what the two hold.
template <class T>
void ContactFinder<T>::meet(int n, int collider, Met met, T reach) {
  const Bound& bound = bounds_[first_bound_[n] + collider];
  int face = -1;
  if (met.shape == Shape::kBox) {
    const Transform<T> pose = pose_of(met);
    const Vec3<T> apart = pose.rotation.conjugate() * (bound.center - pose.translation);
    if (signed_distance<T>(Shape::kBox, met.size, apart).distance < bound.radius) {
      const T own = states_[n]->tree.scale.length;
      go_on_below(met.tree < 0 ? own : std::max(own, states_[met.tree]->tree.scale.length), bound.center,
                  met);
      face = way_out(n, collider, met.size, pose_of(met));
    } else {
      face = way_in(n, collider, met);
    }
  } else if (met.shape == Shape::kConvex) {
    face = way_out_of_hull(n, collider, met);
  }
  meet_points(n, collider, met, face, reach);
  const Shape own = states_[n]->colliders[collider].shape;
  const bool flat = is_polyhedron(met.shape), of_flat = is_polyhedron(own) && met.tree < 0;
  if (flat ? own != Shape::kSphere : of_flat && met.shape == Shape::kCapsule)
    meet_edges(n, collider, met, reach);
  if (own != Shape::kSphere && met.shape != Shape::kSphere && (flat || is_polyhedron(own)))
    meet_solids(n, collider, met, reach);
  if (met.tree < 0 && (flat ? own != Shape::kSphere : of_flat)) meet_corners(n, collider, met, reach);
}

/// The points of a collider against a shape.
template <class T>
void ContactFinder<T>::meet_points(int n, int collider, const Met& met, int face, T reach) {
  const CharacterState<T>& s = *states_[n];
  const bool along = lie_along(n, collider, met);
  const Transform<T> pose = along ? pose_of(met) : Transform<T>();
  // Of an end, whether it is beside what it lies along.
  const auto beside = [&](const ContactPoint<T>& p) {
    const Kinematics<T>& own = s.problem.kinematics;
    const Vec3<T> at = own.origin[p.body] + own.rotation[p.body] * p.local;
    return p.kind == PointKind::kTip && std::abs((pose.inverse() * at).z()) <= met.size.z();
  };
  for (int k = s.first_point[collider]; k < s.first_point[collider + 1]; ++k) {
    const ContactPoint<T>& point = s.points[k];
    // Two axes need to meet once only.
    const bool axis = point.kind == PointKind::kAxis;
    if ((along && !axis ? !beside(point) : !point.meets(met.shape)) || (met.second && axis)) continue;
    Contact<T> c = contact_with(met, contact_of(n, point), point.friction);
    if (along && axis) c.slack = T(kLeftToEnds) * c.length_scale;  // for what turns across it in the step
    c.shape = met.shape;
    c.size = met.size;
    c.hull = met.hull;
    c.shape_pose = met.local;
    c.face = face;
    c.id = id_of(n, k, met);
    add(c, reach);
  }
}

template <class T>
void ContactFinder<T>::meet_hosts(int n, int collider, std::span<const HostObstacle> hosts) {
  const CharacterState<T>& s = *states_[n];
  const Bound& b = bounds_[first_bound_[n] + collider];
  const Vec3<double> center = b.center.template cast<double>() + common_origin_;
  for (std::size_t h = 0; h < hosts.size(); ++h) {
    if (hosts[h].shape->distance(center).distance > double(b.radius + b.reach)) continue;
    for (int k = s.first_point[collider]; k < s.first_point[collider + 1]; ++k) {
      if (s.points[k].kind == PointKind::kAxis) continue;
      Contact<T> c = contact_of(n, s.points[k]);
      c.host = hosts[h].shape;
      c.host_origin = &common_origin_;
      c.friction = std::sqrt(s.points[k].friction * T(hosts[h].friction));
      c.restitution = std::max(c.restitution, T(hosts[h].restitution));
      c.id = contact_id(indices_[n], k, -1, kFirstHost + static_cast<int>(h));
      add(c, b.reach);
    }
  }
}

/// Which obstacles any collider of the nth state may reach.
template <class T>
void ContactFinder<T>::find_near(int n, const Surroundings& surroundings) {
  near_.clear();
  const std::span<const Bound> bounds =
      std::span(bounds_).subspan(first_bound_[n], states_[n]->colliders.size());
  if (surroundings.obstacles.empty() || bounds.empty()) return;
  Vec3<T> least = Vec3<T>::Constant(std::numeric_limits<T>::infinity()), most = -least;
  for (const Bound& b : bounds) {
    least = least.cwiseMin(b.center - Vec3<T>::Constant(b.radius + b.reach));
    most = most.cwiseMax(b.center + Vec3<T>::Constant(b.radius + b.reach));
  }
  const Vec3<double> middle = ((least + most) / 2).template cast<double>() + common_origin_;
  surroundings.grid->overlapping(middle, double((most - least).norm() / 2),
                                 [&](int obstacle) { near_.push_back(obstacle); });
  std::sort(near_.begin(), near_.end());
}

template <class T>
void ContactFinder<T>::meet_static(int n, const Surroundings& surroundings) {
  find_near(n, surroundings);
  std::erase_if(near_, [&](int o) { return driven_through(n, surroundings.obstacles[o]); });
  const CharacterState<T>& s = *states_[n];
  const T ground = T(world_->ground_height - common_origin_.z());
  for (std::size_t collider = 0; collider < s.colliders.size(); ++collider) {
    const Bound& b = bounds_[first_bound_[n] + static_cast<int>(collider)];
    if (b.moved && world_->ground && b.center.z() - b.radius - ground < b.reach)
      for (int k = s.first_point[collider]; k < s.first_point[collider + 1]; ++k) {
        if (!s.points[k].meets_plane()) continue;
        Contact<T> c = contact_of(n, s.points[k]);
        c.plane = true;
        c.plane_height = ground;
        c.friction = s.points[k].friction * T(world_->ground_friction);
        c.restitution = std::max(c.restitution, T(world_->ground_restitution));
        c.id = contact_id(indices_[n], k, -1, -1);
        add(c, b.reach);
      }
    meet_hosts(n, static_cast<int>(collider), surroundings.hosts);
    for (const int o : near_) {
      const Collider& obstacle = surroundings.obstacles[o];
      const Transform<T> pose = pose_of(obstacle);
      const Vec3<T> size = obstacle.size.template cast<T>();
      const Vec3<T> apart = pose.rotation.conjugate() * (b.center - pose.translation);
      if (signed_distance<T>(obstacle.shape, size, apart, obstacle.hull).distance > b.radius + b.reach)
        continue;
      Met met;
      met.shape = obstacle.shape;
      met.size = size;
      met.hull = obstacle.hull;
      met.local = pose;
      met.friction = T(obstacle.friction);
      met.restitution = T(obstacle.restitution);
      met.number = o;
      meet(n, static_cast<int>(collider), met, b.reach);
    }
  }
}

template <class T>
bool ContactFinder<T>::kept_apart(int n, int body, int m, int other) const {
  const auto is = [](int state, int b, int wanted_state, int wanted) {
    return state == wanted_state && (wanted < 0 || b == wanted);
  };
  const int first = indices_[n], second = indices_[m];
  return std::any_of(apart_.begin(), apart_.end(), [&](const BodyPair& p) {
    return (is(first, body, p.state_a, p.body_a) && is(second, other, p.state_b, p.body_b)) ||
           (is(first, body, p.state_b, p.body_b) && is(second, other, p.state_a, p.body_a));
  });
}

/// One collider of tree n against the shape of one of tree m.
template <class T>
void ContactFinder<T>::meet_collider(int n, int collider, int m, int other) {
  const Bound &a = bounds_[first_bound_[n] + collider], &b = bounds_[first_bound_[m] + other];
  const T units = states_[n]->tree.scale.length + states_[m]->tree.scale.length;
  const T reach = a.reach + b.reach - T(kMargin - kMarginBetween / 2) * units;
  const bool presses = a.moved || b.moved || (n != m && (states_[n]->limited || states_[m]->limited));
  if (!presses || (a.center - b.center).norm() - a.radius - b.radius > reach) return;
  const Collider& shape = states_[m]->colliders[other];
  if (kept_apart(n, states_[n]->colliders[collider].joint, m, shape.joint)) return;
  Met met;
  met.shape = shape.shape;
  met.size = shape.size.template cast<T>();
  met.hull = shape.hull;
  met.local = shape.local.template cast<T>();
  met.friction = T(shape.friction);
  met.restitution = T(shape.restitution);
  met.tree = m;
  met.body = shape.joint;
  met.number = other;
  met.second = m < n || (m == n && other < collider);
  meet(n, collider, met, reach);
}

template <class T>
void ContactFinder<T>::meet_tree(int n, int m) {
  const CharacterState<T>&s = *states_[n], &t = *states_[m];
  const int count = static_cast<int>(t.colliders.size());
  if (n != m && driven_through(n, m)) return;
  for (int c = 0; c < static_cast<int>(s.colliders.size()); ++c)
    for (int o = 0; o < count; ++o)
      if (n != m || s.may_touch[c * count + o]) meet_collider(n, c, m, o);
}

/// kg that forces from outside press down on a tree like.
template <class T>
T load_of(const CharacterState<T>& s, const Vec3<double>& gravity) {
  double pressed = 0;
  for (const ExternalForce<T>& f : s.forces) pressed += gravity.dot(f.force.template cast<double>());
  return pressed > 0 ? T(pressed / gravity.squaredNorm()) : T(0);
}

template <class T>
std::span<Contact<T>> ContactFinder<T>::find(const WorldSettings& world, const Surroundings& surroundings,
                                             std::span<CharacterState<T>* const> states,
                                             std::span<const int> indices,
                                             std::span<const LaggedForce<T>> lagged,
                                             const Vec3<double>& common_origin, T h) {
  world_ = &world;
  states_ = states;
  indices_ = indices;
  lagged_ = lagged;
  apart_ = surroundings.apart;
  common_origin_ = common_origin;
  h_ = h;
  // Of an oscillator that sinks as deep under its weight, whatever the weight.
  damping_time_ = T(2 * world.accuracy.contact_damping *
                    std::sqrt(world.accuracy.sink_depth / std::max(1.0, world.gravity.norm())));
  T heaviest = T(0);
  most_ = 0;
  most_sunk_ = std::numeric_limits<T>::infinity();
  impact_depth_ = T(kImpactDepth);
  for (const CharacterState<T>* s : states) {
    most_ += static_cast<std::size_t>(s->problem.capacity.contacts);
    if (s->root_is_kinematic() && s->tree.dofs == s->tree.dof_count(0)) {  // driven as a whole
      // It presses with whatever force it takes. With friction to match, what stands aslant between it and a
      // wall is jammed for good, and driven in until it comes out at the back.
      most_sunk_ = T(kMostGripped * world.accuracy.sink_depth);
      impact_depth_ = T(kImpactDepthDriven);
      continue;
    }
    heaviest = std::max(heaviest, T(s->total_mass) + load_of(*s, world.gravity));
  }
  bears_ = states.size() > 1 ? T(kPiled) * heaviest : heaviest;
  most_ = std::min(most_, capacity_);
  count_depenetrating();
  contacts_.clear();
  std::fill_n(most_gap_, 2, std::numeric_limits<T>::infinity());
  left_out_ = 0;
  bounds_.clear();
  follows_.clear();
  for (auto* v : {&first_bound_, &first_body_}) v->clear();
  const bool around = world.ground || !surroundings.obstacles.empty() || !surroundings.hosts.empty();
  if (!around && states.size() == 1 && !states[0]->has_self_collision()) return contacts_;
  for (CharacterState<T>* s : states) {
    first_bound_.push_back(static_cast<int>(bounds_.size()));
    bound(*s, h);
    find_followers(*s);
  }
  for (int n = 0; n < static_cast<int>(states.size()); ++n) {
    if (states[n]->settings.ground_contact) meet_static(n, surroundings);
    for (int m = 0; m < static_cast<int>(states.size()); ++m)
      if (m != n ? world.body_contact && states[n]->may_meet(*states[m]) : states[n]->has_self_collision())
        meet_tree(n, m);
  }
  begin_all();
  return contacts_;
}

double half_thickness_of(const Collider& obstacle, double floor, double unit) {
  if (obstacle.shape != Shape::kBox) return obstacle.size.x();
  const Vec3<double> face = face_on_floor<double>(obstacle.local, obstacle.size, floor, unit);
  const Vec3<double> size = obstacle.size + face.cwiseAbs() * kBelowFloor * unit;
  return size.minCoeff();
}

namespace {

template <class T>
std::unique_ptr<ContactSearch<T>> make_finder() {
  return std::make_unique<ContactFinder<T>>();
}

template <class T>
constexpr ContactTerm<T> kContacts{
    make_finder<T>,      look_around<T>,           is_in_the_way<T>,   ground_under<T>,
    load_props<T>,       ground_that_moves<T>,     append_moving<T>,   come_close<T>,
    swept_box<T>,        boxes_come_close<T>,      place_colliders<T>, predict_colliders<T>,
    touch_on_the_way<T>, append_contact_points<T>, share_stiffness<T>, measure<T>,
    is_internal_edge<T>};

}  // namespace

template <class T>
void Contacts<T>::declare(StepPlan<T>& plan) {
  plan.contact_rows = make_contact_rows<T>;
  plan.contacts = &kContacts<T>;
}

template class ContactFinder<float>;
template class ContactFinder<double>;
template struct Contacts<float>;
template struct Contacts<double>;

}  // namespace sinew
