// Elastic elements between material points: what loops, strands, cloth and soft tissue are made of.
//
// A node is a material point of a body (or of the world); an element's energy depends on where its nodes are
// at the END of the step, so stiffness costs no stability. "Just another Jacobian" (Wu): nodes move with the
// unknowns of their body's path, particles are bodies whose path is three translations. Two kinds of element:
//
//   stencil      ½ k (|Σ wᵢ xᵢ| − length)², Σ wᵢ = 0: a closed joint or a spring (1, −1), a rope that only
//                pulls, the bending of a strand (1, −2, 1) or of two triangles of cloth (four weights). The
//                force lies along Σ wᵢ xᵢ: momentum and angular momentum are kept to rounding.
//   tetrahedron  stable Neo-Hookean solid (Smith, de Goes & Kim, "Stable Neo-Hookean Flesh Simulation", 2018)
//
// Every element gives its exact energy and gradient and a positive semidefinite second derivative.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "sinew/effects/carried_force.h"
#include "sinew/residual/tree.h"

namespace sinew {

/// What a node or a loop is fixed to.
enum class AnchorKind : std::uint8_t { kWorld, kCharacter, kProp, kParticles };

/// A frame that rides on something: on a joint of a character, a prop, a particle (`joint` is then the node;
/// particles do not turn), or on nothing.
struct Anchor {
  AnchorKind kind = AnchorKind::kWorld;  ///< what it rides on
  int index = 0;                         ///< of the character, prop or particle body
  int joint = 0;                         ///< of the character; node of the particle body
  Transform<double> frame;               ///< in the joint's axes; of the world: in the world's
};

/// An anchor found: a tree of the world, one of its bodies, and the frame in that body's axes.
struct Place {
  int state = -1;           ///< number of the tree in the world; −1: the world itself
  int body = 0;             ///< of that tree
  Transform<double> frame;  ///< in the body's axes; of the world: in the world's
};

/// A material point.
template <class T>
struct CouplingNode {
  int state = -1;                             ///< number of its tree in the world; −1: fixed in the world
  int body = 0;                               ///< of that tree
  Vec3<T> local = Vec3<T>::Zero();            ///< body axes
  Vec3<double> place = Vec3<double>::Zero();  ///< m, world; of a fixed one
  int tree = -1;                              ///< of the solve; set by whoever steps
  // At the present pose:
  Vec3<T> point = Vec3<T>::Zero();     ///< from the common origin
  Vec3<T> gradient = Vec3<T>::Zero();  ///< of the energy by the point, N
};

/// ½ k (|Σ wᵢ xᵢ − offset + shift| − length + shortened)².
template <class T>
struct Stencil {
  int count = 2;                            ///< of nodes, 2 to 4
  int node[4] = {0, 0, 0, 0};               ///< the first `count` are read
  T weight[4] = {T(1), T(-1), T(0), T(0)};  ///< sum 0
  T stiffness = T(0);                       ///< N/m
  T length = T(0);                          ///< m
  T sinks = T(0);                           ///< m, that a weight pulls a loop apart: see close_slowly()
  bool only_pulls = false;                  ///< no energy while shorter than `length`
  T tight = T(0);                   ///< m, further apart is no loop for long: see tighten(); 0: a spring
  Vec3<T> shift = Vec3<T>::Zero();  ///< m, of a closed point: its multiplier by the stiffness
  T shortened = T(0);               ///< m, the same of a rod or rope
  /// What was open when a loop was closed, world axes, m; closed at 0.45 m/s.
  Vec3<T> offset = Vec3<T>::Zero();
  Vec3<T> offset_before = Vec3<T>::Zero();    ///< where the step began, which may be taken back
  Vec3<T> unclosed_offset = Vec3<T>::Zero();  ///< the offset before this step closed it further
  bool yields = false;                        ///< to a driven root, in this step: see close_slowly()
  CarriedForce<T> carried;                    ///< its pull, where a loop is rigid
  CarriedForce<T> carried_before;             ///< the same where the step began, which may be taken back
};

/// Four nodes; the rest shape enters through the gradients of its linear shape functions.
template <class T>
struct Tetrahedron {
  std::array<int, 4> node{};       ///< its corners
  std::array<Vec3<T>, 4> slope{};  ///< 1/m; the deformation gradient is F = Σ xᵢ slopeᵢᵀ
  T volume = T(0);                 ///< m³, at rest
  T mu = T(0);                     ///< Pa: the paper's μ, see set_material
  T lame = T(0);                   ///< Pa: the paper's λ
};

/// Second derivative of an energy by four points, see tetrahedron_curvature().
template <class T>
using TetrahedronHessian = Eigen::Matrix<T, 12, 12>;

/// Elements that live and die together: one loop, one strand, one piece of cloth or tissue.
template <class T>
struct Coupling {
  std::vector<CouplingNode<T>> nodes;      ///< that its elements name by index
  std::vector<Stencil<T>> stencils;        ///< springs, bends, closed points
  std::vector<Tetrahedron<T>> tetrahedra;  ///< of soft tissue
  bool active = true;                      ///< false: an open loop, which does nothing
  bool closes_slowly = false;              ///< stencils that begin open close at a limited speed (loops)
  bool strained = false;  ///< one who is tied has a driven root, and limbs: see close_slowly()
  bool driven = false;    ///< in this step: its velocities are those of closing, too
  double weight = 0;      ///< N, that it is as stiff as to bear: see bear(); 0: any
  T length_scale = T(1);  ///< of what it ties, by a human's: see Scale
  T speed_scale = T(1);   ///< the same of speeds
  double energy = 0;      ///< J, when last measured

