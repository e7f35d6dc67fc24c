#include "sinew/optimizer/batch_newton.h"

#include <algorithm>
#include <memory>
#include <type_traits>

#include "sinew/effects/check_batch.h"
#include "sinew/optimizer/kernels/newton.h"

namespace sinew {
namespace {

using newton_kernels::Batch;
using newton_kernels::Shape;

constexpr std::size_t kAlignment = 64;  ///< bytes, of the widest registers

struct Kernel {
  std::size_t (*scratch_bytes)(const Shape&);
  int (*lanes)();
  void (*solve)(const Batch&);
};

Kernel kernel(InstructionSet set) {
#ifdef __x86_64__
  namespace k = newton_kernels;
  if (set == InstructionSet::kAvx512) return {k::avx512::scratch_bytes, k::avx512::lanes, k::avx512::solve};
  if (set == InstructionSet::kAvx2) return {k::avx2::scratch_bytes, k::avx2::lanes, k::avx2::solve};
#endif
  (void)set;
  return {newton_kernels::baseline::scratch_bytes, newton_kernels::baseline::lanes,
          newton_kernels::baseline::solve};
}

/// Of one rig: rows as TreeProblem reserves them.
Shape shape_of(const SolveRoom& rig) {
  return {rig.bodies, rig.dofs, 6 * rig.dofs + 3 * rig.bodies};
}

}  // namespace

BatchNewton::BatchNewton(InstructionSet set) : set_(set), lanes_(kernel(set).lanes()) {}

std::size_t BatchNewton::bytes(const SolveRoom& rig) const {
  return kernel(set_).scratch_bytes(shape_of(rig)) + kAlignment + rig.dofs * (1 + 5 * sizeof(int));
}

void BatchNewton::reserve(const SolveRoom& rig) {
  memory_.resize(std::max(memory_.size(), kernel(set_).scratch_bytes(shape_of(rig)) + kAlignment));
  unknowns_.reserve(rig.dofs);
  free_.reserve(rig.dofs);
}

bool BatchNewton::takes(const TreeProblem<float>& p) const {
  if (p.prediction.other || !p.pushes.empty() || !p.effects.empty()) return false;
  bool any = false;
  for (int i = 0; i < p.tree->bodies; ++i) {
    const int first = p.tree->first_dof[i];
    if (p.tree->dof_count(i) == 0 || !p.free[first]) continue;
    any = true;
    if (p.law.ellipsoidal[i]) return false;
  }
  return any;
}

void BatchNewton::solve(const StepSettings<float>& settings, const Accuracy& accuracy,
                        std::span<TreeProblem<float>* const> problems, std::span<SolveReport> reports) {
  const Tree<float>& tree = *problems[0]->tree;
  free_.assign(tree.dofs, 0);
  for (const TreeProblem<float>* p : problems)
    for (int dof = 0; dof < tree.dofs; ++dof) free_[dof] |= p->free[dof];
  unknowns_.clear();
  append_unknowns<float>(tree, free_, unknowns_);
  std::array<SolveReport, kMostLanes> lane_reports;
  Batch batch;
  batch.settings = &settings;
  batch.accuracy = &accuracy;
  std::copy(problems.begin(), problems.end(), batch.problems);
  batch.unknowns = &unknowns_;
  batch.shape = shape_of(problems[0]->room);
  void* memory = memory_.data();
  std::size_t space = memory_.size();
  batch.scratch = std::align(kAlignment, 1, memory, space);
  batch.add_row = [](TreeProblem<float>& to, const JointRow<float>& row) { to.add_row(row, true); };
  batch.reports = lane_reports.data();
  kernel(set_).solve(batch);
  std::copy_n(lane_reports.begin(), problems.size(), reports.begin());
}

template <class T>
void Batches<T>::declare(StepPlan<T>& plan) {
  if constexpr (std::is_same_v<T, float>) {
    plan.make_batches = []() -> std::unique_ptr<BatchSolver> { return std::make_unique<BatchNewton>(); };
    plan.make_checks = []() -> std::unique_ptr<BatchCheck> { return std::make_unique<MotionChecker>(); };
  }
}

template struct Batches<float>;
template struct Batches<double>;

}  // namespace sinew
