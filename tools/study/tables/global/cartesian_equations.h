// The equations of motion in Cartesian coordinates of every body: the global formulation that the paper
// compares its own with (sections 1 and 5), small and plain. Joints and loops are equations all alike, closed
// in one of two customary ways:
//
// penalty      (M + α ΦᵀΦ) v' = Q − α Φᵀ(Φ̇ v + 2Ωμ Φ' + Ω² Φ): García de Jalón & Bayo, "Kinematic and Dynamic
//              Simulation of Multibody Systems" (1994), section 5.1.4, with their Ω = 10, μ = 1. Symmetric
//              and positive, so a sparse Cholesky factor; redundant equations do no harm; equations hold up
//              to the forces that they carry over α.
// multipliers  [M Φᵀ; Φ 0] [v'; λ] = [Q; −Φ̇ v] (index reduced to 1), a sparse LU factor; positions, then
//              velocities, of each accepted step are projected onto the equations with the mass as metric
//              (Eich, SIAM J. Numer. Anal. 30, 1993; Bayo & Ledesma, Nonlinear Dynamics 9, 1996). Redundant
//              equations are left out at the start, as ADAMS does.
//
// Implicit integrators get derivatives. (Residuals of the penalty form were tried: α multiplies how far Φ has
// turned since a matrix was factorised, and ode15sR then asks for 200 to 1400 tangents.) Their iteration
// matrix is c·M + D + K/c with forces' derivatives by differences (few, since a force concerns two bodies),
// those of M and Φ left out as in equation 78.
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

#include "sinew/multibody/equations.h"
#include "study/tables/global/constraints.h"
#include "study/tables/global/sparse_assembly.h"

namespace sinew::study {

enum class GlobalClosure { kPenalty, kMultipliers };

struct GlobalCounts {
  long evaluations = 0, tangents = 0, factorisations = 0;
};

class CartesianEquations : public multibody::System {
 public:
  CartesianEquations(const multibody::Model& model, GlobalClosure closure);

  /// Start of the mechanism, loops closed: "" or what is wrong with it, as Equations::start.
  std::string start(multibody::Vector& state);
  /// The state of the bodies at joint coordinates and rates [2N], and back.
  multibody::Vector state_of(const multibody::Vector& joints) { return motion_.from_joints(joints); }
  multibody::Vector joints_of(const multibody::Vector& state);
  /// Largest |Φ| of the state last evaluated, m or sine.
  double gap() const;
  const GlobalCounts& counts() const { return counts_; }
  const multibody::BodyMotion& motion() const { return motion_.motion(); }

  int size() const override { return 13 * bodies_; }
  bool derivative(double t, const multibody::Vector& y, multibody::Vector& yp) override;
  bool residual(double t, const multibody::Vector& y, const multibody::Vector& yp,
                multibody::Vector& r) override;
  bool tangent(double t, const multibody::Vector& y, const multibody::Vector& yp, double c,
               bool reusable) override;
  bool factorise(double c) override;
  void solve(multibody::Vector& r) override;
  bool accept(double t, multibody::Vector& y) override;

 private:
  using Vector = multibody::Vector;
  using Mat6 = Eigen::Matrix<double, 6, 6>;
  /// How forces on one body change with another: −∂Q_i/∂x_k, −∂Q_i/∂v_k.
  struct Coupling {
    int i, k;
    Mat6 stiffness = Mat6::Zero(), damping = Mat6::Zero();
  };

  void find_couplings();
  void leave_out_redundant_rows();
  bool place(const Vector& state);
  bool prepare(double t, const Vector& state);
  bool accelerations(double t, const Vector& state, Vector& a);
  void add_mass(SparseAssembly& to, double times) const;
  void add_penalties(SparseAssembly& to, double times) const;
  void add_constraints(SparseAssembly& to) const;
  bool factorise_mass();
  /// Φ_q·v, and Φ_qᵀ·x added to `out`.
  Vector by_jacobian(const Vector& v) const;
  void add_transposed(const Vector& x, Vector& out) const;
  Vector kept(const Vector& rows) const;
  Vector times_mass(const Vector& v) const;
  Vector times_stiffness(const Vector& x) const;
  /// −α(…) of the penalty at zero accelerations.
  Vector penalty_reaction() const;

  const multibody::Model* model_;
  GlobalClosure closure_;
  int bodies_, rows_ = 0, kept_rows_ = 0;
  CartesianMotion motion_;
  std::vector<BasicConstraint> constraints_;
  std::vector<Linearised> linear_;
  std::vector<int> kept_;  ///< [row] its place among the rows that are kept, or −1
  std::vector<Coupling> couplings_;
  std::vector<int> colour_;  ///< [body] bodies of one colour have no neighbour in common
  double penalty_ = 0;
  Vector state_, velocity_, force_, phi_, bend_;
  SparseAssembly mass_assembly_, iteration_assembly_;
  Eigen::SparseMatrix<double> mass_then_;  ///< M + αΦᵀΦ at the factorisation
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> penalty_factor_;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> multiplier_factor_, iteration_factor_;
  bool mass_analysed_ = false, iteration_analysed_ = false;
  double c_ = 0;
  GlobalCounts counts_;
};

}  // namespace sinew::study
