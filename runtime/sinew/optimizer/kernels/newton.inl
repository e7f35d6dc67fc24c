// Newton's method on a pack of characters: NewtonSolver with its step lengths, acceptance and convergence as
// masks. Included once per instruction set with SINEW_KERNELS naming it and SINEW_FLOAT_LANES its registers.
//
// A lane is handed back, unsolved and untouched, where it needs more than whole steps of a positive definite
// model: its own solve knows what to do.
#include "sinew/optimizer/kernels/pack_inner.h"

namespace sinew::newton_kernels {
namespace {

/// Lanes that have not converged after so many passes are handed back: the others would wait for them.
constexpr int kMostPackPasses = 8;

template <class P>
class PackNewton {
 public:
  using Live = MaskOf<P>;
  using Wide = decltype(widened(P()));

  std::size_t lay_out(const Shape& shape, void* memory) {
    Arena arena(memory);
    problem_.lay_out(shape, arena);
    inner_.lay_out(shape, arena);
    arena.take(base_, shape.bodies);
    return arena.used();
  }

  void solve(const Batch& batch) {
    settings_ = batch.settings;
    tolerance_ = batch.accuracy->tolerance;
    reports_ = batch.reports;
    problem_.gather(batch);
    inner_.begin(batch, problem_);
    for (int lane = 0; lane < P::kLanes; ++lane) reports_[lane] = {};
    P in = P(0);
    for (int lane = 0; lane < P::kLanes; ++lane) lane_of(in, lane) = batch.problems[lane] ? 1.0f : 0.0f;
    Live active = in > P(0), converged = Live::all(false);
    energy_ = evaluate(active);
    const int most = std::min(batch.accuracy->max_iterations, kMostPackPasses);
    for (int pass = 0; pass < most && any(active); ++pass) {
      count<P>(active, reports_, &SolveReport::outer_passes);
      const Live done = outer_pass(active);
      converged = either(converged, done);
      active = both(active, !done);
    }
    for (int lane = 0; lane < P::kLanes; ++lane) {
      if (!batch.problems[lane]) continue;
      reports_[lane].converged = converged.lane(lane);
      reports_[lane].energy = energy_.v[lane];
      if (converged.lane(lane)) write_back(batch, lane);
    }
  }

 private:
  /// Energy, wrenches, rows and gradient at `local`.
  Wide evaluate(const Live& lanes) {
    PackProblem<P>& p = problem_;
    count<P>(lanes, reports_, &SolveReport::evaluations);
    place_bodies<P>(*p.tree, std::span<const Transform<P>>(p.local), p.common_origin, p.kinematics);
    Wide energy = inertial_energy<P>(*settings_, p);
    measure_rows<P>(*settings_, p.terms, p);
    for (const PackRow<P>& row : p.rows) energy += widened(row.energy(row.value));
    project_gradient<P>(p);
    return energy;
  }

  void try_step(const Live& lanes) {
    const Tree<float>& tree = *problem_.tree;
    const std::span<const P> correction = inner_.correction();
    for (int i = 0; i < tree.bodies; ++i) {
      base_[i] = problem_.local[i];
      const int first = tree.first_dof[i];
      if (first == tree.first_dof[i + 1] || !problem_.free[first]) continue;
      P d[6] = {P(0), P(0), P(0), P(0), P(0), P(0)};
      for (int dof = first; dof < tree.first_dof[i + 1]; ++dof)
        d[dof - first] = correction[inner_.unknown(dof)];
      const Transform<P> moved = moved_by<P>(tree, i, base_[i], d);
      const Live moves = both(lanes, problem_.live[first]);
      Transform<P>& local = problem_.local[i];
      local.rotation.coeffs() = select(moves, moved.rotation.coeffs(), base_[i].rotation.coeffs());
      local.translation = select(moves, moved.translation, base_[i].translation);
    }
  }

  /// NewtonSolver::accepted for whole steps.
  Live accepted(const P& slope, const Wide& energy, const Wide& new_energy, const Live& slight) const {
    const P now = inner_.slope_now(inner_.correction());
    const Live calmer = either(slight, abs(now) <= P(0.9f) * abs(slope));
    const Wide noise = 2e-5 * (Wide(double(problem_.tree->scale.energy)) + abs(energy));
    const Live lower = narrowed(new_energy <= energy + 1e-4 * widened(slope));
    const Live level = both(narrowed(new_energy <= energy + noise), calmer);
    return both(narrowed(finite(new_energy)), either(lower, level));
  }

