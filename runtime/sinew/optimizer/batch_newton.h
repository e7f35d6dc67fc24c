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

/// As a world calls it.
class BatchSolver {
 public:
  static constexpr int kMostLanes = 16;

  virtual ~BatchSolver() = default;
  /// Characters per batch.
  virtual int lanes() const = 0;
  /// Set-up for rigs of at most that size; solving allocates nothing.
  virtual void reserve(const SolveRoom& rig) = 0;
  /// That reserve() takes.
  virtual std::size_t bytes(const SolveRoom& rig) const = 0;

  /// Whether a batch solves such a problem: see above.
  virtual bool takes(const TreeProblem<float>& problem) const = 0;
  /// Solves up to lanes() problems of one tree, each with at least one unknown, from their `local`. Where a
  /// report says converged, the problem holds the solution and its kinematics, gradient, couples and rows;
  /// the others are as before: they need a solve of their own.
  virtual void solve(const StepSettings<float>& settings, const Accuracy& accuracy,
                     std::span<TreeProblem<float>* const> problems, std::span<SolveReport> reports) = 0;
};

/// Working memory of batches; keeps nothing from one to the next.
class BatchNewton final : public BatchSolver {
 public:
  explicit BatchNewton(InstructionSet set = best_instruction_set());
  int lanes() const override { return lanes_; }
  void reserve(const SolveRoom& rig) override;
  std::size_t bytes(const SolveRoom& rig) const override;
  bool takes(const TreeProblem<float>& problem) const override;
  void solve(const StepSettings<float>& settings, const Accuracy& accuracy,
             std::span<TreeProblem<float>* const> problems, std::span<SolveReport> reports) override;

 private:
  InstructionSet set_;
  int lanes_;
  Unknowns unknowns_;
  std::vector<std::uint8_t> free_;  ///< [dof] in some lane
  std::vector<std::byte> memory_;
};

/// What World::declare takes. Without, characters are checked and solved one by one, with the same bits. Its
/// kernels hold the rows of muscles, joint limits and damping, declared or not, and act by what is declared.
template <class T>
struct Batches {
  static void declare(StepPlan<T>& plan);
};

extern template struct Batches<float>;
extern template struct Batches<double>;

}  // namespace sinew
