// Bossak's scheme in IslandStepper: what a step predicts, and the motion that it leaves (bossak.h).
#include <algorithm>
#include <cmath>
#include <limits>

#include "sinew/character/island.h"
#include "sinew/character/touch_digest.h"
#include "sinew/character/unknowns.h"
#include "sinew/character/way_back.h"

namespace sinew {
namespace {

/// That a contact's force would take to do what it does to velocities at most: one that has hardly begun to
/// bear is no wall yet. Falls keep as much energy with 2 as without a bound, and less with a half.
constexpr double kMostSteps = 2;
constexpr double kSaturated = 0.9999;                  ///< of a muscle's limit
constexpr double kHardlyTurns = 2e-3;                  ///< rad: where a step ends is where it began
constexpr double kTurnsLittle = 0.1, kTurnsAll = 0.3;  ///< of what constant forces do: its change in a step

/// Muscles, dry friction and damping: forces that answer what happens in a step at once.
template <class T>
bool answers(const JointRow<T>& row) {
  return row.kind == RowKind::kKink || (row.kind == RowKind::kSpring && row.scalar == RowScalar::kFromStart);
}

template <class T>
void clear_wrenches(TreeProblem<T>& p) {
  std::fill(p.force.begin(), p.force.end(), Vec3<T>(Vec3<T>::Zero()));
  std::fill(p.moment.begin(), p.moment.end(), Vec3<T>(Vec3<T>::Zero()));
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
  if (!s.problem.law.present.muscles) return false;
  const int i = s.tree.dof_body[dof];
  const bool each = s.tree.type[i] == JointType::kBall && !s.problem.law.ellipsoidal[i];
  const auto load = s.load.begin();
  const auto first = load + (each ? dof : s.tree.first_dof[i]),
             end = load + (each ? dof + 1 : s.tree.first_dof[i + 1]);
  return s.joint_is_driven(i) && std::all_of(first, end, [](T x) { return x < T(kSaturated); });
}

/// Speed that constant forces leave [dof], by how far they move a body in the step: 2; less where damping
/// would turn the speed around.
template <class T>
void speed_shares(const TreeProblem<T>& p, bool damped, T h, std::span<T> out) {
  for (std::size_t dof = 0; dof < out.size(); ++dof)  // no rows where a joint is baked
    out[dof] = damped && !p.free[dof] ? h * p.law.damping[dof] : T(0);
  const T damps = h * h / constant_emphasis(p.prediction.weight, h);  // kg·m² by N·m/rad
  for (const JointRow<T>& row : p.rows)
    for (int a = 0; a < row.count && row.kind == RowKind::kSpring && answers(row); ++a)
      out[row.dof + a] += damps * row.stiffness * row.gradient[a] * row.gradient[a];
  for (std::size_t dof = 0; dof < out.size(); ++dof) {
    const T inertia = p.tree->inertia_at_joint[p.tree->dof_body[dof]].trace() / 3;
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

/// rad/s and m/s of a joint's child against its parent, in the child's and the parent's axes.
template <class T>
Vec3<T> rate_at_end(const Vec3<T>& moved, const Vec3<T>& leaving, const Vec3<T>& arriving, T h) {
  const Vec3<T> mean = moved / h;
  return are_foreign(mean, leaving, arriving) ? mean : arriving;
}

}  // namespace

/// The set that each tree belongs to: those that may touch in this step, or are tied. Numbered by their first
/// trees.
template <class T>
void IslandStepper<T>::find_sets() {
  const int count = static_cast<int>(states_.size());
  set_.resize(count);
  for (int n = 0; n < count; ++n) set_[n] = n;
  const auto first_of = [&](int n) {
    while (set_[n] != n) n = set_[n];
    return n;
  };
  const auto join = [&](int a, int b) {
    a = first_of(a), b = first_of(b);
    set_[std::max(a, b)] = std::min(a, b);
  };
  for (const Contact<T>& c : contacts_)
    if (c.tree_b >= 0) join(c.tree_a, c.tree_b);
  if (!couplings_.empty())
    for (int n = 1; n < count; ++n) join(0, n);
  for (int n = 0; n < count; ++n) set_[n] = first_of(n);
}

/// Targets of Bossak's scheme, with one spectral radius for all that may touch: contact forces are equal and
/// opposite in the momentum that they give only then.
template <class T>
void IslandStepper<T>::predict_all(T h) {
  find_sets();
  driven_.assign(states_.size(), 0);
  radius_.assign(states_.size(), T(1));
  for (std::size_t n = 0; n < states_.size(); ++n)
    if (!states_[n]->limp() || !couplings_.empty()) driven_[set_[n]] = 1;
  for (std::size_t n = 0; n < states_.size(); ++n) {
    T& radius = radius_[set_[n]];
    radius = std::min(radius, spectral_radius<T>(largest_turn<T>(states_[n]->tree, states_[n]->history, h),
                                                 driven_[set_[n]] != 0));
  }
  number_bodies();
  for (std::size_t n = 0; n < states_.size(); ++n) {
    CharacterState<T>& s = *states_[n];
    TreeProblem<T>& p = s.problem;
    predict_bossak<T>(s.tree, s.history, strike_of(n), radius_[set_[n]], h, settings_.common_origin,
                      p.prediction);
    if (s.pushed()) write_pushes(s, constant_emphasis(p.prediction.weight, h));
  }
}

/// The same of implicit Euler: for a restart, and for a first step whose accelerations could not be found.
template <class T>
void IslandStepper<T>::predict_euler_all(T h) {
  for (CharacterState<T>* s : states_) {
    TreeProblem<T>& p = s->problem;
    predict_euler<T>(s->tree, s->history, h, settings_.common_origin, p.prediction);
    if (s->pushed()) write_pushes(*s, T(1));
  }
}

/// Impulses that strike change velocities where the bodies are, before the step: over the step they would act
/// on what has moved by then, and on which they have more effect, and on muscles that have the whole step to
/// resist. Muscles lead what was struck back; it begins at its new speed, while what is limp moves as under
/// the constant force that the impulse is the mean of: `velocity` and `momentum` [body] are what that leaves
/// out.
template <class T>
void IslandStepper<T>::strike(CharacterState<T>& s, std::span<Vec3<T>> velocity,
                              std::span<Vec3<T>> momentum) {
  TreeProblem<T>& p = s.problem;
  const Vec3<T> origin = s.floats ? s.local[0].translation : Vec3<T>(Vec3<T>::Zero());
  forward_kinematics<T>(s.tree, std::span<const Transform<T>>(s.local).first(s.tree.bodies), origin,
                        p.kinematics);
  clear_wrenches(p);
  for (const ExternalForce<T>& impulse : s.impulses) {
    const Vec3<T> at =
        p.kinematics.origin[impulse.body] + p.kinematics.rotation[impulse.body] * impulse.local;
    p.force[impulse.body] += impulse.force;
    p.moment[impulse.body] += at.cross(impulse.force);
  }
  jump_force_.assign(s.tree.dofs, T(0));
  project_wrenches<T>(s.tree, p.kinematics, p.force, p.moment, jump_force_);
  loose_.assign(s.tree.dofs, 1);
  const bool limp = s.limp();
  for (int dof = 0; dof < s.tree.dofs && !limp; ++dof) {
    const bool led = s.root_is_kinematic() && s.tree.type[0] == JointType::kFree && dof < s.tree.first_dof[1];
    loose_[dof] = !led && std::isfinite(p.law.torque_minus[dof]) && std::isfinite(p.law.torque_plus[dof]);
  }
  TreeProblem<T>* const struck = &p;
  ends_.begin({&struck, 1}, loose_);
  turned_.resize(s.tree.bodies);
  ends_.respond(0, jump_force_, velocity, turned_);
  for (int i = 0; i < s.tree.bodies; ++i) {
    const Mat3<T>& r = p.kinematics.rotation[i];
    momentum[i] = r * (s.tree.inertia[i] * (r.transpose() * turned_[i]));
    s.history.velocity[i] += velocity[i];
    s.history.momentum[i] += momentum[i];
    s.history.rotation_rate[i] += skew<T>(turned_[i]) * r;
    velocity[i] /= 2;  // they act all along the step
    momentum[i] /= 2;
  }
  if (limp) return;
  jumps_.resize(s.tree.bodies);
  ends_.answered(0, jumps_);
  for (int i = 0; i < s.tree.bodies; ++i) {
    Deviation<T>& d = s.deviation[i];
    const std::array<T, 6> jump = rate_of_spin<T>(s.tree.type[i], d.offset, jumps_[i]);
    for (int k = 0; k < s.tree.dof_count(i); ++k) {
      d.rate[k] += jump[k];
      d.on_animation = d.on_animation && jumps_[i][k] == T(0);
    }
  }
  s.settle_deviations();
  std::fill_n(velocity.begin(), s.tree.bodies, Vec3<T>(Vec3<T>::Zero()));
  std::fill_n(momentum.begin(), s.tree.bodies, Vec3<T>(Vec3<T>::Zero()));
}

/// The same of all trees.
template <class T>
void IslandStepper<T>::strike_all() {
  const auto struck = [&](const CharacterState<T>* s) { return s->is_struck(return_time()); };
  for (auto* v : {&struck_velocity_, &struck_momentum_}) v->clear();
  if (std::none_of(states_.begin(), states_.end(), struck)) return;
  std::size_t body = 0;
  for (CharacterState<T>* s : states_) {
    for (auto* v : {&struck_velocity_, &struck_momentum_}) v->resize(body + s->tree.bodies, Vec3<T>::Zero());
    if (struck(s))
      strike(*s, std::span(struck_velocity_).subspan(body), std::span(struck_momentum_).subspan(body));
    body += s->tree.bodies;
  }
}

/// What impulses keep a tree's bodies from in this step. The bodies are numbered.
template <class T>
Strike<T> IslandStepper<T>::strike_of(std::size_t n) const {
  if (struck_velocity_.empty()) return {};
  const auto bodies = [&](const auto& all) {
    return std::span(all).subspan(first_body_[n], states_[n]->tree.bodies);
  };
  return {bodies(struck_velocity_), bodies(struck_momentum_)};
}

/// Friction is constant over a step, as far as it is a force.
template <class T>
void IslandStepper<T>::emphasise_friction(T h) {
  if (settings_.plan->scheme) return;
  for (Contact<T>& c : contacts_) c.grip *= constant_emphasis(problems_[c.tree_a]->prediction.weight, h);
}

/// Undoes that, before another prediction: implicit Euler's forces are what they are.
template <class T>
void IslandStepper<T>::relax_friction(T h) {
  for (Contact<T>& c : contacts_) c.grip /= constant_emphasis(problems_[c.tree_a]->prediction.weight, h);
}

/// Takes what the constant forces [dof] of a tree make of its accelerations out of these, at the kinematics
/// that the problems hold.
template <class T>
void IslandStepper<T>::drop_constant(CharacterState<T>& s, int tree, std::span<const T> force) {
  for (auto* v : {&moved_, &turned_}) v->resize(s.tree.bodies);
  ends_.respond(tree, force, moved_, turned_);
  for (int i = 0; i < s.tree.bodies; ++i) {
    const Mat3<T>& r = s.problem.kinematics.rotation[i];
    s.history.acceleration[i] -= moved_[i];
    s.history.torque[i] -= r * (s.tree.inertia[i] * (r.transpose() * turned_[i]));
  }
}

/// Whether no degree of freedom of a tree can move in the step, but as it is led.
template <class T>
bool IslandStepper<T>::is_locked(const CharacterState<T>& s) const {
  const auto none = [](const auto& v) {
    return std::all_of(v.begin(), v.end(), [](auto x) { return x == 0; });
  };
  return couplings_.empty() && s.problem.effects.empty() && none(s.problem.free) && none(s.baked);
}

/// The accelerations that smooth forces leave a tree that is locked: those of each body by itself. They have
/// the same part in the joints' freedom as those of the tree, Jᵀm a = JᵀF, and where no joint is free nothing
/// else of them counts.
template <class T>
void IslandStepper<T>::accelerate_locked(CharacterState<T>& s, int tree) {
  History<T>& h = s.history;
  fall(h);
  const auto act = [&](int body, const Vec3<T>& at, const Vec3<T>& force) {
    if (!(s.tree.mass[body] > T(0))) return;
    h.acceleration[body] += force / s.tree.mass[body];
    h.torque[body] += (at - s.problem.kinematics.center[body]).cross(force);
  };
  for (const Contact<T>& c : contacts_) {
    if (!(c.smooth_force > T(0))) continue;
    const Vec3<T> normal = c.smooth_force * c.normal;
    if (c.tree_a == tree) act(c.body_a, c.point, normal);
    if (c.tree_b == tree) act(c.body_b, c.point, Vec3<T>(-normal));
  }
}

/// The same of a tree on which nothing but gravity acts.
template <class T>
void IslandStepper<T>::fall(History<T>& h) const {
  std::fill(h.acceleration.begin(), h.acceleration.end(), settings_.gravity);
  std::fill(h.torque.begin(), h.torque.end(), Vec3<T>(Vec3<T>::Zero()));
}

/// Takes out of accelerations all that played animations took but gravity.
template <class T>
void IslandStepper<T>::drop_played() {
  bool begun = false;
  for (std::size_t n = 0; n < states_.size(); ++n) {
    CharacterState<T>& s = *states_[n];
    if (s.rate_step > T(0) || !s.history.accelerates) continue;
    TreeProblem<T>& p = s.problem;
    if (is_locked(s)) {
      fall(s.history);
      continue;
    }
    if (!begun) begin_ends();
    begun = true;
    for (int i = 0; i < s.tree.bodies; ++i) {
      p.force[i] = s.tree.mass[i] * (s.history.acceleration[i] - settings_.gravity);
      p.moment[i] = p.kinematics.center[i].cross(p.force[i]) + s.history.torque[i];
    }
    constant_.assign(s.tree.dofs, T(0));
    project_wrenches<T>(s.tree, p.kinematics, p.force, p.moment, constant_);
    drop_constant(s, static_cast<int>(n), constant_);
  }
}

/// The same of what leads and pulls in a trial at rest.
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

/// Every degree of freedom loose, but those of trees that are locked.
template <class T>
void IslandStepper<T>::begin_ends() {
  loose_.clear();
  for (const CharacterState<T>* s : states_) loose_.insert(loose_.end(), s->tree.dofs, is_locked(*s) ? 0 : 1);
  ends_.begin(problems_, loose_);
}

/// Whether the same contacts and limits as in the steps before are expected at the end of this one.
template <class T>
void IslandStepper<T>::expect_to_last(T h) {
  lasts_.resize(states_.size());
  for (std::size_t n = 0; n < states_.size(); ++n)
    lasts_[n] = states_[n]->steps_unchanged >= kUnchangedSteps &&
                touching_soon<T>(contacts_, static_cast<int>(n), states_, world_->gravity, h) ==
                    states_[n]->contact_signature;
}

/// A point that has slid from one obstacle on to the next, of the same plane, bears there what it bore.
template <class T>
void IslandStepper<T>::take_over(Contact<T>& c) const {
  if (!c.fresh || c.tree_b >= 0 || !(normal_force(c) > T(0))) return;
  for (const Contact<T>& left : contacts_) {
    if (point_of(left) != point_of(c) || left.tree_b >= 0 || left.fresh || normal_force(left) > T(0))
      continue;
    if (left.frame.col(2).dot(c.normal) < T(kSamePlane)) continue;
    c.smooth_before = left.smooth_before;
    c.lasting_last = left.lasting_last;
    c.lasting_before = left.lasting_before;
    return;
  }
}

/// After a solve: splits the contacts' forces into smooth ones and impulses.
template <class T>
void IslandStepper<T>::split_contacts(T h) {
  for (std::size_t n = 0; n < states_.size(); ++n)
    lasts_[n] = lasts_[n] && touching<T>(contacts_, static_cast<int>(n)) == states_[n]->contact_signature &&
                bearing<T>(*problems_[n]) == states_[n]->limit_signature;
  for (Contact<T>& c : contacts_) {
    take_over(c);
    const T share = lasting_share(problems_[c.tree_a]->prediction.weight, h);
    split<T>(lasts_[c.tree_a] && (c.tree_b < 0 || lasts_[c.tree_b]), share, c);
  }
}

/// Forces that are constant over the step, at a pose of a tree, into `constant_` and others of its rows into
/// `others_` [dof]: of muscles, friction, pushes and what leads joints. Uses the problem's wrenches.
template <class T>
void IslandStepper<T>::measure_constant(const CharacterState<T>& s, TreeProblem<T>& p, int tree,
                                        const Kinematics<T>& k) {
  bool any = false;
  const auto act = [&](int body, const Vec3<T>& local, const Vec3<T>& force) {
    if (!any) clear_wrenches(p);
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
  const bool acted_on = !s.limp() || !p.pushes.empty() ||
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
    if (!any) clear_wrenches(p);
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
    ends_.settle(tree, impulse, 1 / h);
  } else {
    speed_share_.resize(s.tree.dofs);
    speed_shares<T>(p, settings_.plan->joints.damping, h, speed_share_);
    for (int dof = 0; dof < s.tree.dofs; ++dof) constant_[dof] *= speed_share_[dof];
    const T started = choose_start(s, tree);
    for (int dof = 0; dof < s.tree.dofs; ++dof) impulse[dof] += (1 - started) / h * constant_[dof];
    ends_.settle(tree, impulse, T(0));  // its floor's share is missing in `moved_`, too
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

/// How joints move at the end of the part that are led: as the animation does, or on their way back to it.
template <class T>
void IslandStepper<T>::measure_led(const CharacterState<T>& s, int tree, T h) {
  const TreeProblem<T>& p = s.problem;
  led_rates_.assign(s.tree.bodies, {});
  for (int i = 0; i < s.tree.bodies; ++i) {
    const int first = s.tree.first_dof[i], count = s.tree.dof_count(i), parent = s.tree.parent[i];
    int loose = 0;
    for (int k = 0; k < count; ++k) loose += ends_.loose(tree, first + k);
    if (count > 0 ? loose == count : parent < 0) continue;
    const Mat3<T> outer = parent < 0 ? Mat3<T>(Mat3<T>::Identity()) : p.kinematics.rotation[parent];
    Twist<T>& held = led_rates_[i];
    const auto lead = [&](const Mat3<T>& turned, const Vec3<T>& omega, const Vec3<T>& velocity) {
      held.w = outer * (turned * omega);
      held.v = outer * velocity - held.w.cross(p.kinematics.origin[i]);
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
      held = {};
      for (int k = 0; k < count; ++k) rate[k] = ends_.loose(tree, first + k) ? T(0) : s.rate[i][k];
    }
    if (s.tree.type[i] == JointType::kFree) {
      const Vec3<T> world = p.local[i].rotation * Vec3<T>(rate[3], rate[4], rate[5]);
      for (int a = 0; a < 3; ++a) rate[3 + a] = world[a];
    }
    for (int k = 0; k < count; ++k) {
      held.w += rate[k] * p.kinematics.w[first + k];
      held.v += rate[k] * p.kinematics.v[first + k];
    }
  }
}

/// The degrees of freedom whose speed the step has to find: unknowns that no muscles hold. False where that
/// is all of them.
template <class T>
bool IslandStepper<T>::choose_loose() {
  loose_.clear();
  bool led = false;
  for (const CharacterState<T>* s : states_)
    for (int dof = 0; dof < s->tree.dofs; ++dof) {
      loose_.push_back((s->problem.free[dof] || s->baked[s->tree.dof_body[dof]]) && !holds(*s, dof));
      led = led || !loose_.back();
    }
  return led;
}

/// Where each tree's bodies and degrees of freedom begin among those of all.
template <class T>
void IslandStepper<T>::number_bodies() {
  for (auto* v : {&first_body_, &first_dof_}) v->clear();
  int bodies = 0, dofs = 0;
  for (const CharacterState<T>* s : states_) {
    first_body_.push_back(bodies);
    first_dof_.push_back(dofs);
    bodies += s->tree.bodies;
    dofs += s->tree.dofs;
  }
  for (auto* v : {&start_sped_, &start_spun_, &missed_, &unturned_}) v->resize(bodies);
  impulse_.resize(dofs);
}

/// Moves all trees' histories on to the solution.
template <class T>
void IslandStepper<T>::advance_one_step(T h) {
  split_contacts(h);
  turned_far_.assign(states_.size(), 0);
  for (std::size_t n = 0; n < states_.size(); ++n)
    measure_constant_at_start(*states_[n], static_cast<int>(n), h);
  begin_ends();
  for (std::size_t n = 0; n < states_.size(); ++n) {
    CharacterState<T>& s = *states_[n];
    TreeProblem<T>& p = s.problem;
    const bool locked = is_locked(s);
    const Jumps<T> jumps = locked ? Jumps<T>{} : measure_jumps(s, static_cast<int>(n), h);
    advance_bossak<T>(s.tree, p.kinematics, p.prediction, p.couple, jumps, h, settings_.common_origin,
                      s.history);
    if (locked) {
      for (auto* v : {&s.smooth, &s.lasting, &s.lasting_before}) std::fill(v->begin(), v->end(), T(0));
      accelerate_locked(s, static_cast<int>(n));
    } else {
      add_start(s, static_cast<int>(n));
    }
  }
  if (choose_loose()) ends_.begin(problems_, loose_);
  for (std::size_t n = 0; n < states_.size(); ++n) {
    CharacterState<T>& s = *states_[n];
    measure_led(s, static_cast<int>(n), h);
    // Mean rates over the step, those before it: with both what is near to those at the end.
    for (int i = 0; s.rate_step_before > T(0) && i < s.tree.bodies; ++i)
      for (int k = 0; k < s.tree.dof_count(i); ++k)
        if (ends_.loose(static_cast<int>(n), s.tree.first_dof[i] + k))
          s.rate[i][k] = 2 * s.rate[i][k] - s.rate_before[i][k];
    ends_.project(static_cast<int>(n), led_rates_, s.rate,
                  std::span<const T>(impulse_).subspan(first_dof_[n], s.tree.dofs), s.history);
  }
  press(h);
  for (std::size_t n = 0; n < states_.size(); ++n) {
    CharacterState<T>& s = *states_[n];
    ends_.write(static_cast<int>(n), s.history, s.rate);
  }
  for (auto* v : {&struck_velocity_, &struck_momentum_}) v->clear();  // in the parts to come nothing strikes
}

/// What bears at the end of the step, where something has just begun or ceased to, goes no deeper.
template <class T>
void IslandStepper<T>::press(T h) {
  find_sets();
  struck_.assign(states_.size(), 0);
  for (std::size_t n = 0; n < states_.size(); ++n)
    if (!lasts_[n]) struck_[set_[n]] = 1;
  const auto bears = [](const Contact<T>& c) { return normal_force(c) > T(0); };
  for (const Contact<T>& c : contacts_) {
    const bool struck = struck_[set_[c.tree_a]] && bears(c) && !is_level_edge<T>(c, contacts_, -c.gap, bears);
    if (!struck && !(c.grip > T(0))) continue;
    const Prediction<T>& prediction = problems_[c.tree_a]->prediction;
    const T acted = 1 / (h * prediction.weight);  // κh, s; twice that for what is constant over the step
    const T rubbed = prediction.rho > T(0) ? 2 * acted : acted;
    const T cone = c.friction * acted * (normal_force(c) - c.smooth_force) + rubbed * c.grip;
    ends_.add(c, struck ? T(kMostSteps) * h * normal_force(c) : T(0), cone,
              Vec3<T>(-rubbed * friction_gradient(c, settings_.stick)));
  }
  for (const Coupling<T>* c : couplings_)
    for (const Stencil<T>& e : c->stencils)
      if (c->led) ends_.add(*c, e);
  for (std::size_t n = 0; n < states_.size(); ++n) {
    if (!struck_[set_[n]]) continue;
    for (const JointRow<T>& row : problems_[n]->rows)
      if (row.kind == RowKind::kOneSided && row.slope(row.value) > T(0))
        ends_.add(static_cast<int>(n), row, T(kMostSteps) * h * row.slope(row.value));
  }
  ends_.press();
}

#define SINEW_MOTION_INSTANCES(T)                                                                     \
  template void IslandStepper<T>::find_sets();                                                        \
  template void IslandStepper<T>::predict_all(T);                                                     \
  template void IslandStepper<T>::predict_euler_all(T);                                               \
  template void IslandStepper<T>::strike(CharacterState<T>&, std::span<Vec3<T>>, std::span<Vec3<T>>); \
  template void IslandStepper<T>::strike_all();                                                       \
  template Strike<T> IslandStepper<T>::strike_of(std::size_t) const;                                  \
  template void IslandStepper<T>::drop_constant(CharacterState<T>&, int, std::span<const T>);         \
  template void IslandStepper<T>::drop_played();                                                      \
  template void IslandStepper<T>::begin_ends();                                                       \
  template void IslandStepper<T>::drop_trial(CharacterState<T>&, int);                                \
  template void IslandStepper<T>::expect_to_last(T);                                                  \
  template void IslandStepper<T>::take_over(Contact<T>&) const;                                       \
  template void IslandStepper<T>::split_contacts(T);                                                  \
  template void IslandStepper<T>::measure_constant(const CharacterState<T>&, TreeProblem<T>&, int,    \
                                                   const Kinematics<T>&);                             \
  template void IslandStepper<T>::measure_constant_at_start(CharacterState<T>&, int, T);              \
  template Jumps<T> IslandStepper<T>::measure_jumps(CharacterState<T>&, int, T);                      \
  template T IslandStepper<T>::choose_start(const CharacterState<T>&, int);                           \
  template void IslandStepper<T>::add_start(CharacterState<T>&, int);                                 \
  template bool IslandStepper<T>::is_locked(const CharacterState<T>&) const;                          \
  template void IslandStepper<T>::fall(History<T>&) const;                                            \
  template void IslandStepper<T>::accelerate_locked(CharacterState<T>&, int);                         \
  template void IslandStepper<T>::measure_led(const CharacterState<T>&, int, T);                      \
  template bool IslandStepper<T>::choose_loose();                                                     \
  template void IslandStepper<T>::number_bodies();                                                    \
  template void IslandStepper<T>::advance_one_step(T);                                                \
  template void IslandStepper<T>::emphasise_friction(T);                                              \
  template void IslandStepper<T>::relax_friction(T);                                                  \
  template void IslandStepper<T>::press(T);
SINEW_MOTION_INSTANCES(float)
SINEW_MOTION_INSTANCES(double)

}  // namespace sinew