  /// One pass of the active lanes. Answers those that have converged; takes those that are handed back out of
  /// `active`.
  Live outer_pass(Live& active) {
    inner_.build();
    active = inner_.minimise(active, float(tolerance_));
    P longest = P(0);
    inner_.for_each_correction(
        [&](const P& d, float unit) { longest = largest(longest, P(abs(d) / P(unit))); });
    if (const Live far = longest > P(1); any(far))
      for (P& d : inner_.correction()) d = select(far, P(d / longest), d);
    const Wide length = widened(inner_.displacement(inner_.correction()));
    const Live small =
        narrowed(both(length < Wide(tolerance_), inner_.first_length() < Wide(2 * tolerance_)));
    const P slope = inner_.slope(inner_.correction());
    try_step(active);
    const Wide energy = evaluate(active);
    active = both(active, accepted(slope, energy_, energy, small));
    energy_ = energy;
    const Live brief = both(narrowed(length < Wide(kExactWithin * tolerance_)),
                            narrowed(Wide(kLeft) * length * length < Wide(kCautious * tolerance_)));
    const Live exact = both(inner_.straight(), brief);
    const Live done = both(active, either(small, exact));
    const Live near = both(both(active, !done), narrowed(length < Wide(kStillValid)));
    return either(done, chords(near, length, active));
  }

  /// NewtonSolver::converge_by_chords in the given lanes.
  Live chords(Live lanes, Wide length, Live& active) {
    Live converged = Live::all(false);
    while (any(lanes)) {
      const Wide next = inner_.chord(lanes);
      lanes = both(lanes, narrowed(next < kChordRate * length));
      const Live negligible = both(lanes, narrowed(next < Wide(kNegligible * tolerance_)));
      converged = either(converged, negligible);
      lanes = both(lanes, !negligible);
      if (!any(lanes)) break;
      const P slope = inner_.slope_now(inner_.correction());
      try_step(lanes);
      const Wide energy = evaluate(lanes);
      const Wide rate = largest(next / length, Wide(kLeastRate));
      const Live last = narrowed(next * rate < kCautious * tolerance_ * (Wide(1) - rate));
      const Live taken = accepted(slope, energy_, energy, last);
      active = both(active, either(!lanes, taken));
      lanes = both(lanes, taken);
      count<P>(lanes, reports_, &SolveReport::chords);
      energy_ = energy;
      converged = either(converged, both(lanes, last));
      lanes = both(lanes, !last);
      length = next;
    }
    return converged;
  }

  /// The solution, and what an evaluation there leaves that is asked for after a solve.
  void write_back(const Batch& batch, int lane) {
    TreeProblem<float>& to = *batch.problems[lane];
    PackProblem<P>& p = problem_;
    for (int i = 0; i < p.tree->bodies; ++i) {
      get(p.local[i], lane, to.local[i]);
      get(p.kinematics.rotation[i], lane, to.kinematics.rotation[i]);
      get(p.kinematics.origin[i], lane, to.kinematics.origin[i]);
      get(p.kinematics.center[i], lane, to.kinematics.center[i]);
      get(p.couple[i], lane, to.couple[i]);
    }
    for (int dof = 0; dof < p.tree->dofs; ++dof) {
      get(p.kinematics.w[dof], lane, to.kinematics.w[dof]);
      get(p.kinematics.v[dof], lane, to.kinematics.v[dof]);
      to.gradient[dof] = lane_of(p.gradient[dof], lane);
    }
    to.clear_rows();
    for (PackRow<P>& row : p.rows)
      if (row.present.lane(lane)) batch.add_row(to, row_of(row, lane));
  }

  const StepSettings<float>* settings_ = nullptr;
  double tolerance_ = 0;  ///< m
  SolveReport* reports_ = nullptr;
  PackProblem<P> problem_;
  PackInner<P> inner_;
  std::span<Transform<P>> base_;
  Wide energy_;
};

using Lanes = Pack<float, SINEW_FLOAT_LANES>;

}  // namespace

namespace SINEW_KERNELS {
std::size_t scratch_bytes(const Shape& shape) {
  return PackNewton<Lanes>().lay_out(shape, nullptr);
}
int lanes() {
  return SINEW_FLOAT_LANES;
}
void solve(const Batch& batch) {
  PackNewton<Lanes> newton;
  newton.lay_out(batch.shape, batch.scratch);
  newton.solve(batch);
}
}  // namespace SINEW_KERNELS
}  // namespace sinew::newton_kernels