  /// Set-up: the heaviest of all that hangs together by couplings weighs so much, N. What is tight gives as
  /// little under that as it did under less, and springs are torn by as many times more.
  void bear(double heaviest) {
    if (!(weight > 0) || !(heaviest > 0)) return;
    const T share = T(heaviest / weight);
    for (Stencil<T>& e : stencils) (e.tight > T(0) ? e.stiffness : e.sinks) *= share;
    weight = heaviest;
  }
  /// Whether something that began open is still being closed: that does work.
  bool closes() const {
    return std::any_of(stencils.begin(), stencils.end(),
                       [](const Stencil<T>& e) { return !e.offset.isZero(T(0)); });
  }
};

/// Rest shape of a tetrahedron from four corners (m). False where it has no volume or is inside out.
bool set_rest_shape(const Vec3<double> corners[4], Tetrahedron<double>& out);
/// Material from Young's modulus (Pa) and Poisson's ratio (0 … below ½), so that small strains are Hooke's.
void set_material(double young, double poisson, Tetrahedron<double>& out);

/// Σ wᵢ xᵢ at the nodes' present points.
template <class T>
Vec3<T> reach(const Coupling<T>& c, const Stencil<T>& e) {
  // Relative to the first node, since the weights add up to zero: points far away keep their digits.
  const Vec3<T>& base = c.nodes[e.node[0]].point;
  Vec3<T> sum = Vec3<T>::Zero();
  for (int i = 1; i < e.count; ++i) sum += e.weight[i] * (c.nodes[e.node[i]].point - base);
  return sum;
}

/// Gradient of a stencil's energy by Σ wᵢ xᵢ, N, at the nodes' present points.
template <class T>
Vec3<T> stencil_pull(const Coupling<T>& c, const Stencil<T>& e) {
  const Vec3<T> s = reach(c, e) - e.offset + e.shift;
  const T size = s.norm(), stretch = size - (e.length - e.shortened);
  if (size <= T(0) || (e.only_pulls && stretch <= T(0))) return Vec3<T>::Zero();
  return (e.stiffness * stretch / size) * s;
}

/// m, by which a rigid stencil is apart at the nodes' present points: what it stores is ½ k of the square.
template <class T>
Vec3<T> apart(const Coupling<T>& c, const Stencil<T>& e) {
  const Vec3<T> s = reach(c, e) - e.offset;
  const T size = s.norm();
  if (size <= e.length && (e.only_pulls || size <= T(0))) return Vec3<T>::Zero();
  return ((size - e.length) / size) * s;
}

/// Energy (J) of all elements at the nodes' present points, with that of multipliers, which is no store; what
/// is stored is kept in `energy`. Every node's gradient is overwritten.
template <class T>
double measure_elements(Coupling<T>& coupling);

/// Second derivative by Σ wᵢ xᵢ, N/m, without what makes it indefinite: node pair (i, j) sees wᵢwⱼ times it.
template <class T>
Mat3<T> stencil_curvature(const Coupling<T>& coupling, const Stencil<T>& stencil);
/// Its symmetric root, √(N/m).
template <class T>
Mat3<T> stencil_root(const Coupling<T>& coupling, const Stencil<T>& stencil);

/// Second derivative by the four points (x₀, y₀, z₀, x₁, …), N/m, negative eigenvalues cut off (analytic
/// eigensystem of the paper).
template <class T>
TetrahedronHessian<T> tetrahedron_curvature(const Coupling<T>& coupling, const Tetrahedron<T>& element);

constexpr double kClosingSpeed = 0.45;  ///< m/s at which an open loop closes, as contacts depenetrate

/// m/s: how fast what is still open of an element closes; of a loop's points the furthest does.
template <class T>
Vec3<T> closing_velocity(const Coupling<T>& c, const Stencil<T>& e) {
  T furthest = T(0);
  for (const Stencil<T>& other : c.stencils) furthest = std::max(furthest, other.offset.norm());
  return furthest > T(0) ? Vec3<T>(e.offset * (-T(kClosingSpeed) * c.speed_scale / furthest))
                         : Vec3<T>(Vec3<T>::Zero());
}

/// Lets what began open come nearer by h seconds, the furthest of a loop's points at kClosingSpeed; what was
/// torn apart from outside (a cut, a teleport) begins anew. A driven root may take a limb further than what
/// that is tied to lets it: the loop yields, beyond what ten weights pull it apart, and closes with no more
/// than these. Call at the start of a part of a step, at the pose there.
template <class T>
void close_slowly(T h, Coupling<T>& coupling);

/// Method of multipliers (Hestenes 1969): where a solve left a loop further apart than is `tight`, it is
/// pulled by what that is too much as well, in the same step and by no more than closes it so far. False: all
/// are tight. A spring of a hundredth of the stretch would do the same at a hundredth of the digits.
template <class T>
bool tighten(Coupling<T>& coupling);

#define SINEW_COUPLING_INSTANCES(prefix, T)                                                         \
  prefix double measure_elements<T>(Coupling<T>&);                                                  \
  prefix Mat3<T> stencil_curvature<T>(const Coupling<T>&, const Stencil<T>&);                       \
  prefix Mat3<T> stencil_root<T>(const Coupling<T>&, const Stencil<T>&);                            \
  prefix TetrahedronHessian<T> tetrahedron_curvature<T>(const Coupling<T>&, const Tetrahedron<T>&); \
  prefix bool tighten<T>(Coupling<T>&);                                                             \
  prefix void close_slowly<T>(T, Coupling<T>&);
SINEW_COUPLING_INSTANCES(extern template, float)
SINEW_COUPLING_INSTANCES(extern template, double)

}  // namespace sinew
