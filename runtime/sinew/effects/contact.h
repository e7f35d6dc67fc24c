// Contact points against the floor, static obstacles and other bodies, with friction.
//
// A contact is a small sphere (or bare point) fixed to one body against a shape with a signed distance, or a
// pair of edges that cross (crossing_edges.h). Its
// energy is one-sided in the gap at the END of the step, ½k·gap² with a cubic start, so stiffness costs no
// stability. A surface is damped: its force is that of the gap a damping time τ later, f(gap + τ·gap'), with
// gap' = (gap₁ − gap₀)/h and never a pull. In a step that is the same law in a stretched gap, convex as
// before, and passive: for every step f·(gap₀ − gap₁) ≥ ½k(gap₁² − gap₀²). Without it impacts turn elastic
// as h → 0, and nothing converges. Friction is the smoothed Coulomb potential μ·λ·f₀(slip) with the normal
// force λ of the last step: refreshing λ within a step left 15 % of steps unconverged. The slip is that of
// the material points that touched when the step began; measured anywhere else the force is no gradient of
// the energy. It begins with what the step before left of it below the length of a stick (elastic slip, as of
// bristles: Simo & Laursen, "An augmented Lagrangian treatment of contact problems involving friction",
// 1992): what bears a load along the surface once stays where it is, instead of slipping a little for it in
// every step.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "sinew/effects/carried_force.h"
#include "sinew/residual/tree.h"
#include "sinew/skeleton/portable_math.h"

namespace sinew {

/// Distance of a point to a surface (m, negative inside), the outward unit normal there, and how it bends:
/// ∇²distance = curvature·(1 − normal·normalᵀ − straight·straightᵀ).
template <class T>
struct SignedDistance {
  T distance = T(0);                   ///< m
  Vec3<T> normal = Vec3<T>::UnitZ();   ///< unit, outwards
  T curvature = T(0);                  ///< 1/m; 0 over a face
  Vec3<T> straight = Vec3<T>::Zero();  ///< unit tangent along which the surface is straight, or zero
};

/// Sphere, capsule, box or the hull that is convex, in its own axes (see Collider::size).
template <class T>
SignedDistance<T> signed_distance(Shape shape, const Vec3<T>& size, const Vec3<T>& point,
                                  const ConvexHull* hull = nullptr);

/// What a contact point stands for, which decides what it can meet.
enum class PointKind : std::uint8_t {
  kTip,     ///< centre of a sphere, end of a capsule: meets planes and boxes
  kInner,   ///< between the ends of a long capsule: meets boxes, whose edges would slip between the ends
  kAxis,    ///< whole axis of a sphere or capsule: meets spheres and capsules at the nearest point
  kCorner,  ///< of a polyhedron: meets everything
};

/// A point of a body that may touch something.
template <class T>
struct ContactPoint {
  int body = 0;
  PointKind kind = PointKind::kTip;
  Vec3<T> local = Vec3<T>::Zero();      ///< centre, body axes
  Vec3<T> half_axis = Vec3<T>::Zero();  ///< kAxis: from the centre to one end
  T radius = T(0);                      ///< m
  T friction = T(0.8);
  T restitution = T(0);
  int collider = 0;  ///< that it belongs to, within its skeleton
  T share = T(1);    ///< of the stiffness: less where a body stands on many

