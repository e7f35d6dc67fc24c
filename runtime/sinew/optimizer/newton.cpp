#include "sinew/optimizer/newton.h"

#include <algorithm>
#include <cmath>

#include "sinew/optimizer/joint_terms.h"

namespace sinew {
namespace {

constexpr double kInnerShrink = 0.1;  ///< tighter stops: fewer outer passes, more factorisations (prototype)
constexpr int kInnerCap = 8;
constexpr double kCertainRate = 0.1;
constexpr double kNear = 0.1;          ///< m; contacts further away are left out of the inner problem
constexpr double kRotationArm = 0.15;  ///< m; turns a rotation into a displacement for the tolerance

}  // namespace

template <class T>
void NewtonSolver<T>::reserve(int dofs, int bodies, int contacts) {
  unknowns_.reserve(dofs);
  chain_.reserve(dofs);
  smooth_.reserve(dofs * (dofs + 1) / 2);
  smooth_dense_.reserve(dofs * (dofs + 1) / 2);
  full_.reserve(dofs * (dofs + 1) / 2);
  full_dense_.reserve(dofs * (dofs + 1) / 2);
  contact_rows_.reserve(contacts);
  index_.reserve(contacts * 48);
  jacobian_.reserve(contacts * 48);
  joint_rows_.reserve(dofs * 8);
  for (auto* v : {&base_gradient_, &smooth_gradient_, &inner_gradient_, &step_, &correction_, &product_,
                  &correction_product_, &plain_})
    v->reserve(dofs);
  base_.reserve(bodies);
}

template <class T>
double NewtonSolver<T>::evaluate() {
  ++report_.evaluations;
  double energy = 0;
  for (TreeProblem<T>* p : trees_) energy += begin_evaluation(*settings_, *p);
  for (Contact<T>& c : contacts_) {
    TreeProblem<T>& a = *trees_[c.tree_a];
    TreeProblem<T>* b = c.tree_b < 0 ? nullptr : trees_[c.tree_b];
    measure(a.kinematics, b ? &b->kinematics : nullptr, c);
    energy += double(ContactLaw<T>::energy(c.stiffness, c.gap));
    const T pressure = ContactLaw<T>::force(c.stiffness, c.gap);
    if (pressure > T(0)) {
      const Vec3<T> f = -pressure * c.normal;
      a.force[c.body_a] += f;
      a.moment[c.body_a] += c.point.cross(f);
      if (b) {
        b->force[c.body_b] -= f;
        b->moment[c.body_b] -= c.point.cross(f);
      }
    }
    const T grip = c.friction * c.lagged_normal_force;
    if (grip > T(0)) {
      const T slip = std::hypot(c.slip[0], c.slip[1]);
      energy += double(grip * FrictionLaw<T>::energy(slip, settings_->stick));
      const T scale = grip * FrictionLaw<T>::slope_over_slip(slip, settings_->stick);
      const Vec3<T> f = scale * (c.slip[0] * c.frame.col(0) + c.slip[1] * c.frame.col(1));
      a.force[c.body_a] += f;
      a.moment[c.body_a] += c.material_point.cross(f);
      if (b) {
        b->force[c.body_b] -= f;
        b->moment[c.body_b] -= c.material_point_b.cross(f);
      }
    }
  }
  for (TreeProblem<T>* p : trees_) finish_gradient(*p);
  return energy;
}

template <class T>
void NewtonSolver<T>::add_path(const Contact<T>& c, int tree, int body, const Vec3<T>& material, T sign,
                               ContactRows& rows) {
  const TreeProblem<T>& p = *trees_[tree];
  int dof = -1;
  for (int i = body; i >= 0 && dof < 0; i = p.tree->parent[i])
    if (p.tree->dof_count(i) > 0) dof = p.tree->first_dof[i + 1] - 1;
  const int begin = static_cast<int>(index_.size());
  for (; dof >= 0; dof = p.tree->dof_parent[dof]) {
    const int k = unknowns_.of_dof[p.first_unknown_map + dof];
    if (k < 0) continue;
    const Vec3<T>& w = p.kinematics.w[dof];
    const Vec3<T>& v = p.kinematics.v[dof];
    const T gap = sign * c.normal.dot(v + w.cross(c.point));
    const Vec3<T> moved = sign * (v + w.cross(material));
    const std::array<T, 3> entry{gap, c.frame.col(0).dot(moved), c.frame.col(1).dot(moved)};
    // Self contact: both sides may share unknowns near the root.
    bool merged = false;
    for (int e = rows.first; e < begin && !merged; ++e) {
      if (index_[e] != k) continue;
      for (int a = 0; a < 3; ++a) jacobian_[e][a] += entry[a];
      merged = true;
    }
    if (merged) continue;
    index_.push_back(k);
    jacobian_.push_back(entry);
  }
  rows.count = static_cast<int>(index_.size()) - rows.first;
}

template <class T>
void NewtonSolver<T>::collect_rows() {
  contact_rows_.clear();
  index_.clear();
  jacobian_.clear();
  joint_rows_.clear();
  coupled_ = false;
  for (std::size_t n = 0; n < contacts_.size(); ++n) {
    const Contact<T>& c = contacts_[n];
    if (c.gap > T(kNear)) continue;
    ContactRows rows;
    rows.contact = static_cast<int>(n);
    rows.first = static_cast<int>(index_.size());
    rows.gap = c.gap;
    rows.slip[0] = c.slip[0];
    rows.slip[1] = c.slip[1];
    add_path(c, c.tree_a, c.body_a, c.material_point, T(1), rows);
    const int first_side = rows.count;
    if (c.tree_b >= 0) add_path(c, c.tree_b, c.body_b, c.material_point_b, T(-1), rows);
    if (rows.count == 0) continue;
    if (first_side > 0 && rows.count > first_side) coupled_ = true;
    contact_rows_.push_back(rows);
  }
  for (TreeProblem<T>* p : trees_)
    for (std::size_t r = 0; r < p->rows.size(); ++r)
      joint_rows_.push_back(
          {p->rows[r], unknowns_.of_dof[p->first_unknown_map + p->rows[r].dof], p->rows[r].value, T(0)});
}

template <class T>
void NewtonSolver<T>::add_joint_curvature(TreeProblem<T>& p) {
  measure_joint_curvature(p);
  const Tree<T>& tree = *p.tree;
  for (int i = 0; i < tree.bodies; ++i) {
    if (tree.type[i] != JointType::kBall && tree.type[i] != JointType::kFree) continue;
    const int first = tree.first_dof[i + 1] - 3;
    const int k = unknowns_.of_dof[p.first_unknown_map + first];
    if (k < 0) continue;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b <= a; ++b)
        smooth_.row(k + a)[unknowns_.pattern.depth[k + b]] += p.joint_curvature[i](a, b);
  }
}

