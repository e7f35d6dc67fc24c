#include "sinew/effects/restitution.h"

#include <algorithm>
#include <cmath>

#include "sinew/skeleton/portable_math.h"

namespace sinew {
namespace {

constexpr double kSlowest = 0.2;  ///< m/s; slower impacts, and what gravity makes in two steps, come to rest
constexpr int kSweeps = 40;
constexpr int kTrusted = 2;  ///< steps_unchanged from which what touches has lasted

/// Kinetic, potential and stored, J.
template <class T>
double energy(std::span<const IslandTree<T>> trees, const Vec3<double>& gravity) {
  double sum = 0;
  for (const IslandTree<T>& t : trees) {
    const Totals now = totals<T>(*t.problem.tree, t.history, gravity);
    sum += now.kinetic_energy + now.potential_energy + t.elastic_energy;
  }
  return sum;
}

/// m/s at which a contact closes that bounces.
template <class T>
T slowest(const Contact<T>& c, const Vec3<double>& gravity, T h) {
  return std::max(T(kSlowest) * c.speed_scale, 2 * h * T(gravity.norm()));
}

/// Where the surfaces meet.
template <class T>
Vec3<T> touch(const Contact<T>& c) {
  return c.point - c.radius * c.normal;
}

}  // namespace

template <class T>
void Restitution<T>::reserve(const SolveCapacity& capacity) {
  const int dofs = capacity.dofs;
  unknowns_.reserve(dofs);
  axes_.reserve(dofs, capacity.path_entries);
  mass_.reserve(dofs, capacity.path_entries);
  first_.reserve(capacity.trees);
  impacts_.reserve(kMost);
  impulse_.reserve(kMostRows);
  rows_.reserve(std::size_t(kMostRows) * dofs);
  answers_.reserve(std::size_t(kMostRows) * dofs);
  delassus_.reserve(kMostRows * kMostRows);
  change_.reserve(dofs);
  turn_.reserve(capacity.bodies);
  slide_.reserve(capacity.bodies);
}

template <class T>
Bounce<T> Restitution<T>::bounce_of(const Contact<T>& c, const Vec3<double>& gravity, T h) const {
  return c.fresh ? Bounce<T>{c.restitution, slowest(c, gravity, h)} : Bounce<T>{};
}

template <class T>
bool Restitution<T>::may_change_speeds(std::span<const Contact<T>> contacts) const {
  return std::any_of(contacts.begin(), contacts.end(), [](const Contact<T>& c) {
    return c.fresh && c.restitution > T(0) && c.gap < T(0) && !c.bounced &&
           c.approach > T(kSlowest) * c.speed_scale;
  });
}

template <class T>
void Restitution<T>::collect(Trees trees, std::span<Contact<T>> contacts, const Vec3<double>& gravity, T h) {
  impacts_.clear();
  for (Contact<T>& c : contacts) {
    const bool strikes = c.fresh && c.gap < T(0) && !c.bounced;
    if (!strikes || c.restitution <= T(0) || c.approach < slowest(c, gravity, h)) continue;
    if (impacts_.size() == kMost) return;
    // The fall over what was left of the gap belongs to the impact, the rise from the depth to the bounce.
    const T pull = c.tree_b < 0 ? T(-gravity.dot(c.normal.template cast<double>())) : T(0);
    const T arrives = c.restitution * c.restitution *
                      std::max(c.approach * c.approach + 2 * pull * std::max(c.start_gap, T(0)), T(0));
    const T speed = std::sqrt(std::max(arrives - 2 * pull * c.gap, T(0)));
    const auto parting = [&](const Vec3<T>& at) {
      Vec3<T> v = trees[c.tree_a].point_velocity(c.body_a, at);
      if (c.tree_b >= 0) v -= trees[c.tree_b].point_velocity(c.body_b, at);
      return v;
    };
    const T left = parting(c.point).dot(c.normal);
    const Vec3<T> slip = parting(touch(c));
    impacts_.push_back({&c, left, speed - left, {slip.dot(c.frame.col(0)), slip.dot(c.frame.col(1))}});
  }
}

/// Mass matrix over the unknowns at the present kinematics.
template <class T>
bool Restitution<T>::factorise(Trees trees) {
  unknowns_.clear();
  axes_.clear();
  first_.clear();
  for (const IslandTree<T>& t : trees)
    first_.push_back(append_unknowns<T>(*t.problem.tree, t.problem.free, unknowns_));
  mass_.set_zero();
  for (std::size_t n = 0; n < trees.size(); ++n) {
    TreeProblem<T>& p = trees[n].problem;
    const Tree<T>& tree = *p.tree;
    const Kinematics<T>& k = p.kinematics;
    axes_.append(tree, k, unknowns_, first_[n]);
    for (int i = 0; i < tree.bodies; ++i) {
      p.composite[i] = {};
      p.composite[i].add_body(tree.mass[i], k.center[i],
                              k.rotation[i] * tree.inertia[i] * k.rotation[i].transpose());
    }
    assemble_tree_matrix<T>(tree, k, axes_, p.composite, unknowns_, first_[n], false, mass_);
    add_floor<T>(tree, k, p.composite, unknowns_, first_[n], mass_);
  }
  return mass_.factorise();
}

/// Speed of a contact's sides against each other along a direction, at a point, per unit of each unknown's.
template <class T>
void Restitution<T>::project(Trees trees, const Contact<T>& c, const Vec3<T>& direction, const Vec3<T>& at,
                             std::span<T> row) const {
  std::fill(row.begin(), row.end(), T(0));
  const auto side = [&](int n, int body, T sign) {
    const TreeProblem<T>& p = trees[n].problem;
    const Vec3<T> moment = at.cross(direction);
    for (int k = unknown_above<T>(*p.tree, body, unknowns_, first_[n]); k >= 0;
         k = unknowns_.pattern.parent[k]) {
      const int dof = unknowns_.dof[k];
      row[k] += sign * (p.kinematics.v[dof].dot(direction) + p.kinematics.w[dof].dot(moment));
    }
  };
  side(c.tree_a, c.body_a, T(1));
  if (c.tree_b >= 0) side(c.tree_b, c.body_b, T(-1));
}

/// What a row's impulse has to change yet of a speed that all impulses shall change by `wanted`, m/s.
template <class T>
T Restitution<T>::missing(std::size_t row, T wanted) const {
  for (std::size_t j = 0; j < impulse_.size(); ++j)
    wanted -= delassus_[row * impulse_.size() + j] * impulse_[j];
  return wanted;
}

/// The tangential impulses of an impact: against its slip, within the cone.
template <class T>
void Restitution<T>::rub(std::size_t impact) {
  const std::size_t m = impulse_.size(), row = 3 * impact;
  for (std::size_t k = 0; k < 2; ++k)
    if (const T own = delassus_[(row + 1 + k) * (m + 1)]; own > T(0))
      impulse_[row + 1 + k] += missing(row + 1 + k, -impacts_[impact].slip[k]) / own;
  const T size = portable::hypot(impulse_[row + 1], impulse_[row + 2]);
  const T most = impacts_[impact].contact->friction * impulse_[row];
  if (!(size > most)) return;
  impulse_[row + 1] *= most / size;
  impulse_[row + 2] *= most / size;
}

template <class T>
void Restitution<T>::solve_impulses() {
  const std::size_t m = impulse_.size();
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (std::size_t i = 0; i < impacts_.size(); ++i) {
      const std::size_t row = 3 * i;
      if (const T own = delassus_[row * (m + 1)]; own > T(0))
        impulse_[row] = std::max(T(0), impulse_[row] + missing(row, impacts_[i].wanted) / own);
      rub(i);
    }
}

/// Whether something strikes what no unknown moves, nor the world: that gives energy which no tree had.
template <class T>
bool Restitution<T>::meets_driven(Trees trees) const {
  const auto driven = [&](int n, int body) {
    return n >= 0 && unknown_above<T>(*trees[n].problem.tree, body, unknowns_, first_[n]) < 0;
  };
  return std::any_of(impacts_.begin(), impacts_.end(), [&](const Impact& i) {
    return driven(i.contact->tree_a, i.contact->body_a) || driven(i.contact->tree_b, i.contact->body_b);
  });
}

/// J, that the solve took of what strikes, as it moved against what it struck. Uses the impulses' room.
template <class T>
double Restitution<T>::taken() {
  const std::size_t m = impulse_.size();
  const auto stopped = [](const Impact& i) { return i.contact->approach + i.left; };
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (std::size_t i = 0; i < impacts_.size(); ++i)
      if (const T own = delassus_[3 * i * (m + 1)]; own > T(0))
        impulse_[3 * i] = std::max(T(0), impulse_[3 * i] + missing(3 * i, stopped(impacts_[i])) / own);
  double sum = 0;
  for (std::size_t i = 0; i < impacts_.size(); ++i)
    sum += 0.5 * double(impulse_[3 * i] * (impacts_[i].contact->approach - impacts_[i].left));
  std::fill(impulse_.begin(), impulse_.end(), T(0));
  return sum;
}

/// What a contact stored in the impact is part of what the bounce gives back: it opens within the next step,
/// whose implicit force would return nothing of it. The surface is let down to where the feature is, and
/// comes back as for what begins inside something.
template <class T>
void Restitution<T>::unload(Trees trees) {
  for (std::size_t i = 0; i < impacts_.size(); ++i) {
    if (!(impulse_[3 * i] > T(0))) continue;
    Contact<T>& c = *impacts_[i].contact;
    trees[c.tree_a].elastic_energy -= double(stored_energy(c));
    c.offset -= c.gap;
    c.gap = T(0);
  }
}

/// Largest share of the impulses whose work stays within `allowed` (J): with J v the speeds that are there,
/// the work is s·pᵀJv + ½s²·pᵀJM⁻¹Jᵀp.
template <class T>
T Restitution<T>::affordable(double allowed) const {
  const std::size_t m = impulse_.size();
  double linear = 0, quadratic = 0;
  for (std::size_t i = 0; i < m; ++i) {
    const Impact& impact = impacts_[i / 3];
    linear += double(impulse_[i] * (i % 3 == 0 ? impact.left : impact.slip[i % 3 - 1]));
    for (std::size_t j = 0; j < m; ++j) quadratic += double(impulse_[i] * delassus_[i * m + j] * impulse_[j]);
  }
  if (!(quadratic > 0)) return T(0);
  const double root = linear * linear + 2 * quadratic * std::max(allowed, 0.0);
  return T(std::clamp((std::sqrt(root) - linear) / quadratic, 0.0, 1.0));
}

/// Adds changes of the unknowns' speeds to what a history carries of the bodies' motion.
template <class T>
void Restitution<T>::move(const IslandTree<T>& moved, int first) {
  const Tree<T>& tree = *moved.problem.tree;
  const Kinematics<T>& k = moved.problem.kinematics;
  turn_.assign(tree.bodies, Vec3<T>::Zero());
  slide_.assign(tree.bodies, Vec3<T>::Zero());
  for (int i = 0; i < tree.bodies; ++i) {
    Vec3<T>&w = turn_[i], &v = slide_[i];
    if (const int parent = tree.parent[i]; parent >= 0) {
      w = turn_[parent];
      v = slide_[parent];
    }
    for (int dof = tree.first_dof[i]; dof < tree.first_dof[i + 1]; ++dof) {
      const int unknown = unknowns_.of_dof[first + dof];
      if (unknown < 0) continue;
      w += change_[unknown] * k.w[dof];
      v += change_[unknown] * k.v[dof];
      moved.rate[i][dof - tree.first_dof[i]] += change_[unknown];
    }
    moved.history.velocity[i] += v + w.cross(k.center[i]);
    moved.history.rotation_rate[i] += skew<T>(w) * k.rotation[i];
    moved.history.momentum[i] += k.rotation[i] * (tree.inertia[i] * (k.rotation[i].transpose() * w));
  }
}

template <class T>
bool Restitution<T>::change_speeds(Trees trees, std::span<Contact<T>> contacts, const Vec3<double>& gravity,
                                   T h, double budget) {
  collect(trees, contacts, gravity, h);
  if (impacts_.empty() || !factorise(trees)) return false;
  const std::size_t m = 3 * impacts_.size(), n = unknowns_.pattern.size;
  impulse_.assign(m, T(0));
  rows_.assign(m * n, T(0));
  answers_.assign(m * n, T(0));
  delassus_.assign(m * m, T(0));
  for (std::size_t i = 0; i < m; ++i) {
    const std::span<T> row(rows_.data() + i * n, n), answer(answers_.data() + i * n, n);
    const Contact<T>& c = *impacts_[i / 3].contact;
    if (i % 3 == 0)
      project(trees, c, c.normal, c.point, row);
    else
      project(trees, c, c.frame.col(static_cast<Eigen::Index>(i % 3) - 1), touch(c), row);
    std::copy(row.begin(), row.end(), answer.begin());
    mass_.solve(answer);
  }
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < m; ++j)
      for (std::size_t k = 0; k < n; ++k) delassus_[i * m + j] += rows_[i * n + k] * answers_[j * n + k];
  const bool driven = meets_driven(trees);
  const double took = driven ? taken() : 0;
  solve_impulses();
  unload(trees);
  const T share = affordable(driven ? took : budget - energy<T>(trees, gravity));
  change_.assign(n, T(0));
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t k = 0; k < n; ++k) change_[k] += share * impulse_[i] * answers_[i * n + k];
  for (T& given : impulse_) given *= share;
  for (std::size_t t = 0; t < trees.size(); ++t) {
    const IslandTree<T>& tree = trees[t];
    move(tree, first_[t]);
    tree.steps_unchanged = 0;
    if (tree.problem.tree->bodies > 1) continue;
    tree.contact_signature = 0;  // a single body that bounced flies on as if it had always flown
    tree.steps_unchanged = kTrusted;
  }
  return true;
}

template <class T>
T Restitution<T>::pushed(const Contact<T>& contact) const {
  for (std::size_t i = 0; i < impacts_.size(); ++i)
    if (impacts_[i].contact == &contact) return impulse_[3 * i];
  return T(0);
}

template class Restitution<float>;
template class Restitution<double>;

}  // namespace sinew