  bool meets_plane() const { return kind == PointKind::kTip || kind == PointKind::kCorner; }
  bool meets(Shape shape) const {
    return kind == PointKind::kCorner || is_polyhedron(shape) != (kind == PointKind::kAxis);
  }
};

/// Appends the points of a collider, the `index`th of its skeleton; `unit`: Scale::length.
template <class T>
void append_contact_points(const Collider& collider, std::vector<ContactPoint<T>>& out, int index = 0,
                           double unit = 1);

/// A body sinks as deep on many points as on four: sets the shares of those that can touch a plane at once
/// (half of a box's corners), beyond four per body.
template <class T>
void share_stiffness(std::vector<ContactPoint<T>>& points);

/// m, of the corners of a box with such half extents, on a rig of so many times a human's size: one that
/// stands exactly above another box's edge stays on its face.
inline double box_rounding(const Vec3<double>& size, double unit) {
  return std::min(0.05 * size.minCoeff(), 0.003 * unit);
}

/// How far along two axes a and b, in parts of them, lie the nearest points of the lines p + s·a and q + t·b;
/// r = q − p. Not of parallel ones.
template <class T>
std::array<T, 2> nearest_along(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& r) {
  const T aa = a.squaredNorm(), ab = a.dot(b), bb = b.squaredNorm();
  const T determinant = std::max(aa * bb - ab * ab, std::numeric_limits<T>::epsilon() * aa * bb);
  return {(bb * a.dot(r) - ab * b.dot(r)) / determinant, (ab * a.dot(r) - aa * b.dot(r)) / determinant};
}

class StaticShape;

/// What of the two sides of a contact meets.
enum class Meeting : std::uint8_t {
  kPoint,   ///< a point of body a, or the nearest of an axis, meets a shape
  kCorner,  ///< a point of b meets a shape of body a, in whose axes shape_pose is then
  kEdges,   ///< a line of each; fixed when the step begins, and as if they had no ends
  kSolids,  ///< both as wholes: whatever is nearest at each pose (solid_gap.h)
};

/// How what strikes parts.
template <class T>
struct Bounce {
  T share = T(0);  ///< of the speed at which it closes
  T from = T(0);   ///< m/s; what closes more slowly does not part
};

/// Of the nearest points of two lines (or of a line and a point), which slide along them as these turn: the
/// normal tips with them, and the gap closes faster than it does at either end, the more so the nearer the
/// lines are to parallel. As a moves against b by v (of the contact point) and ω, the second derivative of
/// the gap is 2μw − lever·μ², with μ = ω·tipping and w = v·across.
template <class T>
struct Sliding {
  bool slides = false;
  Vec3<T> across = Vec3<T>::Zero();   ///< unit, world: what the normal tips along
  Vec3<T> tipping = Vec3<T>::Zero();  ///< world: by how much, per rad
  T lever = T(0);                     ///< m, from the line of b to that of a
};

/// One candidate contact. `tree_a` and `tree_b` index the trees of the solve; tree_b < 0 is the static world.
template <class T>
struct Contact {
  int tree_a = 0, body_a = 0;
  int tree_b = -1, body_b = -1;
  Meeting meeting = Meeting::kPoint;
  std::uint64_t id = 0;  ///< same pair of features in the next step: carries λ over
  Vec3<T> local_a = Vec3<T>::Zero();
  Vec3<T> half_axis_a =
      Vec3<T>::Zero();  ///< body axes; non-zero: the point slides to where the shape is nearest
  Vec3<T> local_b = Vec3<T>::Zero(), half_axis_b = Vec3<T>::Zero();  ///< kCorner, kEdges: of b
  const Collider* solid_a = nullptr;                                 ///< kSolids, kEdges
  Vec3<T> before = Vec3<T>::Zero();                                  ///< kSolids: see solid_gap()
  T slack = T(0);  ///< m, that they may lie in each other: what solids leave to others, and clips press
  T side = T(1);   ///< kEdges: see EdgePair
  T radius = T(0);
  Shape shape = Shape::kSphere;
  const StaticShape* host = nullptr;          ///< instead of a shape; shape_pose.translation then shifts it
  const Vec3<double>* host_origin = nullptr;  ///< the common origin in the host's world
  bool plane = false;                         ///< static half space z ≤ plane_height instead of a shape
  T plane_height = T(0);                      ///< from the common origin
  Transform<T> shape_pose;                    ///< shape → body_b (or → common origin when static)
  Vec3<T> size = Vec3<T>::Zero();
  const ConvexHull* hull = nullptr;  ///< of a convex shape
  int face = -1;  ///< of a polyhedron, that the point leaves it by (box: 2 axis + 1 for the side below); −1:
                  ///< by the nearest
  T length_scale = T(1);         ///< of the smaller of the two that touch, by a human's: see Scale
  T speed_scale = T(1);          ///< its root; of times too
  T stiffness = T(1e5);          ///< N/m
  T friction = T(0.8);           ///< μ
  T lagged_normal_force = T(0);  ///< λ, N
  T grip = T(0);                 ///< N, most that friction can do: μλ
  T lasting_last = T(0), lasting_before = T(0);  ///< N; see lasting(): of the last step and the one before
  T lasting_force = T(0);                        ///< N; at the end of this one
  T smooth_before = T(0);                        ///< N; what of λ no impulse was: see split()
  T smooth_force = T(0);                         ///< N; of the normal force at the end
  T expected_force = T(0);      ///< N, along the normal at the end: what a solve knows of it so far
  T restitution = T(0);         ///< of a bounce: impulse of the release by that of the compression
  T offset = T(0);              ///< m, added to the gap: stiffening a loaded contact keeps its force
  T depenetration_work = T(0);  ///< J, that it stores more because the offset shrank when the step began
  T came_back = T(0);           ///< m, by which it did: the surface moves at that pace
  bool fresh = true;            ///< bore nothing after the last step
  T start_gap = T(0);           ///< when the step began, m
  T stretch = T(1);             ///< 1 + τ/h: change of the damped gap by the gap
  T lag = T(0);                 ///< m; the damped gap where the gap is 0, ≥ 0
  T approach = T(0);            ///< closing speed then (fresh ones only), m/s
  bool bounced = false;         ///< struck and parted before the solve of this part
  // Fixed when the step begins
  Vec3<T> material_a = Vec3<T>::Zero(),
          material_b = Vec3<T>::Zero();  ///< body axes (static: from common origin)
  Mat3<T> frame = Mat3<T>::Identity();   ///< columns: two tangents, normal; see contact_frame()
  std::array<T, 2> elastic_slip{};       ///< m, along these tangents: what of the slip the step began with
  // At the present pose
  Vec3<T> point = Vec3<T>::Zero();  ///< centre, where the normal force acts
  Vec3<T> normal = Vec3<T>::UnitZ();
  Vec3<T> material_point = Vec3<T>::Zero(), material_point_b = Vec3<T>::Zero();
  T gap = T(0);
  T slip[2] = {T(0), T(0)};

