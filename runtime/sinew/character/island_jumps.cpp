// What acts at once in IslandStepper: forces that are constant over a step and jump between steps, at its
// start and at its end (Jumps in bossak.h).
#include <algorithm>
#include <cmath>
#include <limits>

#include "sinew/character/island.h"
#include "sinew/character/return_to_animation.h"

namespace sinew {
namespace {

constexpr double kSaturated = 0.9999;                  ///< of a muscle's limit
constexpr double kHardlyTurns = 2e-3;                  ///< rad: where a step ends is where it began
constexpr double kTurnsLittle = 0.1, kTurnsAll = 0.3;  ///< of what constant forces do: its change in a step

/// Muscles, dry friction and damping: forces that answer what happens in a step at once.
template <class T>
bool answers(const JointRow<T>& row) {
  return row.kind == RowKind::kKink || row.kind == RowKind::kTone ||
         (row.kind == RowKind::kSpring && row.scalar == RowScalar::kFromStart);
}

/// Generalised forces [dof] of a tree's rows: of those that answer, and of the one-sided ones. Springs are
/// smooth.
template <class T>
void add_rows(const TreeProblem<T>& p, std::span<T> kinks, std::span<T> others) {
  for (const JointRow<T>& row : p.rows) {
    if (!answers(row) && row.kind != RowKind::kOneSided) continue;
    const T slope = row.slope(row.value);
    const std::span<T> out = answers(row) ? kinks : others;
    for (int a = 0; a < row.count; ++a) out[row.dof + a] -= slope * row.gradient[a];
  }
  for (const EllipsoidRow<T>& row : p.ellipsoids) {
    const Vec3<T> torque = row.gradient.transpose() * row.slope(row.value);
    for (int a = 0; a < 3; ++a) kinks[row.dof + a] -= torque[a];
  }
}

/// Whether a joint's muscles had strength to spare in the step: then it is where they shall bring it, and
/// moves as that does. Found from their torque, its speed would alternate about that from step to step. Of a
/// ball joint, about each of its axes.
template <class T>
bool holds(const CharacterState<T>& s, int dof) {
  if (!s.problem.law.present.muscles || s.problem.law.has_tone(dof)) return false;
  const int i = s.tree.dof_body[dof];
  const bool each = s.tree.type[i] == JointType::kBall && !s.problem.law.ellipsoidal[i];
  const auto load = s.load.begin();
  const auto first = load + (each ? dof : s.tree.first_dof[i]),
             end = load + (each ? dof + 1 : s.tree.first_dof[i + 1]);
  return s.joint_is_driven(i) && std::all_of(first, end, [](T x) { return x < T(kSaturated); });
}

/// Whether a row of those holds harder, the further it is off.
template <class T>
bool stiffens(const JointRow<T>& row) {
  return row.kind == RowKind::kSpring || (row.kind == RowKind::kTone && row.curvature(row.value) > T(0));
}

/// Speed that constant forces leave [dof], by how far they move a body in the step: 2; less where damping, or
/// a muscle with a tone, would turn the speed around.
template <class T>
void speed_shares(const TreeProblem<T>& p, bool damped, T h, std::span<T> out) {
  for (std::size_t dof = 0; dof < out.size(); ++dof)  // no rows where a joint is baked
    out[dof] = damped && !p.free[dof] ? h * p.law.damping[dof] : T(0);
  const T damps = h * h / constant_emphasis(p.prediction.weight, h);  // kg·m² by N·m/rad
  for (const JointRow<T>& row : p.rows)
    for (int a = 0; a < row.count && answers(row) && stiffens(row); ++a)
      out[row.dof + a] += damps * row.stiffness * row.gradient[a] * row.gradient[a];
  for (std::size_t dof = 0; dof < out.size(); ++dof) {
    const int i = static_cast<int>(dof);
    const T inertia = p.law.has_tone(i) ? p.law.tone[dof].inertia
                                        : p.tree->inertia_at_joint[p.tree->dof_body[dof]].trace() / 3;
    out[dof] = out[dof] > 2 * inertia ? 1 + 2 * inertia / out[dof] : T(2);
  }
}

/// Of the speed that constant forces leave: how much is that which they make where the step began. A half,
/// which is that at its middle; nothing where they turn with what they move (a stiff pendulum), for all at
/// the end damps.
template <class T>
T share_of_start(const Tree<T>& tree, std::span<const Vec3<T>> sped_start,
                 std::span<const Vec3<T>> spun_start, std::span<const Vec3<T>> sped_end,
                 std::span<const Vec3<T>> spun_end) {
  T changes = T(0), sum = T(0);
  for (int i = 0; i < tree.bodies; ++i) {
    const T mass = tree.mass[i], inertia = tree.inertia[i].trace() / 3;
    changes += mass * (sped_end[i] - sped_start[i]).squaredNorm() +
               inertia * (spun_end[i] - spun_start[i]).squaredNorm();
    sum += mass * (sped_end[i] + sped_start[i]).squaredNorm() +
           inertia * (spun_end[i] + spun_start[i]).squaredNorm();
  }
  const T change = 2 * std::sqrt(changes / std::max(sum, std::numeric_limits<T>::min()));
  return std::clamp((T(kTurnsAll) - change) / T(kTurnsAll - kTurnsLittle), T(0), T(1)) / 2;
}

/// rad: the furthest that a body has turned between two poses, if that is little.
template <class T>
T turn_between(const Kinematics<T>& a, const Kinematics<T>& b) {
  T furthest = T(0);
  for (std::size_t i = 0; i < a.rotation.size(); ++i)
    furthest = std::max(furthest, (b.rotation[i] - a.rotation[i]).squaredNorm());
  return std::sqrt(furthest / 2);
}

}  // namespace

/// Forces that are constant over the step, at a pose of a tree, into `constant_` and others of its rows into
/// `others_` [dof]: of muscles, friction, pushes and what leads joints. Uses the problem's wrenches.
template <class T>
void IslandStepper<T>::measure_constant(const CharacterState<T>& s, TreeProblem<T>& p, int tree,
                                        const Kinematics<T>& k) {
  bool any = false;
  const auto act = [&](int body, const Vec3<T>& local, const Vec3<T>& force) {
    if (!any) p.clear_wrenches();
    any = true;
    p.force[body] += force;
    p.moment[body] += Vec3<T>(k.origin[body] + k.rotation[body] * local).cross(force);
  };
  for (const ExternalForce<T>& push : p.pushes) act(push.body, push.local, push.force);
  for (const Contact<T>& c : contacts_) {
    if ((c.tree_a != tree && c.tree_b != tree) || !(c.grip > T(0))) continue;
    const Vec3<T> friction = -friction_gradient(c, settings_.stick);
    if (c.tree_a == tree) act(c.body_a, c.material_a, friction);
    if (c.tree_b == tree) act(c.body_b, c.material_b, Vec3<T>(-friction));
  }
  for (auto* v : {&constant_, &kinks_, &others_}) v->assign(s.tree.dofs, T(0));
  if (any) project_wrenches<T>(s.tree, k, p.force, p.moment, constant_);
  add_rows<T>(p, kinks_, others_);
  for (int dof = 0; dof < s.tree.dofs; ++dof) constant_[dof] += p.free[dof] ? kinks_[dof] : p.gradient[dof];
}

/// The speed that constant forces leave, times h, as where the step began.
template <class T>
void IslandStepper<T>::measure_constant_at_start(CharacterState<T>& s, int tree, T h) {
  TreeProblem<T>& p = s.problem;
  const bool acted_on = !s.passive() || !p.pushes.empty() ||
                        std::any_of(contacts_.begin(), contacts_.end(), [&](const Contact<T>& c) {
                          return c.grip > T(0) && (c.tree_a == tree || c.tree_b == tree);
                        });
  if (!(p.prediction.rho > T(0)) || !acted_on || is_locked(s)) return;  // what rubs within joints is weak
  forward_kinematics<T>(s.tree, p.start, p.common_origin, s.guessed);
  if (turn_between(s.guessed, p.kinematics) < T(kHardlyTurns)) return;
  measure_constant(s, p, tree, s.guessed);
  if (std::all_of(constant_.begin(), constant_.end(), [](T x) { return x == T(0); })) return;
  speed_share_.resize(s.tree.dofs);
  speed_shares<T>(p, settings_.plan->joints.damping, h, speed_share_);
  for (int dof = 0; dof < s.tree.dofs; ++dof) constant_[dof] *= speed_share_[dof] / p.prediction.weight;
  loose_.assign(s.tree.dofs, 1);
  TreeProblem<T>* const problem = &p;
  std::swap(p.kinematics, s.guessed);
  ends_.begin({&problem, 1}, loose_);
  ends_.respond(0, constant_, std::span(start_sped_).subspan(first_body_[tree], s.tree.bodies),
                std::span(start_spun_).subspan(first_body_[tree], s.tree.bodies));
  std::swap(p.kinematics, s.guessed);
  turned_far_[tree] = 1;
}

/// What has moved in this step and is not carried on: impulses of contacts and rows, and forces that are
/// constant over it, of muscles, pushes and what leads joints.
template <class T>
Jumps<T> IslandStepper<T>::measure_jumps(CharacterState<T>& s, int tree, T h) {
  TreeProblem<T>& p = s.problem;
  bool any = false;
  const auto act = [&](int body, const Vec3<T>& at, const Vec3<T>& force) {
    if (!any) p.clear_wrenches();
    any = true;
    p.force[body] += force;
    p.moment[body] += at.cross(force);
  };
  for (const Contact<T>& c : contacts_) {
    if (c.tree_a != tree && c.tree_b != tree) continue;
    const T left = normal_force(c) - c.smooth_force;
    const Vec3<T> normal = left * c.normal;
    if (left == T(0)) continue;
    if (c.tree_a == tree) act(c.body_a, c.point, normal);
    if (c.tree_b == tree) act(c.body_b, c.point, Vec3<T>(-normal));
  }
  for (const Coupling<T>* c : couplings_)
    for (const Stencil<T>& e : c->stencils) {
      const Vec3<T> left =
          c->closes_slowly ? Vec3<T>(stencil_pull(*c, e) - e.carried.smooth) : Vec3<T>::Zero();
      if (left.isZero(T(0))) continue;
      for (int k = 0; k < e.count; ++k)
        if (const CouplingNode<T>& node = c->nodes[e.node[k]]; node.tree == tree)
          act(node.body, node.point, Vec3<T>(-e.weight[k] * left));
    }
  jump_force_.assign(s.tree.dofs, T(0));
  if (any) project_wrenches<T>(s.tree, p.kinematics, p.force, p.moment, jump_force_);
  measure_constant(s, p, tree, p.kinematics);
  const T share = lasting_share(p.prediction.weight, h);
  bool bears = any;
  for (int dof = 0; dof < s.tree.dofs; ++dof) {
    if (p.free[dof]) {
      bears = bears || others_[dof] != T(0);
      const T now = others_[dof], lasts = lasting(now, s.smooth[dof], share);
      T smooth = limited(lasts, s.lasting[dof], s.lasting_before[dof]);
      smooth = std::clamp(smooth, std::min(now, T(0)), std::max(now, T(0)));
      // And what the solve has left unbalanced is no force that goes on.
      jump_force_[dof] += now - smooth + p.gradient[dof];
      s.smooth[dof] = smooth;
      s.lasting_before[dof] = s.lasting[dof];
      s.lasting[dof] = lasts;
    } else {
      s.smooth[dof] = s.lasting_before[dof] = s.lasting[dof] = T(0);
    }
  }
  const std::span<T> impulse = std::span(impulse_).subspan(first_dof_[tree], s.tree.dofs);
  bool any_constant = false;
  for (int dof = 0; dof < s.tree.dofs; ++dof) {
    any_constant = any_constant || constant_[dof] != T(0);
    jump_force_[dof] /= p.prediction.weight;
    constant_[dof] /= p.prediction.weight;
    impulse[dof] = jump_force_[dof] / h;
    jump_force_[dof] += constant_[dof];
  }
  if (!bears && !any_constant && p.prediction.rho > T(0)) {
    // No more than what the solve left unbalanced, below its tolerance: velocities go without what the scheme
    // makes of it, JᵀmJM⁻¹ being 1.
    const T made = p.prediction.momentum_step * p.prediction.weight;
    for (int dof = 0; dof < s.tree.dofs; ++dof) impulse[dof] -= made * jump_force_[dof];
    return {};
  }
  for (auto* v : {&moved_, &turned_}) v->resize(s.tree.bodies);
  ends_.respond(tree, jump_force_, moved_, turned_);
  if (!(p.prediction.rho > T(0))) {  // implicit Euler has all forces act at once
    std::fill(impulse.begin(), impulse.end(), T(0));
  } else if (!any_constant) {
    ends_.remove_floor_share(tree, impulse, 1 / h);
  } else {
    speed_share_.resize(s.tree.dofs);
    speed_shares<T>(p, settings_.plan->joints.damping, h, speed_share_);
    for (int dof = 0; dof < s.tree.dofs; ++dof) constant_[dof] *= speed_share_[dof];
    const T started = choose_start(s, tree);
    for (int dof = 0; dof < s.tree.dofs; ++dof) impulse[dof] += (1 - started) / h * constant_[dof];
    ends_.remove_floor_share(tree, impulse, T(0));  // its floor's share is missing in `moved_`, too
  }
  return {moved_, turned_};
}

/// Of the speed that the constant forces leave, times h and over the weight in `constant_`: how much is that
/// where the step began, which is left in `start_sped_` and `start_spun_` as a speed.
template <class T>
T IslandStepper<T>::choose_start(const CharacterState<T>& s, int tree) {
  if (!turned_far_[tree]) return T(0);
  const std::span<Vec3<T>> sped = std::span(start_sped_).subspan(first_body_[tree], s.tree.bodies),
                           spun = std::span(start_spun_).subspan(first_body_[tree], s.tree.bodies);
  for (auto* v : {&end_sped_, &end_spun_}) v->resize(s.tree.bodies);
  ends_.respond(tree, constant_, end_sped_, end_spun_);
  const T started = share_of_start<T>(s.tree, sped, spun, end_sped_, end_spun_);
  for (int i = 0; i < s.tree.bodies; ++i) {
    sped[i] *= started / settings_.h;
    spun[i] *= started / settings_.h;
  }
  return started;
}

/// Adds that to a tree's velocities.
template <class T>
void IslandStepper<T>::add_start(CharacterState<T>& s, int tree) {
  if (!turned_far_[tree]) return;
  for (int i = 0; i < s.tree.bodies; ++i) {
    const Mat3<T>& r = s.problem.kinematics.rotation[i];
    const int at = first_body_[tree] + i;
    s.history.velocity[i] += start_sped_[at];
    s.history.momentum[i] += r * (s.tree.inertia[i] * (r.transpose() * start_spun_[at]));
  }
}

/// How joints move at the end of the part that are driven: as the animation does, or on their return to it.
template <class T>
void IslandStepper<T>::measure_driven(const CharacterState<T>& s, int tree, T h) {
  const TreeProblem<T>& p = s.problem;
  driven_rates_.assign(s.tree.bodies, {});
  for (int i = 0; i < s.tree.bodies; ++i) {
    const int first = s.tree.first_dof[i], count = s.tree.dof_count(i), parent = s.tree.parent[i];
    int loose = 0;
    for (int k = 0; k < count; ++k) loose += ends_.loose(tree, first + k);
    if (count > 0 ? loose == count : parent < 0) continue;
    const Mat3<T> outer = parent < 0 ? Mat3<T>(Mat3<T>::Identity()) : p.kinematics.rotation[parent];
    Twist<T>& twist = driven_rates_[i];
    const auto lead = [&](const Mat3<T>& turned, const Vec3<T>& omega, const Vec3<T>& velocity) {
      twist.w = outer * (turned * omega);
      twist.v = outer * velocity - twist.w.cross(p.kinematics.origin[i]);
    };
    const Quat<T>& start = p.start[i].rotation;
    const Vec3<T> moved = p.local[i].translation - p.start[i].translation;
    if (s.baked[i]) {
      lead(start.toRotationMatrix(), rotation_log<T>(start.conjugate() * p.local[i].rotation) / h, moved / h);
      continue;
    }
    const JointJet<T>&jet = s.target[i], &before = s.last_target()[i];
    const Mat3<T> wanted = s.wanted[i].rotation.toRotationMatrix();
    if (part_end_ < T(1)) {
      const JointJet<T> within = animation_within<T>(before, jet, frame_, part_end_);
      lead(wanted, within.omega, within.velocity);
    } else {
      const Vec3<T> turned = rotation_log<T>(before.rotation.conjugate() * jet.rotation);
      const Vec3<T> leaving = jet.omega - frame_ * jet.alpha,
                    sliding = jet.velocity - frame_ * jet.acceleration;
      lead(wanted, rate_at_end<T>(turned, leaving, jet.omega, frame_),
           rate_at_end<T>(jet.translation - before.translation, sliding, jet.velocity, frame_));
    }
    const Deviation<T>& d = s.deviation[i];
    if (d.on_animation && loose == 0) continue;
    std::array<T, 6> rate = spin_of_rate<T>(s.tree.type[i], d.offset, d.rate);
    if (loose > 0) {  // a ball joint that holds about some of its axes: as it went
      twist = {};
      for (int k = 0; k < count; ++k) rate[k] = ends_.loose(tree, first + k) ? T(0) : s.rate[i][k];
    }
    if (s.tree.type[i] == JointType::kFree) {
      const Vec3<T> world = p.local[i].rotation * Vec3<T>(rate[3], rate[4], rate[5]);
      for (int a = 0; a < 3; ++a) rate[3 + a] = world[a];
    }
    for (int k = 0; k < count; ++k) {
      twist.w += rate[k] * p.kinematics.w[first + k];
      twist.v += rate[k] * p.kinematics.v[first + k];
    }
  }
}

/// The degrees of freedom whose speed the step has to find: unknowns that no muscles hold. False where that
/// is all of them.
template <class T>
bool IslandStepper<T>::choose_loose() {
  loose_.clear();
  bool driven = false;
  const bool by_itself = !(world_->detail.baked_decay > 0);  // what is baked; else it has the rate of its law
  for (const CharacterState<T>* s : states_)
    for (int dof = 0; dof < s->tree.dofs; ++dof) {
      loose_.push_back((s->problem.free[dof] || (by_itself && s->baked[s->tree.dof_body[dof]])) &&
                       !holds(*s, dof));
      driven = driven || !loose_.back();
    }
  return driven;
}

/// Takes what leads and pulls in a trial at rest out of the accelerations, as drop_constant().
template <class T>
void IslandStepper<T>::drop_trial(CharacterState<T>& s, int tree) {
  const TreeProblem<T>& p = s.problem;
  constant_.assign(s.tree.dofs, T(0));
  others_.assign(s.tree.dofs, T(0));
  add_rows<T>(p, constant_, others_);
  for (int dof = 0; dof < s.tree.dofs; ++dof)
    constant_[dof] += p.gradient[dof];  // nor is what is left unbalanced one
  drop_constant(s, tree, constant_);
}

#define SINEW_JUMP_INSTANCES(T)                                                                    \
  template void IslandStepper<T>::drop_trial(CharacterState<T>&, int);                             \
  template void IslandStepper<T>::measure_constant(const CharacterState<T>&, TreeProblem<T>&, int, \
                                                   const Kinematics<T>&);                          \
  template void IslandStepper<T>::measure_constant_at_start(CharacterState<T>&, int, T);           \
  template Jumps<T> IslandStepper<T>::measure_jumps(CharacterState<T>&, int, T);                   \
  template T IslandStepper<T>::choose_start(const CharacterState<T>&, int);                        \
  template void IslandStepper<T>::add_start(CharacterState<T>&, int);                              \
  template void IslandStepper<T>::measure_driven(const CharacterState<T>&, int, T);                \
  template bool IslandStepper<T>::choose_loose();
SINEW_JUMP_INSTANCES(float)
SINEW_JUMP_INSTANCES(double)

}  // namespace sinew
