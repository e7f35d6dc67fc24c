#include "sinew/character/bounce.h"

#include <algorithm>
#include <cmath>

#include "sinew/character/energy_ledger.h"

namespace sinew {
namespace {

constexpr double kSlowest = 0.2;  ///< m/s; slower impacts, and what gravity makes in two steps, come to rest
constexpr int kSweeps = 40;
constexpr int kTrusted = 2;  ///< steps_unchanged from which bdf2 may be used

/// A single body that bounced flies on as if it had always flown: bdf2 at once, where bdf1 would lose ½gh² of
/// height in each of its steps.
template <class T>
void pretend_flight(History<T>& history, const Vec3<T>& gravity, T h) {
  const Vec3<T> v = history.velocity[0];
  const Mat3<T> spin = history.rotation_rate[0] * history.rotation[0].transpose();
  const Vec3<T> turned = Vec3<T>(spin(2, 1), spin(0, 2), spin(1, 0)) * h;
  history.center_before[0] = history.center[0] - h * v + gravity * (h * h / 2);
  history.velocity_before[0] = v - h * gravity;
  history.rotation_before[0] = rotation_exp<T>(Vec3<T>(-turned)).toRotationMatrix() * history.rotation[0];
  history.momentum_before[0] = history.momentum[0];
  history.step_before = h;
}

}  // namespace

template <class T>
void Bounce<T>::reserve(const SolveRoom& room) {
  const int dofs = room.dofs;
  unknowns_.reserve(dofs);
  axes_.reserve(dofs, room.path_entries);
  mass_.reserve(dofs, room.path_entries);
  first_.reserve(room.trees);
  impacts_.reserve(kMost);
  rows_.reserve(std::size_t(kMost) * dofs);
  answers_.reserve(std::size_t(kMost) * dofs);
  delassus_.reserve(kMost * kMost);
  change_.reserve(dofs);
  turn_.reserve(room.bodies);
  slide_.reserve(room.bodies);
}

template <class T>
bool Bounce<T>::possible(std::span<const Contact<T>> contacts) {
  return std::any_of(contacts.begin(), contacts.end(), [](const Contact<T>& c) {
    return c.fresh && c.restitution > T(0) && c.gap < T(0) && c.approach > T(kSlowest);
  });
}

template <class T>
void Bounce<T>::collect(std::span<CharacterState<T>* const> states, std::span<Contact<T>> contacts,
                        const Vec3<double>& gravity, T h) {
  impacts_.clear();
  const T slowest = std::max(T(kSlowest), 2 * h * T(gravity.norm()));
  for (Contact<T>& c : contacts) {
    if (!c.fresh || c.gap >= T(0) || c.restitution <= T(0) || c.approach < slowest) continue;
    if (impacts_.size() == kMost) return;
    // The fall over what was left of the gap belongs to the impact, the rise from the depth to the bounce.
    const T pull = c.tree_b < 0 ? T(-gravity.dot(c.normal.template cast<double>())) : T(0);
    const T arrives = c.restitution * c.restitution *
                      std::max(c.approach * c.approach + 2 * pull * std::max(c.start_gap, T(0)), T(0));
    const T speed = std::sqrt(std::max(arrives - 2 * pull * c.gap, T(0)));
    Vec3<T> parting = states[c.tree_a]->point_velocity(c.body_a, c.point);
    if (c.tree_b >= 0) parting -= states[c.tree_b]->point_velocity(c.body_b, c.point);
    const T left = parting.dot(c.normal);
    impacts_.push_back({&c, left, speed - left, T(0)});
  }
}

/// Mass matrix over the unknowns at the present kinematics.
template <class T>
bool Bounce<T>::factorise(std::span<CharacterState<T>* const> states) {
  unknowns_.clear();
  axes_.clear();
  first_.clear();
  for (CharacterState<T>* s : states)
    first_.push_back(append_unknowns<T>(s->tree, s->problem.free, unknowns_));
  mass_.set_zero();
  for (std::size_t n = 0; n < states.size(); ++n) {
    CharacterState<T>& s = *states[n];
    const Kinematics<T>& k = s.problem.kinematics;
    axes_.append(s.tree, k, unknowns_, first_[n]);
    for (int i = 0; i < s.tree.bodies; ++i) {
      s.problem.composite[i] = {};
      s.problem.composite[i].add_body(s.tree.mass[i], k.center[i],
                                      k.rotation[i] * s.tree.inertia[i] * k.rotation[i].transpose());
    }
    assemble_tree_matrix<T>(s.tree, k, axes_, s.problem.composite, unknowns_, first_[n], false, mass_);
    add_floor<T>(s.tree, k, s.problem.composite, unknowns_, first_[n], mass_);
  }
  return mass_.factorise();
}

/// Parting speed of a contact per unit of each unknown's speed.
template <class T>
void Bounce<T>::project(std::span<CharacterState<T>* const> states, const Contact<T>& c,
                        std::span<T> row) const {
  std::fill(row.begin(), row.end(), T(0));
  const auto side = [&](int n, int body, T sign) {
    const CharacterState<T>& s = *states[n];
    const Vec3<T> moment = c.point.cross(c.normal);
    for (int k = unknown_above<T>(s.tree, body, unknowns_, first_[n]); k >= 0;
         k = unknowns_.pattern.parent[k]) {
      const int dof = unknowns_.dof[k];
      row[k] += sign * (s.problem.kinematics.v[dof].dot(c.normal) + s.problem.kinematics.w[dof].dot(moment));
    }
  };
  side(c.tree_a, c.body_a, T(1));
  if (c.tree_b >= 0) side(c.tree_b, c.body_b, T(-1));
}

template <class T>
void Bounce<T>::solve_impulses() {
  const std::size_t m = impacts_.size();
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (std::size_t i = 0; i < m; ++i) {
      if (!(delassus_[i * m + i] > T(0))) continue;
      T missing = impacts_[i].wanted;
      for (std::size_t j = 0; j < m; ++j) missing -= delassus_[i * m + j] * impacts_[j].impulse;
      impacts_[i].impulse = std::max(T(0), impacts_[i].impulse + missing / delassus_[i * m + i]);
    }
}

/// What a contact stored in the impact is part of what the bounce gives back: it opens within the next step,
/// whose implicit force would return nothing of it. The surface is let down to where the feature is, and
/// comes back as for what begins inside something.
template <class T>
void Bounce<T>::unload(std::span<CharacterState<T>* const> states) {
  for (const Impact& impact : impacts_) {
    if (!(impact.impulse > T(0))) continue;
    Contact<T>& c = *impact.contact;
    states[c.tree_a]->report.elastic_energy -= double(stored_energy(c));
    c.offset -= c.gap;
    c.gap = T(0);
  }
}

/// Largest share of the impulses whose work stays within `allowed` (J): with J v the speeds that are there,
/// the work is s·pᵀJv + ½s²·pᵀJM⁻¹Jᵀp.
template <class T>
T Bounce<T>::affordable(double allowed) const {
  const std::size_t m = impacts_.size();
  double linear = 0, quadratic = 0;
  for (std::size_t i = 0; i < m; ++i) {
    linear += double(impacts_[i].impulse * impacts_[i].left);
    for (std::size_t j = 0; j < m; ++j)
      quadratic += double(impacts_[i].impulse * delassus_[i * m + j] * impacts_[j].impulse);
  }
  if (!(quadratic > 0)) return T(0);
  const double root = linear * linear + 2 * quadratic * std::max(allowed, 0.0);
  return T(std::clamp((std::sqrt(root) - linear) / quadratic, 0.0, 1.0));
}

/// Adds changes of the unknowns' speeds to what a history carries of the bodies' motion.
template <class T>
void Bounce<T>::move(CharacterState<T>& s, int first) {
  const Kinematics<T>& k = s.problem.kinematics;
  turn_.assign(s.tree.bodies, Vec3<T>::Zero());
  slide_.assign(s.tree.bodies, Vec3<T>::Zero());
  for (int i = 0; i < s.tree.bodies; ++i) {
    Vec3<T>&w = turn_[i], &v = slide_[i];
    if (const int parent = s.tree.parent[i]; parent >= 0) {
      w = turn_[parent];
      v = slide_[parent];
    }
    for (int dof = s.tree.first_dof[i]; dof < s.tree.first_dof[i + 1]; ++dof) {
      const int unknown = unknowns_.of_dof[first + dof];
      if (unknown < 0) continue;
      w += change_[unknown] * k.w[dof];
      v += change_[unknown] * k.v[dof];
      s.rate[i][dof - s.tree.first_dof[i]] += change_[unknown];
    }
    s.history.velocity[i] += v + w.cross(k.center[i]);
    s.history.rotation_rate[i] += skew<T>(w) * k.rotation[i];
    s.history.momentum[i] += k.rotation[i] * (s.tree.inertia[i] * (k.rotation[i].transpose() * w));
  }
}

template <class T>
bool Bounce<T>::apply(std::span<CharacterState<T>* const> states, std::span<Contact<T>> contacts,
                      const Vec3<double>& gravity, T h, double budget) {
  collect(states, contacts, gravity, h);
  if (impacts_.empty() || !factorise(states)) return false;
  const std::size_t m = impacts_.size(), n = unknowns_.pattern.size;
  rows_.assign(m * n, T(0));
  answers_.assign(m * n, T(0));
  delassus_.assign(m * m, T(0));
  for (std::size_t i = 0; i < m; ++i) {
    const std::span<T> row(rows_.data() + i * n, n), answer(answers_.data() + i * n, n);
    project(states, *impacts_[i].contact, row);
    std::copy(row.begin(), row.end(), answer.begin());
    mass_.solve(answer);
  }
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < m; ++j)
      for (std::size_t k = 0; k < n; ++k) delassus_[i * m + j] += rows_[i * n + k] * answers_[j * n + k];
  solve_impulses();
  unload(states);
  const T share = affordable(budget - energy<T>(states, gravity));
  change_.assign(n, T(0));
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t k = 0; k < n; ++k) change_[k] += share * impacts_[i].impulse * answers_[i * n + k];
  for (std::size_t t = 0; t < states.size(); ++t) {
    CharacterState<T>& s = *states[t];
    move(s, first_[t]);
    s.steps_unchanged = 0;  // the velocities before are no guide to those after
    if (s.tree.bodies == 1) {
      pretend_flight<T>(s.history, gravity.template cast<T>(), h);
      s.contact_signature = 0;
      s.steps_unchanged = kTrusted;
    }
    s.report_totals(gravity);
  }
  return true;
}

template class Bounce<float>;
template class Bounce<double>;

}  // namespace sinew
