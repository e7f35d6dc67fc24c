// The energy of one tree over one step: inertia, gravity, pushes and the scalar energies of its joints.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "sinew/effects/contact.h"
#include "sinew/effects/effect.h"
#include "sinew/effects/impulse.h"
#include "sinew/effects/joint_step.h"
#include "sinew/effects/step_plan.h"
#include "sinew/optimizer/scheme.h"
#include "sinew/optimizer/solve_capacity.h"
#include "sinew/residual/composite.h"

namespace sinew {

/// Everything a solve knows and computes about one tree. Sized once.
template <class T>
struct TreeProblem : JointRowList<T> {
  const Tree<T>* tree;
  JointLaw<T> law;
  Prediction<T> prediction;
  Vec3<T> common_origin = Vec3<T>::Zero();  ///< m; subtracted from the places of parentless joints
  std::vector<Transform<T>> local;          ///< [body] present solution, joint → parent
  std::vector<Transform<T>> target;         ///< [body] where the muscles pull
  std::vector<Transform<T>> start;          ///< [body] at the beginning of the step
  std::vector<std::uint8_t> free;           ///< [dof] 1: an unknown of the solve
  std::vector<ExternalForce<T>> pushes;
  Kinematics<T> kinematics;            ///< at `local`
  std::vector<Vec3<T>> force, moment;  ///< [body] gradient wrenches; subtree sums after the projection
  std::vector<Vec3<T>> body_force;     ///< [body] inertia + gravity + pushes, at the centre of mass
  std::vector<Vec3<T>> couple;         ///< [body] rotational part of the inertial gradient
  std::vector<T> gradient;             ///< [dof] ∂E/∂d in the chart centred at `local`
  std::vector<Composite<T>> composite;
  std::vector<Mat3<T>> joint_curvature;        ///< [body] see measure_joint_curvature
  std::vector<Effect<T>*> effects;             ///< the step's plan: those with instances on this tree
  std::vector<JointRow<T>> effect_rows;        ///< all of the effects'; those of unknowns are in `rows` too
  std::vector<SpatialStiffness<T>> stiffness;  ///< [body] of the effects; empty where there are none
  bool stiff = false;                          ///< some of them is not zero
  SolveCapacity capacity;                      ///< what this tree brings to a solve
  double outside_energy = 0;    ///< J: energies of pushes and effects, which may cancel, without their signs
  T kink_width = T(1e-3) / 60;  ///< rad per step: muscles and dry friction are rounded over it
  int first_unknown_map = 0;    ///< where this tree's part of Unknowns::of_dof begins

  TreeProblem(const Tree<T>& tree, const Skeleton& skeleton);
  void clear_wrenches() {
    for (std::vector<Vec3<T>>* wrench : {&force, &moment})
      std::fill(wrench->begin(), wrench->end(), Vec3<T>(Vec3<T>::Zero()));
  }
  /// Set-up: puts an effect, attached to this tree, into the plan if it has instances.
  void plan(Effect<T>& effect);
};

/// Values that all trees of a solve share; of a human where they are lengths, times or stiffnesses (Scale).
template <class T>
struct StepSettings {
  const StepPlan<T>* plan = &StepPlan<T>::none();     ///< what is declared
  T h = T(1) / 60;                                    ///< s
  Vec3<T> gravity{0, 0, T(-9.81)};                    ///< m/s²
  Vec3<double> common_origin = Vec3<double>::Zero();  ///< m, world; of all that is computed
  T limit_stiffness = T(2000);                        ///< N·m/rad
  T limit_damping = T(0.02);                          ///< s
  T stick = T(0.01) / 60;                             ///< m per step
  /// Muscles and dry friction are constant over the step: see constant_emphasis in bossak.h. With other
  /// schemes they act as all forces do.
  bool constant_muscles = false;
};

/// What the problem's effects see of it.
template <class T>
EffectPose<T> effect_pose(const StepSettings<T>& settings, const TreeProblem<T>& problem) {
  return {*problem.tree,          problem.kinematics, problem.local, problem.start,
          settings.common_origin, settings.gravity,   settings.h};
}

/// The effects' rows at the present pose into `problem.effect_rows`.
template <class T>
void measure_effect_rows(const StepSettings<T>& settings, TreeProblem<T>& problem);

/// Kinematics, wrenches and energy of inertia, gravity, pushes and effects at `problem.local`; rows
/// re-measured. Contacts add their wrenches afterwards; then finish_gradient projects. Returns the energy
/// (J).
template <class T>
double begin_evaluation(const StepSettings<T>& settings, TreeProblem<T>& problem);

/// Projects the wrenches on the motion axes and adds the rows.
template <class T>
void finish_gradient(TreeProblem<T>& problem);

/// Fills `problem.composite` and, where there are effects, `problem.stiffness` from inertia and (for the
/// geometric terms) the forces on the bodies.
template <class T>
void begin_composite(const StepSettings<T>& settings, TreeProblem<T>& problem);

#define SINEW_PROBLEM_INSTANCES(prefix, T)                                     \
  prefix struct TreeProblem<T>;                                                \
  prefix void measure_effect_rows<T>(const StepSettings<T>&, TreeProblem<T>&); \
  prefix double begin_evaluation<T>(const StepSettings<T>&, TreeProblem<T>&);  \
  prefix void finish_gradient<T>(TreeProblem<T>&);                             \
  prefix void begin_composite<T>(const StepSettings<T>&, TreeProblem<T>&);
SINEW_PROBLEM_INSTANCES(extern template, float)
SINEW_PROBLEM_INSTANCES(extern template, double)

}  // namespace sinew
