#include "sinew/optimizer/inner_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sinew/optimizer/joint_terms.h"
#include "sinew/optimizer/newton_constants.h"
#include "sinew/skeleton/hooks.h"

namespace sinew {
namespace {

/// m; contacts further away are left out: in an impact steps are long. Among many trees, and where loops or
/// particles leave the tree to conjugate gradients, that costs too much.
constexpr double kNear = 0.3, kNearOthers = 0.1;
constexpr int kMostProducts = 80;
/// Where conjugate gradients have taken more, contacts across paths are joined to the factor in the rest of
/// the solve, if loops are.
constexpr int kFewProducts = 8;
constexpr double kCgTolerance = 1e-2;  ///< of the preconditioned residual's norm
constexpr double kCgFar = 0.1;         ///< the same, for steps longer than
constexpr double kFar = 1e-3;          ///< m: the next pass will see another problem anyway

template <class T>
T dot(std::span<const T> a, std::span<const T> b) {
  T sum = T(0);
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

}  // namespace

template <class T>
void InnerProblem<T>::declare(const StepPlan<T>& plan) {
  if (plan.contact_rows) contact_rows_ = plan.contact_rows();
  if (plan.couplings && !couplings_) couplings_ = plan.couplings->make_rows();
  if (plan.ellipsoid_rows && !ellipsoid_model_) ellipsoid_model_ = plan.ellipsoid_rows();
}

template <class T>
void InnerProblem<T>::reserve(const SolveCapacity& capacity) {
  const int dofs = capacity.dofs;
  most_entries_ = capacity.contact_entries;
  turn_.reserve(capacity.bodies);
  slide_.reserve(capacity.bodies);
  unknowns_.reserve(dofs);
  axes_.reserve(dofs, capacity.path_entries);
  for (TreeMatrix<T>* m : {&smooth_, &factor_}) m->reserve(dofs, capacity.path_entries);
  joints_.reserve(capacity.bodies, dofs);
  contact_rows_->reserve(capacity.contacts, capacity.contact_entries);
  if (couplings_) couplings_->reserve(capacity);
  joint_rows_.reserve(dofs * 8 + capacity.effect_rows);
  across_.reserve(groups_across(capacity), entries_across(capacity));
  path_.resize(TreePattern::padded(dofs));
  if (ellipsoid_model_) ellipsoid_model_->reserve(dofs / 3);
  for (auto* v : {&base_gradient_, &smooth_gradient_, &inner_gradient_, &step_, &product_, &correction_,
                  &correction_product_, &residual_, &preconditioned_, &direction_, &factored_})
    v->reserve(dofs);
}

template <class T>
void InnerProblem<T>::begin(const StepSettings<T>& settings, std::span<TreeProblem<T>* const> trees) {
  settings_ = &settings;
  trees_ = trees;
  factorisations = products = 0;
  products_are_dear_ = false;
  unknowns_.clear();
  int entries = 0;
  for (const TreeProblem<T>* p : trees_) entries += p->capacity.contact_entries;
  contact_rows_->limit(std::min(entries, most_entries_));
  for (TreeProblem<T>* p : trees_) p->first_unknown_map = append_unknowns<T>(*p->tree, p->free, unknowns_);
}

template <class T>
void InnerProblem<T>::build(std::span<const Contact<T>> contacts, std::span<Coupling<T>* const> couplings,
                            bool geometric) {
  axes_.clear();
  const bool alone = trees_.size() == 1 && couplings.empty();
  const bool joints_only = alone && trees_[0]->effects.empty() && !rounded();
  for (const TreeProblem<T>* p : trees_)
    if (!joints_only || !contacts.empty())
      axes_.append(*p->tree, p->kinematics, unknowns_, p->first_unknown_map);
  contact_rows_->collect(trees_, contacts, unknowns_, axes_, T(alone ? kNear : kNearOthers),
                         settings_->stick);
  articulated_ = joints_only && contact_rows_->empty();
  ellipsoids_ = rounded() ? ellipsoid_model_.get() : nullptr;
  if (ellipsoids_) ellipsoids_->collect(trees_, unknowns_);
  joint_rows_.clear();
  for (TreeProblem<T>* p : trees_)
    for (const JointRow<T>& row : p->rows)
      joint_rows_.push_back({row, unknown(*p, row.dof), row.value, T(0)});
  if (couplings_) couplings_->collect(trees_, couplings, unknowns_, axes_);
  const bool touch = trees_.size() > 1 && contact_rows_->coupled();
  geometry_ = !geometric ? Geometry::kNone
              : !touch   ? Geometry::kAll
              : tied()   ? Geometry::kTies
                         : Geometry::kNone;
  if (articulated_)
    assemble_articulated();
  else
    assemble(contacts, couplings);
  // The gradient without the rows', which are added back wherever they move.
  base_gradient_.assign(size(), T(0));
  for (const TreeProblem<T>* p : trees_)
    for (int dof = 0; dof < p->tree->dofs; ++dof)
      if (const int k = unknown(*p, dof); k >= 0) base_gradient_[k] = p->gradient[dof];
  smooth_gradient_.assign(size(), T(0));
  add_row_gradient(smooth_gradient_);
  for (int k = 0; k < size(); ++k) smooth_gradient_[k] = base_gradient_[k] - smooth_gradient_[k];
}

/// Whether some joint's muscles share an ellipsoidal limit at the trees' present poses.
template <class T>
bool InnerProblem<T>::rounded() const {
  return ellipsoid_model_ && std::any_of(trees_.begin(), trees_.end(),
                                         [](const TreeProblem<T>* p) { return !p->ellipsoids.empty(); });
}

template <class T>
void InnerProblem<T>::assemble(std::span<const Contact<T>> contacts,
                               std::span<Coupling<T>* const> couplings) {
  smooth_.set_zero();
  for (TreeProblem<T>* p : trees_) begin_composite(*settings_, *p);
  if (geometry_ == Geometry::kAll) contact_rows_->add_forces(trees_, contacts, settings_->stick);
  if (geometry_ == Geometry::kTies)
    for (TreeProblem<T>* p : trees_)
      for (Composite<T>& body : p->composite) {
        body.force.setZero();
        body.couple.setZero();
        body.virial.setZero();
      }
  if (geometric()) {
    for (const Coupling<T>* c : couplings)
      for (const CouplingNode<T>& node : c->nodes)
        if (node.tree >= 0) trees_[node.tree]->composite[node.body].add_force(node.point, node.gradient);
  }
  for (TreeProblem<T>* p : trees_) {
    assemble_tree_matrix<T>(*p->tree, p->kinematics, axes_, p->composite, unknowns_, p->first_unknown_map,
                            geometric(), smooth_);
    add_floor<T>(*p->tree, p->kinematics, p->composite, unknowns_, p->first_unknown_map, smooth_);
    if (p->stiff)
      add_stiffness<T>(*p->tree, p->kinematics, axes_, p->stiffness, unknowns_, p->first_unknown_map, path_,
                       smooth_);
    if (geometry_ == Geometry::kAll)
      add_joint_geometry(*p,
                         [&](int k, int l, T value) { smooth_.row(k)[unknowns_.pattern.depth[l]] += value; });
  }
  if (geometry_ == Geometry::kAll) contact_rows_->add_bending(smooth_);
  contact_rows_->add_sliding(smooth_);
  joins_loops_ = couplings_ && couplings_->loops_coupled();
}

/// H₀ of a tree on which nothing acts but what its joints do.
template <class T>
void InnerProblem<T>::assemble_articulated() {
  TreeProblem<T>& p = *trees_[0];
  begin_composite(*settings_, p);
  joints_.assemble(*p.tree, p.kinematics, p.composite, unknowns_, geometric());
  if (geometric() && !p.rows.empty())
    add_joint_geometry(p, [&](int k, int l, T value) { joints_.add(k, l, value); });
}

template <class T>
template <class Add>
void InnerProblem<T>::add_joint_geometry(TreeProblem<T>& p, const Add& add) {
  measure_joint_curvature(*settings_, p);
  const Tree<T>& tree = *p.tree;
  for (int i = 0; i < tree.bodies; ++i) {
    if (tree.type[i] != JointType::kBall && tree.type[i] != JointType::kFree) continue;
    const int k = unknown(p, tree.first_dof[i + 1] - 3);
    if (k < 0) continue;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b <= a; ++b) add(k + a, k + b, p.joint_curvature[i](a, b));
  }
}

template <class T>
void InnerProblem<T>::add_row_gradient(std::span<T> gradient) const {
  contact_rows_->add_gradient(gradient);
  if (ellipsoids_) ellipsoids_->add_gradient(gradient);
  for (const JointRows& rows : joint_rows_) {
    const JointRow<T>& row = rows.row;
    const T slope = row.slope(rows.value);
    for (int a = 0; a < row.count; ++a) gradient[rows.unknown + a] += slope * row.gradient[a];
  }
}

template <class T>
T InnerProblem<T>::row_slope(T t) const {
  T slope = contact_rows_->slope(t);
  if (ellipsoids_) slope += ellipsoids_->slope(t);
  for (const JointRows& rows : joint_rows_)
    slope += rows.row.slope(rows.value + t * rows.d_value) * rows.d_value;
  return slope;
}

/// Zero of the derivative t ↦ linear + t·quadratic + row_slope(t), which is increasing where the model is
/// convex.
template <class T>
T InnerProblem<T>::exact_line_search(T quadratic, T linear) const {
  const auto derivative = [&](T t) { return linear + t * quadratic + row_slope(t); };
  const T d0 = derivative(T(0));
  T low = T(0), d_low = d0, high = T(1), d_high = derivative(T(1));
  if (std::abs(d_high) <= T(0.02) * -d0) return high;
  for (int grow = 0; d_high < T(0) && grow < 3; ++grow) {
    if (-d_high < T(0.05) * -d0) return high;
    low = high;
    d_low = d_high;
    high *= 2;
    d_high = derivative(high);
  }
  if (d_high <= T(0)) return high;
  for (int iteration = 0; iteration < 40; ++iteration) {
    T t = low + (high - low) * (-d_low) / (d_high - d_low);  // secant, kept off the ends: kinks make it stall
    t = std::clamp(t, low + T(0.05) * (high - low), high - T(0.05) * (high - low));
    if (iteration % 3 == 2) t = (low + high) / 2;
    const T d = derivative(t);
    if (std::abs(d) <= T(0.02) * -d0 || high - low < T(1e-4) * high) return t;
    if (d < T(0)) {
      low = t;
      d_low = d;
    } else {
      high = t;
      d_high = d;
    }
  }
  return low > T(0) ? low : high;
}

template <class T>
void InnerProblem<T>::multiply_smooth(std::span<const T> x, std::span<T> y) {
  if (articulated_) return joints_.multiply(x, y);
  smooth_.multiply(x, y);
  if (geometry_ == Geometry::kAll && contact_rows_->coupled()) contact_rows_->multiply_bending(x, y);
  if (contact_rows_->coupled()) contact_rows_->multiply_sliding(x, y);
  if (tied()) couplings_->multiply(x, y);
}

template <class T>
void InnerProblem<T>::multiply_full(std::span<const T> x, std::span<T> y) {
  multiply_smooth(x, y);
  contact_rows_->multiply(x, y);
  if (ellipsoids_) ellipsoids_->multiply(x, y);
  for (const JointRows& rows : joint_rows_) {
    const JointRow<T>& row = rows.row;
    if (rows.in_factor <= T(0)) continue;
    T along = T(0);
    for (int a = 0; a < row.count; ++a) along += row.gradient[a] * x[rows.unknown + a];
    for (int a = 0; a < row.count; ++a) y[rows.unknown + a] += rows.in_factor * along * row.gradient[a];
  }
}

/// Adds the curvature of the joints' rows to a matrix.
template <class T>
template <class Add>
void InnerProblem<T>::add_row_curvature(T secant, const Add& add) {
  for (JointRows& rows : joint_rows_) {
    const JointRow<T>& row = rows.row;
    const T curvature = rows.in_factor = rows.curvature(secant);
    if (curvature <= T(0)) continue;
    for (int i = 0; i < row.count; ++i)
      for (int j = 0; j <= i; ++j)
        add(rows.unknown + i, rows.unknown + j, curvature * row.gradient[i] * row.gradient[j]);
  }
}

/// Of the model at the inner solution so far, but for what leaves the tree.
template <class T>
bool InnerProblem<T>::factorise(const Secants& secants) {
  SINEW_ZONE("factorise");
  ++factorisations;
  if (articulated_) {
    joints_.begin_factor();
    add_row_curvature(secants.muscles, [&](int k, int l, T value) { joints_.add_to_factor(k, l, value); });
    return joints_.factorise();
  }
  contact_rows_->measure_curvature(secants.slips);
  joins_contacts_ = products_are_dear_ && joins_loops_ && contact_rows_->coupled();
  for (;;) {
    factor_.values() = smooth_.values();
    if (tied()) couplings_->add_curvature(!joins_loops_, factor_);
    contact_rows_->add_curvature(factor_, !joins_contacts_);
    if (ellipsoids_) ellipsoids_->add_curvature(unknowns_, factor_);
    add_row_curvature(secants.muscles,
                      [&](int k, int l, T value) { factor_.row(k)[unknowns_.pattern.depth[l]] += value; });
    const bool definite = factor_.factorise();
    if (definite && join()) return true;
    // Where geometric terms of what is tied are indefinite but for the loops, a pass without them gets
    // further than conjugate gradients, which took thousands of products there.
    if (!definite && joins_loops_ && geometric()) return false;
    if (!joins_loops_) return false;
    if (!joins_contacts_) joins_loops_ = false;
    joins_contacts_ = products_are_dear_ = false;
  }
}

/// Joins what couples paths to the factor, as far as that is meant to be. False where it cannot.
template <class T>
bool InnerProblem<T>::join() {
  across_.clear();
  if (joins_loops_ && !couplings_->add_rows(across_)) return false;
  across_.allow(kMostJoined, kMostJoinedEntries);
  if (joins_contacts_ && !contact_rows_->add_rows(unknowns_.pattern, across_)) return false;
  return across_.factorise(factor_);
}

template <class T>
void InnerProblem<T>::solve_factored(std::span<T> b) {
  if (articulated_)
    joints_.solve(b);
  else if (!across_.empty())
    across_.solve(factor_, b);
  else
    factor_.solve(b);
}

/// Whether ties couple unknowns that the factor does not, or anything does.
template <class T>
bool InnerProblem<T>::ties_left() const {
  return couplings_ && (couplings_->others_coupled() || (!joins_loops_ && couplings_->loops_coupled()));
}

template <class T>
bool InnerProblem<T>::left_out() const {
  if (ties_left()) return true;
  if (!joins_contacts_) return contact_rows_->coupled();
  return contact_rows_->slides_across() || (geometry_ == Geometry::kAll && contact_rows_->bends_across());
}

/// Whether the last factor still holds what rows curve by now; what leaves the tree it never does.
template <class T>
bool InnerProblem<T>::factor_holds(const Secants& secants) const {
  return !ellipsoids_ && !ties_left() && contact_rows_->in_factor(secants.slips, !joins_contacts_) &&
         std::all_of(joint_rows_.begin(), joint_rows_.end(),
                     [&](const JointRows& r) { return r.in_factor == r.curvature(secants.muscles); });
}

/// step_ = −H⁻¹·inner_gradient_ at the inner solution so far. May `reuse` the last factor.
template <class T>
bool InnerProblem<T>::newton_step(const Secants& secants, bool reuse) {
  const bool holds = reuse && factor_holds(secants);
  if (!holds && !factorise(secants)) return false;
  if (!holds && left_out()) return conjugate_gradients();
  for (int k = 0; k < size(); ++k) step_[k] = -inner_gradient_[k];
  solve_factored(step_);
  return true;
}

/// Solves with the whole matrix A, the factor F as preconditioner. Where what contacts couple is all that the
/// two differ by, F·direction follows from the residuals: a product costs the coupling alone. Where curvature
/// turns negative on the way, the step so far is a descent direction (truncated Newton); false if that
/// happens at once, or with couplings: there a pass without geometric terms gets further (hands on a wheel: 7
/// passes instead of 10 at the 99th percentile, a massless spin between loops 20 instead of 60).
template <class T>
bool InnerProblem<T>::conjugate_gradients() {
  std::fill(step_.begin(), step_.end(), T(0));
  for (int k = 0; k < size(); ++k) residual_[k] = -inner_gradient_[k];
  preconditioned_ = residual_;
  solve_factored(preconditioned_);
  direction_ = preconditioned_;
  factored_ = residual_;
  T energy = dot<T>(residual_, preconditioned_);
  const T goal = energy * T(kCgTolerance * kCgTolerance);
  T far = ties_left() ? T(0) : energy * T(kCgFar * kCgFar);
  const int most = ties_left() ? std::max(kMostProducts, 2 * size()) : kMostProducts;
  for (int iteration = 0; iteration < most && energy > goal; ++iteration) {
    if (energy <= far) {
      if (displacement(step_) > T(kFar)) return true;
      far = T(0);
    }
    if (ties_left()) {
      multiply_full(direction_, product_);
    } else {
      product_ = factored_;
      if (!joins_contacts_) contact_rows_->multiply_coupling(direction_, product_);
      if (geometry_ == Geometry::kAll) contact_rows_->multiply_bending(direction_, product_);
      contact_rows_->multiply_sliding(direction_, product_);
    }
    ++products;
    if (iteration == kFewProducts) products_are_dear_ = true;
    const T curvature = dot<T>(direction_, product_);
    if (!(curvature > T(0))) return iteration > 0 && !tied();
    const T length = energy / curvature;
    for (int k = 0; k < size(); ++k) {
      step_[k] += length * direction_[k];
      residual_[k] -= length * product_[k];
    }
    preconditioned_ = residual_;
    solve_factored(preconditioned_);
    const T next = dot<T>(residual_, preconditioned_);
    const T ratio = next / energy;
    energy = next;
    for (int k = 0; k < size(); ++k) {
      direction_[k] = preconditioned_[k] + ratio * direction_[k];
      factored_[k] = residual_[k] + ratio * factored_[k];
    }
  }
  return true;
}

/// The step that the last factor would take now is residual_; its length (m) is small where the step before
/// met no new kink.
template <class T>
double InnerProblem<T>::remaining_step() {
  for (int k = 0; k < size(); ++k) residual_[k] = -inner_gradient_[k];
  solve_factored(residual_);
  return double(displacement(residual_));
}

template <class T>
InnerReport InnerProblem<T>::minimise(T tolerance) {
  InnerReport report;
  const int n = size();
  for (auto* v :
       {&step_, &correction_, &product_, &correction_product_, &residual_, &preconditioned_, &direction_})
    v->assign(n, T(0));
  inner_gradient_ = smooth_gradient_;
  add_row_gradient(inner_gradient_);
  double moved = 0;
  Secants secants{T(kLeastDrag), T(0)};
  const auto enough = [&] { return kShrink * std::min(report.first_length, moved); };
  for (int iteration = 0; iteration < kMostInnerSteps; ++iteration) {
    if (!newton_step(secants, iteration > 0 && has_contacts())) return report;
    const T length = displacement(step_);
    if (!std::isfinite(length)) return report;
    if (iteration == 0) report.first_length = double(length);
    const bool last = (iteration > 0 && double(length) < enough()) || length < T(0.1) * tolerance;
    contact_rows_->look_along(step_);
    if (ellipsoids_) ellipsoids_->look_along(step_);
    for (JointRows& rows : joint_rows_) {
      const JointRow<T>& row = rows.row;
      rows.d_value = T(0);
      for (int a = 0; a < row.count; ++a) rows.d_value += row.gradient[a] * step_[rows.unknown + a];
    }
    // Where no row has a kink on the way, the model is quadratic there and the step exact.
    const bool straight =
        contact_rows_->empty() && !ellipsoids_ &&
        std::none_of(joint_rows_.begin(), joint_rows_.end(), [](const JointRows& r) { return r.bends(); });
    report.straight = straight && iteration == 0;
    if (straight) {
      for (int k = 0; k < n; ++k) correction_[k] += step_[k];
      break;
    }
    multiply_smooth(step_, product_);
    T quadratic = T(0), linear = T(0);
    for (int k = 0; k < n; ++k) {
      quadratic += step_[k] * product_[k];
      linear += step_[k] * (smooth_gradient_[k] + correction_product_[k]);
    }
    const T t = exact_line_search(quadratic, linear);
    for (int k = 0; k < n; ++k) {
      correction_[k] += t * step_[k];
      correction_product_[k] += t * product_[k];
      inner_gradient_[k] = smooth_gradient_[k] + correction_product_[k];
    }
    moved += double(t * length);
    if (t > T(kTooShort)) secants = {secants.slips * T(kRelease), secants.muscles * T(kRelease)};
    if (t < T(kCutShort) && coupled()) secants.muscles = T(1);
    contact_rows_->move(t);
    if (ellipsoids_) ellipsoids_->move(t);
    for (JointRows& rows : joint_rows_) rows.value += t * rows.d_value;
    if (last) break;
    add_row_gradient(inner_gradient_);
    if (!left_out() && remaining_step() < enough()) {
      for (int k = 0; k < n; ++k) correction_[k] += residual_[k];
      break;
    }
  }
  report.solved = true;
  return report;
}

template <class T>
void InnerProblem<T>::correct(std::span<const Contact<T>> contacts) {
  contact_rows_->look_along(correction_);
  contact_rows_->correct(contacts);
  if (ellipsoids_) ellipsoids_->rewind();
  for (JointRows& rows : joint_rows_) rows.value = rows.row.value;
}

template <class T>
double InnerProblem<T>::simplified_newton_step(std::span<const Contact<T>> contacts) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  if (ellipsoids_ ? !ellipsoids_->measure(trees_) : rounded()) return kNone;
  contact_rows_->measure(contacts);
  std::size_t n = 0;
  for (const TreeProblem<T>* p : trees_) {
    if (n + p->rows.size() > joint_rows_.size()) return kNone;
    for (const JointRow<T>& row : p->rows) {
      JointRows& mine = joint_rows_[n++];
      if (row.dof != mine.row.dof || row.kind != mine.row.kind || row.scalar != mine.row.scalar) return kNone;
      mine.value = row.value;
    }
    for (int dof = 0; dof < p->tree->dofs; ++dof)
      if (const int k = unknown(*p, dof); k >= 0) inner_gradient_[k] = p->gradient[dof];
  }
  if (n != joint_rows_.size()) return kNone;
  if (!newton_step({}, true)) return kNone;
  correction_ = step_;
  return double(displacement(correction_));
}