template <class T>
void NewtonSolver<T>::assemble(bool geometric) {
  smooth_.set_zero();
  for (TreeProblem<T>* p : trees_) {
    begin_composite(*p);
    if (geometric) {
      for (const Contact<T>& c : contacts_) {
        const T pressure = ContactLaw<T>::force(c.stiffness, c.gap);
        const T grip = c.friction * c.lagged_normal_force;
        const T slip = std::hypot(c.slip[0], c.slip[1]);
        const T scale = grip > T(0) ? grip * FrictionLaw<T>::slope_over_slip(slip, settings_->stick) : T(0);
        const Vec3<T> normal = -pressure * c.normal;
        const Vec3<T> tangent = scale * (c.slip[0] * c.frame.col(0) + c.slip[1] * c.frame.col(1));
        if (trees_[c.tree_a] == p) {
          p->composite[c.body_a].add_force(c.point, normal);
          p->composite[c.body_a].add_force(c.material_point, tangent);
        }
        if (c.tree_b >= 0 && trees_[c.tree_b] == p) {
          p->composite[c.body_b].add_force(c.point, -normal);
          p->composite[c.body_b].add_force(c.material_point_b, -tangent);
        }
      }
    }
    assemble_tree_matrix<T>(*p->tree, p->kinematics, p->composite, unknowns_, p->first_unknown_map, geometric,
                            smooth_);
    if (geometric) add_joint_curvature(*p);
  }
  if (!coupled_) return;
  smooth_dense_.set_zero();
  for (int k = 0; k < unknowns_.pattern.size; ++k)
    for (int l = k; l >= 0; l = unknowns_.pattern.parent[l])
      smooth_dense_.row(k)[l] = smooth_.row(k)[unknowns_.pattern.depth[l]];
}

