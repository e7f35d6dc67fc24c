#include "sinew/effects/check_batch.h"

#include <algorithm>
#include <memory>

#include "sinew/animation/kernels/layout.h"
#include "sinew/effects/kernels/check.h"

namespace sinew {
namespace {

constexpr std::size_t kAlignment = 64;  ///< bytes, of the widest registers

}  // namespace

MotionChecker::MotionChecker(InstructionSet set) : set_(set) {
  static_assert(kMostLanes == check_kernels::kMaxLanes);
}

int MotionChecker::lanes() const {
  return set_ == InstructionSet::kAvx512 ? 16 : 8;
}

void MotionChecker::reserve(int bodies, int dofs, int points) {
  const std::size_t bytes = kMostLanes * sizeof(float) * std::size_t(dofs) +
                            check_kernels::check_scratch_bytes(bodies, bodies, points) + kAlignment;
  memory_.resize(std::max(memory_.size(), bytes));
}

void MotionChecker::check(const CheckedRig& rig, std::span<const JointJet<float>* const> jets,
                          std::span<float* const> torque) {
  check_kernels::Rig view;
  view.tree = &rig.tree;
  view.support = rig.support;
  view.joints = rig.tree.bodies;
  for (int a = 0; a < 3; ++a) view.gravity[a] = rig.gravity[a];
  view.ground_height = rig.ground;
  check_kernels::Batch batch;
  for (int lane = 0; lane < lanes(); ++lane)
    batch.jets[lane] = kernels::layout(jets[std::min(std::size_t(lane), jets.size() - 1)]);
  void* memory = memory_.data();
  std::size_t space = memory_.size();
  auto* rows = static_cast<float*>(std::align(kAlignment, 1, memory, space));
  batch.torque = rows;
  batch.scratch = rows + std::size_t(rig.tree.dofs) * kMostLanes;
  using namespace check_kernels;
  switch (set_) {
#ifdef __x86_64__
    case InstructionSet::kAvx512:
      avx512::check16(view, batch);
      break;
    case InstructionSet::kAvx2:
      avx2::check8(view, batch);
      break;
#endif
    default:
      baseline::check8(view, batch);
  }
  for (std::size_t n = 0; n < jets.size(); ++n)
    for (int dof = 0; dof < rig.tree.dofs; ++dof) torque[n][dof] = rows[std::size_t(dof * lanes()) + n];
}

template <class T>
void Batches<T>::declare(StepPlan<T>& plan) {
  if constexpr (std::is_same_v<T, float>)
    plan.make_checks = []() -> std::unique_ptr<BatchCheck> { return std::make_unique<MotionChecker>(); };
}

template struct Batches<float>;
template struct Batches<double>;

}  // namespace sinew
