// Checks of several characters of one rig at a time, one per SIMD lane.
#pragma once

#include <array>
#include <vector>

#include "sinew/animation/instruction_set.h"
#include "sinew/effects/check_pass.h"
#include "sinew/effects/step_plan.h"

namespace sinew {

/// What the motions of a batch have in common.
struct CheckedRig {
  const Tree<float>& tree;                        ///< of all of them
  const SupportPoints<float>* support = nullptr;  ///< null: no ground bears them
  Vec3<float> gravity = Vec3<float>::Zero();      ///< m/s², world
  float ground = 0;                               ///< m, its height
};

/// As a world calls it.
class BatchCheck {
 public:
  static constexpr int kMostLanes = 16;  ///< of any instruction set's lanes()

  virtual ~BatchCheck() = default;
  /// Characters per batch.
  virtual int lanes() const = 0;
  /// Set-up for rigs of at most that size; checking allocates nothing.
  virtual void reserve(int bodies, int dofs, int points) = 0;
  /// That reserve() has taken.
  virtual std::size_t bytes() const = 0;
  /// Torques [character][dof] (N·m; N for translations) that the motions [character][body] ask for, as
  /// check_motion writes them, to the bit. Up to lanes() characters.
  virtual void check(const CheckedRig& rig, std::span<const JointJet<float>* const> jets,
                     std::span<float* const> torque) = 0;
};

/// Working memory of such checks; keeps nothing from one to the next.
class MotionChecker final : public BatchCheck {
 public:
  /// With the kernels of `set`, which the processor must have.
  explicit MotionChecker(InstructionSet set = best_instruction_set());
  int lanes() const override;
  void reserve(int bodies, int dofs, int points) override;
  std::size_t bytes() const override { return memory_.capacity(); }
  void check(const CheckedRig& rig, std::span<const JointJet<float>* const> jets,
             std::span<float* const> torque) override;

 private:
  InstructionSet set_;
  std::vector<std::byte> memory_;  ///< torques [dof][lane], then the kernels' scratch
};

/// What World::declare takes. Without, animations are checked one by one, with the same bits.
template <class T>
struct Batches {
  /// Writes its functions into the world's plan.
  static void declare(StepPlan<T>& plan);
};

extern template struct Batches<float>;
extern template struct Batches<double>;

}  // namespace sinew