template <class T>
T InnerProblem<T>::slope(std::span<const T> direction) const {
  return dot<T>(base_gradient_, direction);
}

template <class T>
T InnerProblem<T>::slope_now(std::span<const T> direction) const {
  T sum = T(0);
  for (const TreeProblem<T>* p : trees_)
    for (int dof = 0; dof < p->tree->dofs; ++dof)
      if (const int k = unknown(*p, dof); k >= 0) sum += p->gradient[dof] * direction[k];
  return sum;
}

template <class T>
T InnerProblem<T>::displacement(std::span<const T> direction) const {
  T largest = T(0);
  bool finite = true;
  for (const TreeProblem<T>* p : trees_) {
    const Tree<T>& tree = *p->tree;
    turn_.resize(tree.bodies);
    slide_.resize(tree.bodies);
    for (int i = 0; i < tree.bodies; ++i) {
      const int parent = tree.parent[i];
      Vec3<T> w = parent < 0 ? Vec3<T>(Vec3<T>::Zero()) : turn_[parent];
      Vec3<T> v = parent < 0 ? Vec3<T>(Vec3<T>::Zero()) : slide_[parent];
      for (int dof = tree.first_dof[i]; dof < tree.first_dof[i + 1]; ++dof) {
        const int k = unknown(*p, dof);
        if (k < 0) continue;
        w += p->kinematics.w[dof] * direction[k];
        v += p->kinematics.v[dof] * direction[k];
      }
      turn_[i] = w;
      slide_[i] = v;
      if (tree.mass[i] <= T(0)) continue;  // nobody sees where a massless link spins between ball joints
      const T moved =
          (v + w.cross(p->kinematics.center[i])).norm() / tree.scale.length + T(kRotationArm) * w.norm();
      finite = finite && std::isfinite(moved);
      largest = std::max(largest, moved);
    }
  }
  return finite ? largest : std::numeric_limits<T>::infinity();
}

template class InnerProblem<float>;
template class InnerProblem<double>;

}  // namespace sinew
