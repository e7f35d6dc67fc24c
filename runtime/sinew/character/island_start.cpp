// The first step of IslandStepper from a reset, in which accelerations are not known yet.
#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "sinew/character/island.h"
#include "sinew/character/touch_digest.h"
#include "sinew/character/unknowns.h"
#include "sinew/residual/residual_pass.h"
#include "sinew/skeleton/fewer_digits.h"

namespace sinew {
namespace {

constexpr double kTrialTurn = 3e-3;  ///< of a trial at rest: its span times the square of the fastest spin

/// Angular velocity (rad/s) in body axes, as a matrix; not symmetric in part where it was differenced.
template <class T>
Mat3<T> spin_matrix(const CharacterState<T>& s, int i) {
  return s.history.rotation[i].transpose() * s.history.rotation_rate[i];
}

/// Motion of a joint that does not accelerate, from the velocities of the bodies that it joins.
template <class T>
JointJet<T> coasting_jet(const CharacterState<T>& s, int i) {
  const TreeProblem<T>& p = s.problem;
  const Kinematics<T>& k = p.kinematics;
  const auto spin = [&](int body) {
    const Mat3<T> m = spin_matrix(s, body);
    return Vec3<T>(m(2, 1), m(0, 2), m(1, 0));
  };
  const auto origin_velocity = [&](int body) {
    const Vec3<T> arm = k.center[body] - k.origin[body];
    return Vec3<T>(s.history.velocity[body] - (k.rotation[body] * spin(body)).cross(arm));
  };
  JointJet<T> jet;
  jet.rotation = p.start[i].rotation;
  jet.translation = p.start[i].translation;
  jet.omega = spin(i);
  jet.velocity = origin_velocity(i);
  const int parent = s.tree.parent[i];
  if (parent < 0) return jet;
  const Mat3<T>& outer = k.rotation[parent];
  const Vec3<T> carried = outer * spin(parent);
  jet.omega -= k.rotation[i].transpose() * carried;
  jet.velocity = outer.transpose() * (jet.velocity - origin_velocity(parent) -
                                      carried.cross(Vec3<T>(k.origin[i] - k.origin[parent])));
  if (s.tree.type[i] == JointType::kUniversal) {
    const Vec3<T> first = (k.rotation[i].transpose() * k.w[s.tree.first_dof[i]]), second = s.tree.axis2[i];
    const T along = first.dot(second), scale = 1 - along * along;
    const T rate = (jet.omega.dot(first) - along * jet.omega.dot(second)) / scale;
    const T rate2 = (jet.omega.dot(second) - along * jet.omega.dot(first)) / scale;
    jet.alpha = (first * rate).cross(second * rate2);
  }
  return jet;
}

/// What the bodies' motion asks for were no joint accelerated: forces and, about the centres of mass, couples
/// (world axes) into the problem's room for wrenches.
template <class T>
void measure_coasting(CharacterState<T>& s) {
  TreeProblem<T>& p = s.problem;
  for (int i = 0; i < s.tree.bodies; ++i) {
    const int parent = s.tree.parent[i];
    BodyMotion<T>& body = s.motion.body[i];
    const int first = s.tree.first_dof[i];
    const bool fixed = s.tree.dof_count(i) == 0 || !p.free[first];
    move_body<T>(s.tree, i, fixed ? s.target[i] : coasting_jet(s, i), Vec3<T>(Vec3<T>::Zero()),
                 parent < 0 ? nullptr : &s.motion.body[parent], body);
    const Mat3<T>& r = p.kinematics.rotation[i];
    p.force[i] = r * body.force;
    p.moment[i] = r * Vec3<T>(body.moment - s.tree.center_of_mass[i].cross(body.force));
  }
}

}  // namespace

/// Whether a tree begins without knowing how it accelerates.
template <class T>
bool IslandStepper<T>::starts() const {
  return !settings_.plan->scheme &&
         std::any_of(states_.begin(), states_.end(),
                     [](const CharacterState<T>* s) { return !s->history.accelerates; });
}

/// Finds the accelerations at the start of the part that has been begun: a trial that begins and ends at
/// rest. Where it does not converge they are not known, and the step is implicit Euler's.
template <class T>
void IslandStepper<T>::find_accelerations() {
  const T h = settings_.h;
  for (CharacterState<T>* s : states_) {
    TreeProblem<T>& p = s->problem;
    T fastest = T(0);
    for (int i = 0; i < s->tree.bodies; ++i)
      fastest = std::max(fastest, spin_matrix(*s, i).squaredNorm() / 2);
    const T span = std::min(h * h / 2, T(kTrialTurn) / std::max(fastest, std::numeric_limits<T>::min()));
    measure_coasting(*s);
    for (Effect<T>* effect : p.effects) effect->begin_step(effect_pose(settings_, p));
    predict_at_rest<T>(s->tree, s->history, p.force, p.moment, span, settings_.common_origin, p.prediction);
    p.local = p.start;
    p.pushes.clear();                                                     // forces of the step to come
    if (s->tree.bodies == 1 && contacts_.empty() && p.effects.empty()) {  // nothing to find out
      p.kinematics.center[0] = p.prediction.center[0] + span * settings_.gravity;
      p.couple[0].setZero();
      p.clear_rows();
      std::fill(p.gradient.begin(), p.gradient.end(), T(0));
    }
  }
  const auto swap_offsets = [&] {  // at rest what began open stays so
    for (Coupling<T>* c : couplings_)
      for (Stencil<T>& e : c->stencils) std::swap(e.offset, e.unclosed_offset);
  };
  swap_offsets();
  loosen_loops();
  SolveReport trial;
  trial.converged = true;
  if (!contacts_.empty() || std::any_of(states_.begin(), states_.end(), [](const auto* s) {
        return s->tree.bodies > 1 || !s->problem.effects.empty();
      })) {
    trial = solve();
    total_.add(trial);
  }
  begin_ends();
  for (CharacterState<T>* const& s : states_) {
    TreeProblem<T>& p = s->problem;
    if (!s->history.accelerates) {
      accelerate<T>(s->tree, p.kinematics, p.prediction, p.couple, s->history);
      drop_trial(*s, static_cast<int>(&s - states_.data()));
    }
    std::copy_n(s->local.begin(), s->tree.bodies, p.start.begin());
    if (s->floats) p.start[0].translation = (s->history.place - settings_.common_origin).template cast<T>();
    first_guess(*s, h);
    forward_kinematics<T>(s->tree, p.start, p.common_origin, p.kinematics);
    s->history.accelerates = trial.converged;
    write_pushes(*s, T(1));
  }
  if (trial.converged) begin_loaded(h);
  swap_offsets();
}

/// What rests on something from the start on bears it like that since long: what the trial at rest found.
template <class T>
void IslandStepper<T>::begin_loaded(T h) {
  constexpr T kResting = T(0.05);  // m/s
  lagged_.clear();
  std::vector<std::uint8_t>& loaded = struck_;
  loaded.assign(states_.size(), 1);
  for (const Contact<T>& c : contacts_) {
    const T force = normal_force(c);
    if (!(force > T(0))) continue;
    if (std::abs(c.approach) < kResting * c.speed_scale) {
      const T lasts = rounded_off<kHalfOfDigits<T>>(force);
      lagged_.push_back({c.id, force, c.stiffness, c.offset, force, lasts, lasts});
      continue;
    }
    loaded[c.tree_a] = 0;
    if (c.tree_b >= 0) loaded[c.tree_b] = 0;
  }
  std::sort(lagged_.begin(), lagged_.end(),
            [](const LaggedForce<T>& a, const LaggedForce<T>& b) { return a.id < b.id; });
  for (std::size_t n = 0; n < states_.size(); ++n) {
    if (!loaded[n] || states_[n]->steps_unchanged > 0) continue;
    states_[n]->contact_signature = touching<T>(contacts_, static_cast<int>(n));
    states_[n]->limit_signature = bearing(states_[n]->problem);
    states_[n]->steps_unchanged = kUnchangedSteps;
  }
  for (Coupling<T>* c : couplings_)
    for (Stencil<T>& e : c->stencils) e.carried.begin(stencil_pull(*c, e));
  find_contacts(h);  // measured anew, at the start
}

#define SINEW_START_INSTANCES(T)                        \
  template bool IslandStepper<T>::starts() const;       \
  template void IslandStepper<T>::find_accelerations(); \
  template void IslandStepper<T>::begin_loaded(T);
SINEW_START_INSTANCES(float)
SINEW_START_INSTANCES(double)

}  // namespace sinew