template <class T>
void NewtonSolver<T>::add_row_curvature() {
  TreeMatrix<T>& h = coupled_ ? full_dense_ : full_;
  const std::vector<int>& position = pattern_->depth;
  for (const ContactRows& rows : contact_rows_) {
    const Contact<T>& c = contacts_[rows.contact];
    const T normal = ContactLaw<T>::curvature(c.stiffness, rows.gap);
    const T grip = c.friction * c.lagged_normal_force;
    T along = T(0), across = T(0), direction[2] = {T(1), T(0)};
    if (grip > T(0)) {
      const T slip = std::hypot(rows.slip[0], rows.slip[1]);
      across = grip * FrictionLaw<T>::slope_over_slip(slip, settings_->stick);
      along = slip > T(0) ? grip * FrictionLaw<T>::curvature(slip, settings_->stick) : across;
      if (slip > T(0)) {
        direction[0] = rows.slip[0] / slip;
        direction[1] = rows.slip[1] / slip;
      }
    }
    if (normal <= T(0) && across <= T(0)) continue;
    for (int i = rows.first; i < rows.first + rows.count; ++i) {
      const std::array<T, 3>& ji = jacobian_[i];
      const T gi = normal * ji[0];
      const T ai = along * (direction[0] * ji[1] + direction[1] * ji[2]);
      const T bi = across * (direction[0] * ji[2] - direction[1] * ji[1]);
      for (int j = rows.first; j < rows.first + rows.count; ++j) {
        if (index_[j] > index_[i]) continue;
        const std::array<T, 3>& jj = jacobian_[j];
        h.row(index_[i])[position[index_[j]]] += gi * jj[0] +
                                                 ai * (direction[0] * jj[1] + direction[1] * jj[2]) +
                                                 bi * (direction[0] * jj[2] - direction[1] * jj[1]);
      }
    }
  }
  for (const JointRows& rows : joint_rows_) {
    const JointRow<T>& row = rows.row;
    const T curvature = row.curvature(rows.value);
    if (curvature <= T(0)) continue;
    for (int i = 0; i < row.count; ++i)
      for (int j = 0; j <= i; ++j)
        h.row(rows.unknown + i)[position[rows.unknown + j]] += curvature * row.gradient[i] * row.gradient[j];
  }
}

template <class T>
void NewtonSolver<T>::directional_rows(std::span<const T> direction) {
  for (ContactRows& rows : contact_rows_) {
    rows.d_gap = rows.d_slip[0] = rows.d_slip[1] = T(0);
    for (int e = rows.first; e < rows.first + rows.count; ++e) {
      const T d = direction[index_[e]];
      rows.d_gap += jacobian_[e][0] * d;
      rows.d_slip[0] += jacobian_[e][1] * d;
      rows.d_slip[1] += jacobian_[e][2] * d;
    }
  }
  for (JointRows& rows : joint_rows_) {
    const JointRow<T>& row = rows.row;
    rows.d_value = T(0);
    for (int a = 0; a < row.count; ++a) rows.d_value += row.gradient[a] * direction[rows.unknown + a];
  }
}

template <class T>
T NewtonSolver<T>::row_slope(T t) const {
  T slope = T(0);
  for (const ContactRows& rows : contact_rows_) {
    const Contact<T>& c = contacts_[rows.contact];
    slope -= ContactLaw<T>::force(c.stiffness, rows.gap + t * rows.d_gap) * rows.d_gap;
    if (const T grip = c.friction * c.lagged_normal_force; grip > T(0)) {
      const T s0 = rows.slip[0] + t * rows.d_slip[0], s1 = rows.slip[1] + t * rows.d_slip[1];
      slope += grip * FrictionLaw<T>::slope_over_slip(std::hypot(s0, s1), settings_->stick) *
               (s0 * rows.d_slip[0] + s1 * rows.d_slip[1]);
    }
  }
  for (const JointRows& rows : joint_rows_)
    slope += rows.row.slope(rows.value + t * rows.d_value) * rows.d_value;
  return slope;
}

