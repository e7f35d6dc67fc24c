// Newton's method on packs of characters: one lane per character, one source, compiled for every instruction
// set.
//
// Arguments are plain numbers and pointers, or made of floats whose alignment no instruction set changes (see
// animation/kernels/kernels.h). Lanes never meet and nothing is contracted: a character's numbers are those
// of its own solve (newton.h one folder up), to the bit, whoever else is in the pack.
#pragma once

#include <cstddef>

#include "sinew/optimizer/newton.h"

namespace sinew::newton_kernels {

constexpr int kMaxLanes = 16;

/// What decides about the memory of a batch.
struct Shape {
  int bodies = 0, dofs = 0;
  int rows = 0;  ///< of the joints, at most
};

/// Characters of one rig that nothing touches, with nothing on them but their muscles, limits and gravity.
struct Batch {
  const StepSettings<float>* settings = nullptr;  ///< `common_origin` is not looked at
  const Accuracy* accuracy = nullptr;
  TreeProblem<float>* problems[kMaxLanes] = {};  ///< [lane] null: none
  const Unknowns* unknowns = nullptr;            ///< of the tree, all that are free in some lane
  Shape shape;
  void* scratch = nullptr;  ///< scratch_bytes(), aligned to 64
  /// Appends to a problem's rows; code that others share, not a kernel's.
  void (*add_row)(TreeProblem<float>& to, const JointRow<float>& row) = nullptr;
  SolveReport* reports = nullptr;  ///< [lane]; `converged` only where the lane's `local` is the solution
};

#define SINEW_NEWTON_KERNELS                     \
  std::size_t scratch_bytes(const Shape& shape); \
  int lanes();                                   \
  void solve(const Batch& batch);
namespace baseline {
SINEW_NEWTON_KERNELS
}
namespace avx2 {
SINEW_NEWTON_KERNELS
}
namespace avx512 {
SINEW_NEWTON_KERNELS
}

}  // namespace sinew::newton_kernels
