// InnerProblem for packs: the convex model of an outer pass, without contacts, its decisions as masks. Kernel
// translation units only. Everything in the order of inner_problem.cpp, so that lanes have a solve's own
// bits.
#pragma once

#include "sinew/optimizer/kernels/pack_problem.h"
#include "sinew/optimizer/newton_constants.h"

namespace sinew::newton_kernels {
namespace {

template <class P>
P dot(std::span<const P> a, std::span<const P> b) {
  P sum = P(0);
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

/// Counts what happens in the lanes of a mask.
template <class P>
void count(const MaskOf<P>& mask, SolveReport* reports, int SolveReport::*what) {
  for (int lane = 0; lane < P::kLanes; ++lane) reports[lane].*what += mask.lane(lane);
}

template <class P>
class PackInner {
 public:
  using Live = MaskOf<P>;
  static Live all(bool set) { return Live::all(set); }

  void lay_out(const Shape& shape, Arena& memory) {
    for (auto* s : {&matrix_.own, &matrix_.factor}) memory.take(*s, shape.dofs);
    for (auto* s : {&matrix_.axes, &matrix_.moved, &matrix_.reduced}) memory.take(*s, shape.dofs);
    for (auto* s : {&matrix_.force, &matrix_.motion}) memory.take(*s, shape.bodies);
    memory.take(matrix_.eliminated, shape.bodies);
    memory.take(matrix_.blocks, shape.bodies);
    memory.take(matrix_.first, shape.dofs);
    for (auto* s : {&base_gradient_, &smooth_gradient_, &inner_gradient_, &step_, &product_, &correction_,
                    &correction_product_, &residual_})
      memory.take(*s, shape.dofs);
    for (auto* s : {&turn_, &slide_}) memory.take(*s, shape.bodies);
  }

  void begin(const Batch& batch, PackProblem<P>& problem) {
    problem_ = &problem;
    unknowns_ = batch.unknowns;
    reports_ = batch.reports;
    const int n = size();
    for (auto* s : {&base_gradient_, &smooth_gradient_, &inner_gradient_, &step_, &product_, &correction_,
                    &correction_product_, &residual_})
      *s = s->first(n);
  }
  int size() const { return unknowns_->pattern.size; }
  int unknown(int dof) const { return unknowns_->of_dof[dof]; }
  std::span<P> correction() const { return correction_; }

  /// Model about the present pose, geometric terms and all.
  void build() {
    PackProblem<P>& p = *problem_;
    inertial_composite<P>(p);
    assemble_joints<P>(*p.tree, p.kinematics, p.composite, unknowns_->dof, true, matrix_);
    add_joint_geometry();
    if (!p.alike) leave_out();
    std::swap(p.rows, p.model_rows);
    for (PackRow<P>& row : p.model_rows) {
      row.at = row.value;
      row.unknown = unknowns_->of_dof[row.dof];
    }
    gather_gradient(base_gradient_);
    for (P& g : smooth_gradient_) g = P(0);
    add_row_gradient(smooth_gradient_);
    for (int k = 0; k < size(); ++k) smooth_gradient_[k] = base_gradient_[k] - smooth_gradient_[k];
  }

  /// Lanes of `running` whose model has a minimum; it is correction().
  Live minimise(Live running, float tolerance) {
    Live solved = running;
    for (auto* s : {&step_, &correction_, &product_, &correction_product_})
      for (P& x : *s) x = P(0);
    for (int k = 0; k < size(); ++k) inner_gradient_[k] = smooth_gradient_[k];
    add_row_gradient(inner_gradient_);
    for (PackRow<P>& row : problem_->model_rows) row.in_factor = P(0);
    moved_ = widened(P(0));
    const auto enough = [&] { return kShrink * smallest(first_length_, moved_); };
    for (int iteration = 0; iteration < kMostInnerSteps && any(running); ++iteration) {
      const Live definite = newton_step(running);
      const P length = displacement(step_);
      const Live good = both(definite, finite(length));
      solved = both(solved, either(!running, good));
      running = both(running, good);
      if (iteration == 0) first_length_ = widened(length);
      Live last = length < P(0.1f) * P(tolerance);
      if (iteration > 0) last = either(last, narrowed(widened(length) < enough()));
      const Live straight = take_step(running, length);
      if (iteration == 0) straight_ = straight;
      running = both(running, both(!last, !straight));
      if (!any(running)) break;
      add_row_gradient(inner_gradient_);
      const Live rest = both(running, narrowed(remaining_step() < enough()));
      for (int k = 0; k < size(); ++k)
        correction_[k] = select(rest, P(correction_[k] + residual_[k]), correction_[k]);
      running = both(running, !rest);
    }
    return solved;
  }
  /// With the unit of each: 1 of turns, the rig's length of what slides.
  template <class Visit>
  void for_each_correction(const Visit& visit) const {
    const Tree<float>& tree = *problem_->tree;
    for (int k = 0; k < size(); ++k)
      visit(correction_[k], slides(tree, unknowns_->dof[k]) ? tree.scale.length : 1.0f);
  }
  /// m, of the first Newton step of minimise().
  const auto& first_length() const { return first_length_; }
  /// Lanes in which that was all: no row bore on its way.
  const Live& straight() const { return straight_; }

  /// Simplified Newton step of the given lanes, see InnerProblem::chord(). Infinite where there is none.
  auto chord(const Live& lanes) {
    using Wide = decltype(widened(P()));
    Live same = all(true), known = compare_rows(same);
    gather_gradient(inner_gradient_);
    const Live anew = both(lanes, both(known, !same));
    if (any(anew)) {
      known = both(known, either(!anew, newton_step(anew)));
    } else {
      step_from_factor(step_);
    }
    for (int k = 0; k < size(); ++k) correction_[k] = step_[k];
    return select_wide(known, widened(displacement(correction_)),
                       Wide(std::numeric_limits<double>::infinity()));
  }

  P slope(std::span<const P> direction) const { return dot<P>(base_gradient_, direction); }
  P slope_now(std::span<const P> direction) const {
    P sum = P(0);
    for (int k = 0; k < size(); ++k) sum += masked(k, problem_->gradient[unknowns_->dof[k]]) * direction[k];
    return sum;
  }
  P displacement(std::span<const P> direction) const {
    const PackProblem<P>& p = *problem_;
    const Tree<float>& tree = *p.tree;
    P most = P(0);
    Live valid = all(true);
    for (int i = 0; i < tree.bodies; ++i) {
      Vec3<P>&w = turn_[i], &v = slide_[i];
      const int parent = tree.parent[i];
      w = parent >= 0 ? turn_[parent] : Vec3<P>(Vec3<P>::Zero());
      v = parent >= 0 ? slide_[parent] : Vec3<P>(Vec3<P>::Zero());
      for (int dof = tree.first_dof[i]; dof < tree.first_dof[i + 1]; ++dof) {
        const int k = unknowns_->of_dof[dof];
        if (k < 0) continue;
        w += p.kinematics.w[dof] * direction[k];
        v += p.kinematics.v[dof] * direction[k];
      }
      if (tree.mass[i] <= 0) continue;
      const P moved = (v + w.cross(p.kinematics.center[i])).norm() / P(tree.scale.length) +
                      P(float(kRotationArm)) * w.norm();
      valid = both(valid, finite(moved));
      most = largest(most, moved);
    }
    return select(valid, most, P(std::numeric_limits<float>::infinity()));
  }

 private:
  P masked(int k, const P& x) const {
    return problem_->alike ? x : select(problem_->live[unknowns_->dof[k]], x, P(0));
  }
  template <class Wide>
  static Wide select_wide(const Live& mask, const Wide& yes, const Wide& no) {
    Wide out = no;
    for (int lane = 0; lane < P::kLanes; ++lane)
      if (mask.lane(lane)) out.v[lane] = yes.v[lane];
    return out;
  }
  void gather_gradient(std::span<P> out) const {
    for (int k = 0; k < size(); ++k) out[k] = masked(k, problem_->gradient[unknowns_->dof[k]]);
  }

  /// A degree of freedom that is none of a lane's unknowns moves nothing there, and has a row of the
  /// identity: its step is 0, and elimination subtracts zeros.
  void leave_out() {
    const PackProblem<P>& p = *problem_;
    for (int k = 0; k < size(); ++k) {
      const Live mine = p.live[unknowns_->dof[k]];
      for (int c = 0; c < 6; ++c) {
        matrix_.axes[k][c] = select(mine, matrix_.axes[k][c], P(0));
        matrix_.moved[k][c] = select(mine, matrix_.moved[k][c], P(0));
      }
      matrix_.own_entry(k, k) = select(mine, matrix_.own_entry(k, k), P(1));
      for (int l = matrix_.first[k]; l < k; ++l)
        matrix_.own_entry(k, l) =
            select(both(mine, p.live[unknowns_->dof[l]]), matrix_.own_entry(k, l), P(0));
    }
  }

  void add_joint_geometry() {
    PackProblem<P>& p = *problem_;
    measure_curvature<P>(p.terms, p);
    const Tree<float>& tree = *p.tree;
    for (int i = 0; i < tree.bodies; ++i) {
      if (tree.type[i] != JointType::kBall && tree.type[i] != JointType::kFree) continue;
      const int k = unknowns_->of_dof[tree.first_dof[i + 1] - 3];
      if (k < 0) continue;
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b <= a; ++b) matrix_.own_entry(k + a, k + b) += p.joint_curvature[i](a, b);
    }
  }

  void add_row_gradient(std::span<P> gradient) const {
    for (const PackRow<P>& row : problem_->model_rows) {
      const P slope = row.slope(row.at);
      for (int a = 0; a < row.count; ++a) gradient[row.unknown + a] += slope * row.gradient[a];
    }
  }

  P row_slope(const P& t) const {
    P sum = P(0);
    for (const PackRow<P>& row : problem_->model_rows) sum += row.slope(row.at + t * row.along) * row.along;
    return sum;
  }

  /// See InnerProblem::exact_line_search. Lanes that are done keep what they found.
  P exact_line_search(const Live& lanes, const P& quadratic, const P& linear) const {
    const P zero = P(0);
    const auto derivative = [&](const P& t) { return linear + t * quadratic + row_slope(t); };
    const P d0 = derivative(zero);
    P low = zero, d_low = d0, high = P(1), d_high = derivative(P(1)), found = zero;
    const Live whole = both(lanes, abs(d_high) <= P(0.02f) * -d0);
    found = select(whole, high, found);
    Live open = both(lanes, !whole), growing = open;
    for (int grow = 0; grow < 3; ++grow) {
      growing = both(growing, d_high < zero);
      const Live enough = both(growing, -d_high < P(0.05f) * -d0);
      found = select(enough, high, found);
      open = both(open, !enough);
      growing = both(growing, !enough);
      if (!any(growing)) break;
      low = select(growing, high, low);
      d_low = select(growing, d_high, d_low);
      high = select(growing, P(high * P(2)), high);
      d_high = select(growing, derivative(high), d_high);
    }
    const Live beyond = both(open, d_high <= zero);
    found = select(beyond, high, found);
    open = both(open, !beyond);
    for (int iteration = 0; iteration < 40 && any(open); ++iteration) {
      P t = low + (high - low) * (-d_low) / (d_high - d_low);
      const P least = low + P(0.05f) * (high - low), most = high - P(0.05f) * (high - low);
      t = select(t < least, least, select(most < t, most, t));
      if (iteration % 3 == 2) t = (low + high) / P(2);
      const P d = derivative(t);
      const Live done = both(open, either(abs(d) <= P(0.02f) * -d0, high - low < P(1e-4f) * high));
      found = select(done, t, found);
      open = both(open, !done);
      const Live lower = both(open, d < zero), upper = both(open, !(d < zero));
      low = select(lower, t, low);
      d_low = select(lower, d, d_low);
      high = select(upper, t, high);
      d_high = select(upper, d, d_high);
    }
    return select(open, select(low > zero, low, high), found);
  }

  /// step_ = −H⁻¹·inner_gradient_ in the given lanes; elsewhere the factor stays what it was.
  Live newton_step(const Live& lanes) {
    for (int k = 0; k < size(); ++k) matrix_.factor[k] = matrix_.own[k];
    for (PackRow<P>& row : problem_->model_rows) {
      const P curvature = row.in_factor = select(lanes, row.curvature(row.at), row.in_factor);
      if (!any(curvature > P(0))) continue;
      for (int i = 0; i < row.count; ++i)
        for (int j = 0; j <= i; ++j)
          matrix_.factor_entry(row.unknown + i, row.unknown + j) +=
              curvature * row.gradient[i] * row.gradient[j];
    }
    count<P>(lanes, reports_, &SolveReport::factorisations);
    const Live definite = factorise_joints<P>(matrix_);
    step_from_factor(step_);
    return definite;
  }
  void step_from_factor(std::span<P> out) const {
    for (int k = 0; k < size(); ++k) out[k] = -inner_gradient_[k];
    solve_by_joints<P>(matrix_, out);
  }
  auto remaining_step() {
    step_from_factor(residual_);
    return widened(displacement(residual_));
  }

  /// Answers where no row bears on the way: there the model is quadratic and the step exact.
  Live take_step(const Live& lanes, const P& length) {
    Live straight = all(true);
    for (PackRow<P>& row : problem_->model_rows) {
      row.along = P(0);
      for (int a = 0; a < row.count; ++a) row.along += row.gradient[a] * step_[row.unknown + a];
      straight = both(straight, either(!row.present, !bears(row)));
    }
    multiply_by_joints<P>(matrix_, std::span<const P>(step_), product_);
    P quadratic = P(0), linear = P(0);
    for (int k = 0; k < size(); ++k) {
      quadratic += step_[k] * product_[k];
      linear += step_[k] * (smooth_gradient_[k] + correction_product_[k]);
    }
    P t = P(1);
    if (const Live search = both(lanes, !straight); any(search))
      t = select(search, exact_line_search(search, quadratic, linear), t);
    for (int k = 0; k < size(); ++k) {
      correction_[k] = select(lanes, P(correction_[k] + t * step_[k]), correction_[k]);
      correction_product_[k] =
          select(lanes, P(correction_product_[k] + t * product_[k]), correction_product_[k]);
      inner_gradient_[k] = smooth_gradient_[k] + correction_product_[k];
    }
    moved_ += widened(P(t * length));
    for (PackRow<P>& row : problem_->model_rows) row.at = select(lanes, P(row.at + t * row.along), row.at);
    return straight;
  }

  /// At the inner solution so far, or a whole step on.
  static Live bears(const PackRow<P>& row) {
    const P now = row.slope(row.at), then = row.slope(row.at + row.along);
    return either(row.in_factor > P(0), either(now != P(0), then != P(0)));
  }

  /// Lanes whose rows at the present pose are those of the model, which takes over their values; `same` stays
  /// set where they bend as the last factor has it.
  Live compare_rows(Live& same) {
    PackProblem<P>& p = *problem_;
    Live known = all(true);
    PackRow<P>* mine = p.model_rows.begin();
    for (const PackRow<P>& row : p.rows) {
      for (; mine != p.model_rows.end() && mine->place < row.place; ++mine)
        known = both(known, !mine->present);
      if (mine == p.model_rows.end() || mine->place > row.place) {
        known = both(known, !row.present);
        continue;
      }
      known = both(known, either(both(mine->present, row.present), both(!mine->present, !row.present)));
      same = both(same, mine->in_factor == row.curvature(row.value));
      mine->at = row.value;
      ++mine;
    }
    for (; mine != p.model_rows.end(); ++mine) known = both(known, !mine->present);
    return known;
  }

  PackProblem<P>* problem_ = nullptr;
  const Unknowns* unknowns_ = nullptr;
  SolveReport* reports_ = nullptr;
  ArticulatedParts<P> matrix_;
  std::span<P> base_gradient_, smooth_gradient_, inner_gradient_, step_, product_, correction_,
      correction_product_, residual_;
  std::span<Vec3<P>> turn_, slide_;
  decltype(widened(P())) first_length_, moved_;
  Live straight_;
};

}  // namespace
}  // namespace sinew::newton_kernels