template <class T>
void NewtonSolver<T>::add_row_gradient(std::span<T> gradient) const {
  for (const ContactRows& rows : contact_rows_) {
    const Contact<T>& c = contacts_[rows.contact];
    const T pressure = ContactLaw<T>::force(c.stiffness, rows.gap);
    const T grip = c.friction * c.lagged_normal_force;
    const T scale = grip > T(0) ? grip * FrictionLaw<T>::slope_over_slip(
                                             std::hypot(rows.slip[0], rows.slip[1]), settings_->stick)
                                : T(0);
    if (pressure <= T(0) && scale <= T(0)) continue;
    for (int e = rows.first; e < rows.first + rows.count; ++e)
      gradient[index_[e]] += -pressure * jacobian_[e][0] +
                             scale * (rows.slip[0] * jacobian_[e][1] + rows.slip[1] * jacobian_[e][2]);
  }
  for (const JointRows& rows : joint_rows_) {
    const JointRow<T>& row = rows.row;
    const T slope = row.slope(rows.value);
    for (int a = 0; a < row.count; ++a) gradient[rows.unknown + a] += slope * row.gradient[a];
  }
}

/// Zero of the derivative t ↦ linear + t·quadratic + row_slope(t), which is increasing where the inner
/// problem is convex.
template <class T>
T NewtonSolver<T>::exact_line_search(T quadratic, T linear) const {
  const auto derivative = [&](T t) { return linear + t * quadratic + row_slope(t); };
  const T d0 = derivative(T(0));
  T low = T(0), d_low = d0, high = T(1), d_high = derivative(T(1));
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
    if (std::abs(d) <= T(0.02) * -d0 || high - low < T(1e-4)) return t;
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
T NewtonSolver<T>::displacement(std::span<const T> direction) const {
  T largest = T(0);
  for (TreeProblem<T>* p : trees_) {
    const Tree<T>& tree = *p->tree;
    // `force` and `moment` are scratch between a gradient and the next evaluation: (w, v) of every body.
    for (int i = 0; i < tree.bodies; ++i) {
      const int parent = tree.parent[i];
      Vec3<T> w = parent < 0 ? Vec3<T>(Vec3<T>::Zero()) : p->force[parent];
      Vec3<T> v = parent < 0 ? Vec3<T>(Vec3<T>::Zero()) : p->moment[parent];
      for (int dof = tree.first_dof[i]; dof < tree.first_dof[i + 1]; ++dof) {
        const int k = unknowns_.of_dof[p->first_unknown_map + dof];
        if (k < 0) continue;
        w += p->kinematics.w[dof] * direction[k];
        v += p->kinematics.v[dof] * direction[k];
      }
      p->force[i] = w;
      p->moment[i] = v;
      largest = std::max(largest, (v + w.cross(p->kinematics.center[i])).norm() + T(kRotationArm) * w.norm());
    }
  }
  return largest;
}

template <class T>
T NewtonSolver<T>::gradient_dot(std::span<const T> direction) const {
  T sum = T(0);
  for (const TreeProblem<T>* p : trees_)
    for (int dof = 0; dof < p->tree->dofs; ++dof)
      if (const int k = unknowns_.of_dof[p->first_unknown_map + dof]; k >= 0)
        sum += p->gradient[dof] * direction[k];
  return sum;
}

/// Splits the gradient at the chart centres into its smooth part and the rows', which are added back wherever
/// they move.
template <class T>
void NewtonSolver<T>::begin_inner() {
  pattern_ = coupled_ ? &chain_ : &unknowns_.pattern;
  base_gradient_.assign(unknowns_.pattern.size, T(0));
  for (const TreeProblem<T>* p : trees_)
    for (int dof = 0; dof < p->tree->dofs; ++dof)
      if (const int k = unknowns_.of_dof[p->first_unknown_map + dof]; k >= 0)
        base_gradient_[k] = p->gradient[dof];
  smooth_gradient_.assign(unknowns_.pattern.size, T(0));
  add_row_gradient(smooth_gradient_);
  for (int k = 0; k < unknowns_.pattern.size; ++k)
    smooth_gradient_[k] = base_gradient_[k] - smooth_gradient_[k];
}

/// Minimises the convex model from the chart centres, with the rows as they stand.
template <class T>
bool NewtonSolver<T>::inner_solve(T tolerance, T& first_length) {
  const int n = unknowns_.pattern.size;
  const TreeMatrix<T>& smooth = coupled_ ? smooth_dense_ : smooth_;
  TreeMatrix<T>& full = coupled_ ? full_dense_ : full_;
  for (auto* v : {&step_, &correction_, &product_, &correction_product_}) v->assign(n, T(0));
  inner_gradient_.assign(smooth_gradient_.begin(), smooth_gradient_.end());
  add_row_gradient(inner_gradient_);
  for (int iteration = 0; iteration < kInnerCap; ++iteration) {
    full.values() = smooth.values();
    add_row_curvature();
    ++report_.factorisations;
    if (!full.factorise()) return false;
    for (int k = 0; k < n; ++k) step_[k] = -inner_gradient_[k];
    full.solve(step_);
    const T length = displacement(step_);
    if (!std::isfinite(length)) return false;
    if (iteration == 0) first_length = length;
    const bool last =
        (iteration > 0 && length < T(kInnerShrink) * first_length) || length < T(0.1) * tolerance;
    directional_rows(step_);
    smooth.multiply(step_, product_);
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
    for (ContactRows& rows : contact_rows_) {
      rows.gap += t * rows.d_gap;
      rows.slip[0] += t * rows.d_slip[0];
      rows.slip[1] += t * rows.d_slip[1];
    }
    for (JointRows& rows : joint_rows_) rows.value += t * rows.d_value;
    if (last) break;
    add_row_gradient(inner_gradient_);
  }
  return true;
}

template <class T>
void NewtonSolver<T>::try_step(T t) {
  std::size_t first = 0;
  for (TreeProblem<T>* p : trees_) {
    const Tree<T>& tree = *p->tree;
    for (int i = 0; i < tree.bodies; ++i) {
      T d[6] = {};
      bool moves = false;
      for (int dof = tree.first_dof[i]; dof < tree.first_dof[i + 1]; ++dof) {
        const int k = unknowns_.of_dof[p->first_unknown_map + dof];
        if (k < 0) continue;
        d[dof - tree.first_dof[i]] = t * correction_[k];
        moves = true;
      }
      p->local[i] = moves ? displaced<T>(tree, i, base_[first + i], d) : base_[first + i];
    }
    first += tree.bodies;
  }
}

/// A step is accepted when it lowers the energy, judged by the directional derivative where differences of
/// energies drown in rounding (near the solution in float: always).
template <class T>
bool NewtonSolver<T>::accepted(T t, T slope, double energy, double new_energy) const {
  if (!std::isfinite(new_energy)) return false;
  const bool calmer = std::abs(gradient_dot(correction_)) <= T(0.9) * std::abs(slope);
  if (trees_[0]->prediction.scheme == Scheme::kMomentum) return calmer;
  const double noise = (sizeof(T) == 4 ? 2e-5 : 1e-11) * (1 + std::abs(energy));
  return new_energy <= energy + 1e-4 * double(t * slope) || (new_energy <= energy + noise && calmer);
}

/// Second-order correction after a full step that failed: gaps and slips are re-measured where it led, the
/// convex model is solved once more with them and the old Jacobian, and that step is tried. Undone when it
/// fails too.
template <class T>
bool NewtonSolver<T>::correct_step(T tolerance, double energy, double& new_energy) {
  plain_.assign(correction_.begin(), correction_.end());
  directional_rows(correction_);
  for (ContactRows& rows : contact_rows_) {
    const Contact<T>& c = contacts_[rows.contact];
    rows.gap = c.gap - rows.d_gap;
    rows.slip[0] = c.slip[0] - rows.d_slip[0];
    rows.slip[1] = c.slip[1] - rows.d_slip[1];
  }
  for (JointRows& rows : joint_rows_) rows.value = rows.row.value;
  T first_length = T(0);
  if (inner_solve(tolerance, first_length)) {
    T slope = T(0);
    for (std::size_t k = 0; k < correction_.size(); ++k) slope += base_gradient_[k] * correction_[k];
    if (slope < T(0)) {
      try_step(T(1));
      new_energy = evaluate();
      if (accepted(T(1), slope, energy, new_energy)) return true;
    }
  }
  correction_.assign(plain_.begin(), plain_.end());
  return false;
}

template <class T>
bool NewtonSolver<T>::line_search(T tolerance, double energy, double& new_energy, bool& full_step) {
  T slope = T(0);
  for (std::size_t k = 0; k < correction_.size(); ++k) slope += base_gradient_[k] * correction_[k];
  T t = T(1);
  for (int attempt = 0; attempt < 14; ++attempt) {
    try_step(t);
    new_energy = evaluate();
    if (accepted(t, slope, energy, new_energy)) {
      full_step = attempt == 0;
      return true;
    }
    const T new_slope = gradient_dot(correction_);
    if (attempt == 0 && !contact_rows_.empty() && correct_step(tolerance, energy, new_energy)) return true;
    const T secant = new_slope > T(0) ? -slope / (new_slope - slope) : T(0.5);
    t *= std::clamp(secant, T(0.1), T(0.6));
  }
  try_step(T(0));
  new_energy = evaluate();
  return false;
}

template <class T>
SolveReport NewtonSolver<T>::solve(const StepSettings<T>& settings, const Accuracy& accuracy,
                                   std::span<TreeProblem<T>* const> trees, std::span<Contact<T>> contacts) {
  settings_ = &settings;
  trees_ = trees;
  contacts_ = contacts;
  report_ = {};
  unknowns_.clear();
  chain_.clear();
  for (TreeProblem<T>* p : trees_) p->first_unknown_map = append_unknowns<T>(*p->tree, p->free, unknowns_);
  for (int k = 0; k < unknowns_.pattern.size; ++k) chain_.add(k - 1);

  double energy = evaluate();
  if (unknowns_.pattern.size == 0) {
    report_.converged = true;
    report_.energy = energy;
    return report_;
  }
  const T tolerance = T(accuracy.tolerance);
  T last_length = T(0);  // of the pass before, when it was a plain full step; 0 else
  for (; report_.outer_passes < accuracy.max_iterations && !report_.converged;) {
    ++report_.outer_passes;
    T first_length = T(0);
    bool solved = false;
    for (const bool geometric : {true, false}) {
      collect_rows();
      assemble(geometric);
      begin_inner();
      solved = inner_solve(tolerance, first_length);
      if (solved) break;
    }
    if (!solved) break;
    // A rotation vector is good for about one radian.
    const T longest = std::abs(*std::max_element(correction_.begin(), correction_.end(),
                                                 [](T a, T b) { return std::abs(a) < std::abs(b); }));
    if (longest > T(1))
      for (T& d : correction_) d /= longest;
    const T length = displacement(correction_);
    // The second clause is needed: a truncated inner solve alone passed with errors up to 173 mm.
    const bool small = length < tolerance && first_length < 2 * tolerance;
    // Full Newton steps shrink at least linearly: what is left after this one is below length·rate.
    const bool certain = last_length > T(0) && length < T(kCertainRate) * last_length &&
                         length * (length / last_length) < T(0.3) * tolerance &&
                         first_length < T(1.5) * length;
    base_.clear();
    for (const TreeProblem<T>* p : trees_) base_.insert(base_.end(), p->local.begin(), p->local.end());
    double new_energy = energy;
    bool full_step = false;
    const bool moved = line_search(tolerance, energy, new_energy, full_step);
    energy = new_energy;
    report_.converged = small || (certain && full_step);
    last_length = full_step && longest <= T(1) ? length : T(0);
    if (!moved) break;
  }
  report_.energy = energy;
  return report_;
}

template class NewtonSolver<float>;
template class NewtonSolver<double>;

}  // namespace sinew