  /// From a step of h seconds that begins at `start_gap` on, for a damping time in seconds; against a surface
  /// that comes back.
  void damp(T damping_time, T h) {
    stretch = T(1) + damping_time / h;
    lag = damping_time / h * std::max(-(start_gap + came_back), T(0));
  }
  /// m, between the shapes as they are.
  T distance() const { return gap - offset - slack; }
  /// gap + τ·gap', m: what the normal force is a function of. Above the gap where the contact opens.
  T damped_gap() const { return stretch * gap + lag; }
  /// m, see ContactLaw.
  T width() const { return T(5e-4) * length_scale; }
  /// Whether it bears or rubs.
  bool acts() const { return damped_gap() < T(0) || grip > T(0); }
  /// Puts side b elsewhere by so much in its axes (without a body, the world's), m.
  void shift_b(const Vec3<T>& by) { (meeting == Meeting::kPoint ? shape_pose.translation : local_b) += by; }

  bool bends = false;                 ///< the surface is curved at the contact
  Mat3<T> bending = Mat3<T>::Zero();  ///< ∇²distance, 1/m
  Sliding<T> sliding;
};

/// Normal energy of a gap (m) and its derivatives; `width` (m) is that of the cubic start: 0.5 mm of a
/// human's (fewer factorisations: 3.4 against 3.7 per step, solver-prototype table 4).
template <class T>
struct ContactLaw {
  static T energy(T k, T gap, T width) {
    const T p = -gap;
    if (p <= T(0)) return T(0);
    return p < width ? k * p * p * p / (6 * width) : k * (p * p / 2 - p * width / 2 + width * width / 6);
  }
  /// Normal force, ≥ 0.
  static T force(T k, T gap, T width) {
    const T p = -gap;
    if (p <= T(0)) return T(0);
    return p < width ? k * p * p / (2 * width) : k * (p - width / 2);
  }
  /// How deep a force sinks: the inverse of force(k, −depth).
  static T depth(T k, T force, T width) {
    return force < k * width / 2 ? std::sqrt(2 * width * force / k) : force / k + width / 2;
  }
  /// How deep is what stores an energy: the inverse of energy(k, −depth).
  static T depth_storing(T k, T energy, T width) {
    return energy < k * width * width / 6 ? portable::cbrt(6 * width * energy / k)
                                          : width / 2 + std::sqrt(2 * energy / k - width * width / 12);
  }
  static T curvature(T k, T gap, T width) {
    const T p = -gap;
    if (p <= T(0)) return T(0);
    return p < width ? k * p / width : k;
  }
};

/// Smoothed slip length f₀ and its derivatives: quadratic-like below `stick` metres per step, |slip| beyond;
/// C². Source: Li et al., "Incremental Potential Contact", 2020, equation (16).
template <class T>
struct FrictionLaw {
  static T energy(T s, T stick) {
    return s < stick ? -s * s * s / (3 * stick * stick) + s * s / stick + stick / 3 : s;
  }
  /// f₀'(s)/s, finite at 0.
  static T slope_over_slip(T s, T stick) { return s < stick ? (2 - s / stick) / stick : T(1) / s; }
  /// f₀''(s).
  static T curvature(T s, T stick) { return s < stick ? 2 * (1 - s / stick) / stick : T(0); }
};

/// What a contact stores at the present gap (J).
template <class T>
T stored_energy(const Contact<T>& c) {
  return ContactLaw<T>::energy(c.stiffness, c.gap, c.width());
}

/// Normal force at the present gap, ≥ 0 (N).
template <class T>
T normal_force(const Contact<T>& c) {
  return ContactLaw<T>::force(c.stiffness, c.damped_gap(), c.width());
}

/// Normal and friction potential of the step at the present gap and slip (J); `stick` (m per step): a
/// human's.
template <class T>
T contact_energy(const Contact<T>& c, T stick) {
  T energy = ContactLaw<T>::energy(c.stiffness, c.damped_gap(), c.width()) / c.stretch;
  if (c.grip > T(0))
    energy += c.grip * FrictionLaw<T>::energy(std::sqrt(c.slip[0] * c.slip[0] + c.slip[1] * c.slip[1]),
                                              c.speed_scale * stick);
  return energy;
}

/// Gradient of the normal energy by the contact point of body a (N, pointing into the obstacle).
template <class T>
Vec3<T> normal_gradient(const Contact<T>& c) {
  return -normal_force(c) * c.normal;
}

/// Gradient of the friction energy by the material point of body a (N).
template <class T>
Vec3<T> friction_gradient(const Contact<T>& c, T stick) {
  if (c.grip <= T(0)) return Vec3<T>::Zero();
  const T slip = std::sqrt(c.slip[0] * c.slip[0] + c.slip[1] * c.slip[1]);
  const T scale = c.grip * FrictionLaw<T>::slope_over_slip(slip, c.speed_scale * stick);
  return scale * (c.slip[0] * c.frame.col(0) + c.slip[1] * c.frame.col(1));
}

/// Tangents of a surface, and its normal: the same wherever the normal is.
template <class T>
Mat3<T> contact_frame(const Vec3<T>& normal) {
  const Vec3<T> tangent = normal.unitOrthogonal();
  Mat3<T> frame;
  frame << tangent, normal.cross(tangent), normal;
  return frame;
}

/// Of the way that a contact goes in a step below its stick: the rest rubs, a spring and a damper side by
/// side (Kelvin and Voigt). All of it rings: figures on stairs end 8 mm in them at 120 Hz.
constexpr double kElastic = 0.5;

/// The elastic slip that a contact begins the next step with, in the frame of its normal now, in parts of
/// `stick` (m per step, a human's). Its length is at most 1.
template <class T>
std::array<T, 2> elastic_share(const Contact<T>& c, T stick) {
  Vec3<T> slip = Vec3<T>::Zero();
  for (int k = 0; k < 2; ++k)
    slip += (c.elastic_slip[k] + T(kElastic) * (c.slip[k] - c.elastic_slip[k])) * c.frame.col(k);
  slip /= std::max(slip.norm(), c.speed_scale * stick);
  const Mat3<T> now = contact_frame<T>(c.normal);
  return {now.col(0).dot(slip), now.col(1).dot(slip)};
}

/// Of the forces at the end of a step, those that may be taken for smooth in time: all but leaps, where the
/// same contacts `last`; else as far as they have lasted.
template <class T>
void split(bool last, T share, Contact<T>& c) {
  const T now = normal_force(c);
  c.lasting_force = lasting(now, c.smooth_before, share);
  if (!last) {
    c.smooth_force = std::min(now, limited(c.lasting_force, c.lasting_last, c.lasting_before));
    return;
  }
  const T most = most_of_lasting(c.lasting_last, c.lasting_before);
  c.smooth_force = std::min(now, most);
  if (most > T(0)) c.lasting_force = std::min(c.lasting_force, most);
}

/// Re-measures gap, normal, points and slips at the present kinematics of the two bodies (`b` ignored when
/// static).
template <class T>
void measure(const Kinematics<T>& a, const Kinematics<T>* b, Contact<T>& contact);

/// Fixes material points and the tangent plane at the pose at which the step begins.
template <class T>
void begin_step(const Kinematics<T>& a, const Kinematics<T>* b, Contact<T>& contact);

/// Chooses, after begin_step(), the material points of what is round and turns by `turn` (rad, a rotation
/// vector across the normal, against b) in the step, so that who rolls does not slip. Over a step a point of
/// a body goes by a chord: that which touches when the step begins falls short of the arc by r(θ − sin θ), a
/// sixth of r θ³, and friction would brake every ball by it. The point which touches in the middle of the
/// step goes symmetrically, 2r sin ½θ; a little further out, by ½θ / sin ½θ, it goes as far as the arc.
template <class T>
void roll(const Kinematics<T>& a, const Kinematics<T>* b, const Vec3<T>& turn, Contact<T>& contact);

#define SINEW_CONTACT_INSTANCES(prefix, T)                                                               \
  prefix struct Contact<T>;                                                                              \
  prefix SignedDistance<T> signed_distance<T>(Shape, const Vec3<T>&, const Vec3<T>&, const ConvexHull*); \
  prefix void append_contact_points<T>(const Collider&, std::vector<ContactPoint<T>>&, int, double);     \
  prefix void share_stiffness<T>(std::vector<ContactPoint<T>>&);                                         \
  prefix void measure<T>(const Kinematics<T>&, const Kinematics<T>*, Contact<T>&);                       \
  prefix void begin_step<T>(const Kinematics<T>&, const Kinematics<T>*, Contact<T>&);                    \
  prefix void roll<T>(const Kinematics<T>&, const Kinematics<T>*, const Vec3<T>&, Contact<T>&);
SINEW_CONTACT_INSTANCES(extern template, float)
SINEW_CONTACT_INSTANCES(extern template, double)

}  // namespace sinew
