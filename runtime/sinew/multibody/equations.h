// The equations of motion of a mechanism in the formulations of the paper, as a System that integrators take.
//
// The state is y = (q, q') of ALL tree coordinates. In a closed mechanism only the independent ones count:
// every evaluation first replaces the dependent positions and rates by what the loops say (index 2: rates on
// their manifold; positions too), so the right-hand side is smooth however often the independent coordinates
// are re-chosen, and a re-choice restarts nothing. Re-choosing a null-space basis without this cost 84 678
// steps on the Bricard mechanism where projection needs hundreds (research/integrators-and-references.md).
#pragma once

#include <string>

#include "sinew/multibody/articulated.h"
#include "sinew/multibody/semi_recursive.h"
#include "sinew/multibody/system.h"
#include "sinew/multibody/tangent_parts.h"
#include "sinew/multibody/tree_factor.h"

namespace sinew::multibody {

enum class Formulation {
  kDtr,  ///< derivatives by articulated inertias; open chains
  kDsr,  ///< derivatives by accumulated inertias; with loops DSR-Rz
  kRr,   ///< residuals; with loops RR-Rz
};
enum class Tangent {
  kNumeric,   ///< JN: differences
  kAnalytic,  ///< JF: equations 76–85
};

/// When the loops are closed.
enum class Closure {
  kInEvaluations,  ///< in every evaluation, by orthogonal factors: the right-hand side is smooth and has no
                   ///< drift
  kInSteps,        ///< index 2, as section 2.2.2 of the paper has it: positions are integrated as they are,
             ///< dependent rates follow by Rz (one small Cholesky factor per evaluation), and each accepted
             ///< step is closed. Dependent rates stay in the state, but nothing reads them: so a re-choice
             ///< restarts nothing.
};

struct EvaluationCounts {
  long derivatives = 0, residuals = 0;  ///< including those for numeric tangents
  long tangents = 0, factorisations = 0;
};

class Equations : public System {
 public:
  Equations(const Model& model, Formulation formulation, Tangent tangent,
            Closure closure = Closure::kInEvaluations);

  /// Start of the mechanism: closes the loops from the file's q0 and checks the rates against them. Returns
  /// what is wrong, naming the loop, or "".
  std::string start(Vector& y);

  int size() const override { return 2 * n_; }
  bool derivative(double t, const Vector& y, Vector& yp) override;
  bool residual(double t, const Vector& y, const Vector& yp, Vector& r) override;
  bool tangent(double t, const Vector& y, const Vector& yp, double c, bool reusable) override;
  bool factorise(double c) override;
  void solve(Vector& r) override;
  double noise() const override;
  bool accept(double t, Vector& y) override;

  /// True when the last evaluation's independent coordinates determine the dependent ones badly: `accept`
  /// would choose others.
  bool poorly_chosen() const;

  /// State with loops closed to rounding, for output. False when they do not close.
  bool close(Vector& y);
  /// Motion at the last evaluated or closed state.
  const BodyMotion& motion() const { return motion_; }
  const Model& model() const { return *model_; }
  const VelocityTransformation& transformation() const { return rz_; }
  const EvaluationCounts& counts() const { return counts_; }
  /// Of the last tangent; the mass is that of the last factorisation.
  const TangentParts& parts() const { return parts_; }

 private:
  bool prepare(double t, const Vector& y);
  bool accelerations(double t, const Vector& y, Vector& qdd);
  bool independent_residual(double t, const Vector& y, const Vector& qdd, Vector& out);
  bool numeric_tangent(double t, const Vector& y, const Vector& yp, double c, bool reusable);
  bool analytic_tangent(double t, const Vector& y);
  void renew_mass();
  /// Moves position k, and with it what follows it, by so much.
  void move_position(int k, double by, Vector& y) const;
  /// Rzᵀ·a [independent×N].
  void reduce_rows(const Matrix& a, Matrix& out) const;

  const Model* model_;
  Formulation formulation_;
  Tangent tangent_kind_;
  Closure closure_;
  int n_;
  BodyMotion motion_;
  AppliedForces applied_;
  VelocityTransformation rz_;
  ArticulatedInertia articulated_;
  SemiRecursive semi_recursive_;
  RecursiveResidual recursive_residual_;
  EvaluationCounts counts_;

  Vector q_, qd_, qdd_, bias_, force_, reduced_;
  Matrix mass_, reduced_mass_;
  Eigen::LLT<Matrix> mass_factor_;

  TangentParts parts_;
  Matrix iteration_;
  TreeFactor tree_factor_;  ///< of open chains on residuals with the analytic tangent
  bool by_tree_ = false;    ///< that one holds the iteration matrix, not the dense one
  Eigen::PartialPivLU<Matrix> factor_;
  double c_ = 0;
  bool inertia_is_mass_ = false;  ///< and so can be renewed without evaluating the tangent
};

}  // namespace sinew::multibody
