// Newton's method for several characters of one rig at a time, one per SIMD lane.
//
// For characters that nothing touches and nothing but gravity, muscles, limits and joint friction acts on:
// limp in flight, or partly solved with the root on its animation. Their unknowns may differ. A lane's
// numbers are those of NewtonSolver, to the bit, whatever the instruction set and whoever is in the other
// lanes.
#pragma once

#include <array>
#include <vector>

#include "sinew/animation/instruction_set.h"
#include "sinew/optimizer/newton.h"

namespace sinew {

/// Working memory of batches; keeps nothing from one to the next.
class BatchNewton {
 public:
  static constexpr int kMostLanes = 16;

  explicit BatchNewton(InstructionSet set = best_instruction_set());
  /// Characters per batch.
  int lanes() const { return lanes_; }

  /// Set-up for rigs of at most that size; solving allocates nothing.
  void reserve(const SolveRoom& rig);
  /// That reserve() takes.
  std::size_t bytes(const SolveRoom& rig) const;

  /// Whether a batch solves such a problem: see above.
  static bool takes(const TreeProblem<float>& problem, const Accuracy& accuracy);

  /// Solves up to lanes() problems of one tree, each with at least one unknown, from their `local`. Where a
  /// report says converged, the problem holds the solution and its kinematics, gradient, couples and rows;
  /// the others are as before: they need a solve of their own.
  void solve(const StepSettings<float>& settings, const Accuracy& accuracy,
             std::span<TreeProblem<float>* const> problems, std::span<SolveReport> reports);

 private:
  InstructionSet set_;
  int lanes_;
  Unknowns unknowns_;
  std::vector<std::uint8_t> free_;  ///< [dof] in some lane
  std::vector<std::byte> memory_;
};

}  // namespace sinew
