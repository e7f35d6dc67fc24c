// Analytic tangents: the derivatives of every force law, and what they are good for.
#include "mechanisms.h"

namespace sinew::multibody {
namespace {

/// Forces on the coordinates at a state of an open chain.
Vector coordinate_forces(const Model& model, double t, const Vector& q, const Vector& qd) {
  BodyMotion motion(model);
  AppliedForces applied(model);
  move_to(model, q, motion);
  set_rates(model, qd, motion);
  apply_forces(model, t, q, qd, motion, applied);
  Vector out(model.size());
  for (int i = 0; i < model.size(); ++i) out[i] = applied.joint[i];
  std::vector<Vec3<double>> force = applied.force, moment = applied.moment;
  Vector bodies(model.size());
  project_wrenches<double>(model.tree, motion.pose, force, moment,
                           {bodies.data(), static_cast<std::size_t>(bodies.size())});
  return out + bodies;
}

void analytic(const Model& model, double t, const Vector& q, const Vector& qd, Matrix& stiffness,
              Matrix& damping) {
  BodyMotion motion(model);
  move_to(model, q, motion);
  set_rates(model, qd, motion);
  stiffness = damping = Matrix::Zero(model.size(), model.size());
  add_force_tangent(model, t, q, qd, motion, stiffness, damping);
}

/// Largest entry of −∂Q/∂x that central differences see otherwise, relative to the largest entry.
double mismatch_of(const Matrix& tangent, const std::function<Vector(const Vector&)>& forces,
                   const Vector& x) {
  const double h = 1e-6;
  Matrix numeric(tangent.rows(), tangent.cols());
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const Vector step = h * Vector::Unit(x.size(), k);
    numeric.col(k) = (forces(x - step) - forces(x + step)) / (2 * h);
  }
  return (tangent - numeric).cwiseAbs().maxCoeff() / numeric.cwiseAbs().maxCoeff();
}

/// Two free bodies on sliders, every force element between them or against the ground: motion axes are
/// constant there, so equation 78 (which drops their derivatives) is exact.
Mechanism sliding_bodies() {
  Mechanism m;
  for (int b = 0; b < 2; ++b) {
    for (int axis = 0; axis < 3; ++axis) {
      Body body;
      body.name = std::to_string(b) + "xyz"[axis];
      if (axis == 2) {
        body.mass = 1;
        body.inertia = Mat3<double>::Identity();
      }
      HingeOrSlider joint;
      joint.name = "slide " + body.name;
      joint.type = JointType::kPrismatic;
      joint.child = static_cast<int>(m.bodies.size());
      joint.parent = axis == 0 ? kGround : joint.child - 1;
      joint.axis = Vec3<double>::Unit(axis);
      joint.force = {.stiffness = 3,
                     .stiffness_cubic = 20,
                     .damping = 0.3,
                     .friction_force = 0.5,
                     .friction_speed = 0.7,
                     .rest = 0,
                     .rest_profile = {}};
      m.bodies.push_back(body);
      m.joints.push_back(joint);
    }
  }
  Force f;
  f.k = 40, f.c = 3, f.eps = 0.1, f.rest_length = 0.8;
  f.body_a = 2, f.body_b = 5;
  f.point_a = Vec3<double>(0.1, 0.2, 0.3), f.point_b = Vec3<double>(0.9, 0.1, 0.5);
  for (const SpringMode mode : {SpringMode::kBoth, SpringMode::kTension, SpringMode::kCompression}) {
    f.mode = mode;
    f.name = "spring " + std::to_string(static_cast<int>(mode));
    m.forces.push_back(f);
  }
  f.direction = Vec3<double>(0.6, 0, 0.8);
  f.radius = 0.25, f.c_lateral = 5;
  f.road = {{0.1, 0, 0.5}};
  for (const ForceType type : {ForceType::kAnchorSpring, ForceType::kContactPlane, ForceType::kTyre}) {
    f.type = type;
    f.name = "force " + std::to_string(static_cast<int>(type));
    m.forces.push_back(f);
  }
  return m;
}

TEST(Tangent, EveryForceLawHasItsExactDerivatives) {
  const Mechanism all = sliding_bodies();
  std::mt19937 random(20260711);
  std::normal_distribution<double> normal(0, 0.2);
  for (std::size_t i = 0; i < all.forces.size(); ++i) {
    Mechanism one = all;
    one.forces = {all.forces[i]};
    ASSERT_EQ(fault_of(one), "");
    const Model model(one);
    Vector q(6), qd(6);
    for (double& x : q) x = normal(random);
    for (double& x : qd) x = normal(random);
    Matrix stiffness, damping;
    analytic(model, 0.1, q, qd, stiffness, damping);
    // Differences over 1e-6 resolve about 1e-9 of the largest entry.
    EXPECT_LT(mismatch_of(
                  stiffness, [&](const Vector& x) { return coordinate_forces(model, 0.1, x, qd); }, q),
              1e-7)
        << all.forces[i].name;
    EXPECT_LT(mismatch_of(
                  damping, [&](const Vector& x) { return coordinate_forces(model, 0.1, q, x); }, qd),
              1e-7)
        << all.forces[i].name;
  }
}

TEST(Tangent, DampingIsExactOnEveryOpenMechanism) {
  // Rates do not enter the motion axes, so nothing is dropped.
  std::mt19937 random(20260712);
  for (const std::string& path : open_mechanisms()) {
    const Model model(loaded(path));
    const int n = model.size();
    Equations equations(model, Formulation::kRr, Tangent::kAnalytic);
    const Vector y = disturbed_start(equations, 0.2, random);
    Matrix stiffness, damping;
    analytic(model, 0.02, y.head(n), y.tail(n), stiffness, damping);
    if (damping.isZero()) continue;
    EXPECT_LT(mismatch_of(
                  damping, [&](const Vector& x) { return coordinate_forces(model, 0.02, y.head(n), x); },
                  y.tail(n)),
              1e-6)
        << path;
  }
}

TEST(Tangent, SolvesTheNewtonEquationsOfBothKinds) {
  // With the numeric tangent, one Newton step from a disturbed rate at fixed position solves the linear part:
  // the residual shrinks to second order.
  for (const Formulation formulation : {Formulation::kDsr, Formulation::kRr}) {
    const Model model(loaded(kOwn + "chain.json"));
    Equations equations(model, formulation, Tangent::kNumeric);
    Vector y, yp(2 * model.size()), r(2 * model.size());
    ASSERT_EQ(equations.start(y), "");
    ASSERT_TRUE(equations.derivative(0, y, yp));
    const double c = 200;
    ASSERT_TRUE(equations.tangent(0, y, yp, c, true));
    ASSERT_TRUE(equations.factorise(c));
    Vector away = y, rate = yp;
    away.array() += 1e-4;
    rate.array() += 1e-4 * c;
    Vector before(y.size());
    ASSERT_TRUE(equations.residual(0, away, rate, before));
    r = before;
    equations.solve(r);
    away -= r;
    rate -= c * r;
    ASSERT_TRUE(equations.residual(0, away, rate, r));
    EXPECT_LT(r.norm(), 1e-2 * before.norm());
  }
}

TEST(Tangent, AnalyticTangentSavesEvaluationsOnTheStiffDriver) {
  const Model model(loaded(kOwn + "driver_stiff.json"));
  // DASSL asks for a tangent whenever its step has doubled; ode15sR needs one altogether since its mass is
  // apart.
  SimulationSettings settings;
  settings.method = Method::kDassl;
  const SimulationResult analytic_run = simulate(model, settings);
  settings.tangent = Tangent::kNumeric;
  const SimulationResult numeric_run = simulate(model, settings);
  ASSERT_EQ(analytic_run.stopped, "");
  EXPECT_LT(analytic_run.evaluations.residuals, numeric_run.evaluations.residuals / 2);
  // As good a tangent: about as many steps. 10 %: what different matrices change in the choice of steps.
  EXPECT_NEAR(static_cast<double>(analytic_run.steps.steps), static_cast<double>(numeric_run.steps.steps),
              0.1 * static_cast<double>(numeric_run.steps.steps));
}

TEST(Tangent, MassApartLeavesFewTangentsToAskFor) {
  // Equations 81–83: the mass is renewed with every factorisation, so ∂f/∂y is asked for at the start and
  // where forces change, not whenever the mechanism has turned. Wanted: 2 on the driver, 10 on Bricard.
  for (const auto& [name, most] : {std::pair{"driver_nonstiff", 2}, {"driver_stiff", 2}, {"bricard", 10}}) {
    const Model model(loaded(kOwn + name + ".json"));
    for (const Tangent tangent : {Tangent::kAnalytic, Tangent::kNumeric}) {
      SimulationSettings settings;
      settings.tangent = tangent;
      const SimulationResult run = simulate(model, settings);
      ASSERT_EQ(run.stopped, "");
      EXPECT_LE(run.evaluations.tangents, most) << name;
    }
  }
}

/// c·M + D + K/c of a mechanism at a state.
Matrix iteration_matrix(const Model& model, double t, double c, const Vector& q, const Vector& qd) {
  BodyMotion motion(model);
  Matrix stiffness, damping, mass(model.size(), model.size());
  analytic(model, t, q, qd, stiffness, damping);
  move_to(model, q, motion);
  SemiRecursive(model).mass_matrix(motion, mass);
  return c * mass + damping + stiffness / c;
}

TEST(TreeFactor, SolvesAsADenseFactorDoesOnEveryOpenMechanism) {
  std::mt19937 random(20260713);
  std::normal_distribution<double> normal(0, 0.3);
  std::vector<Mechanism> all = {
      sliding_bodies()};  // springs between two branches: entries outside the tree's
  for (const std::string& path : open_mechanisms()) all.push_back(loaded(path));
  for (const Mechanism& mechanism : all) {
    const Model model(mechanism);
    TreeFactor factor(model);
    for (const double c : {1e2, 1e4}) {
      Vector q(model.size()), qd(model.size()), b(model.size());
      for (Vector* v : {&q, &qd, &b})
        for (double& x : *v) x = normal(random);
      const Matrix a = iteration_matrix(model, 0.1, c, q, qd);
      ASSERT_TRUE(factor.factorise(a)) << mechanism.name;
      Vector x = b;
      factor.solve(x);
      // Backward error: rounding of a hundred operations, and room for what pivoting would have saved.
      EXPECT_LT((a * x - b).norm(), 1e-10 * a.norm() * x.norm()) << mechanism.name << " c = " << c;
    }
  }
}

TEST(TreeFactor, LeavesOutWhatBranchesDoNotShare) {
  // 41 joints of the driver: arms, legs and head hang on a spine; no force goes from branch to branch.
  const Model model(loaded(kOwn + "driver_stiff.json"));
  EXPECT_LT(TreeFactor(model).entries(), 41 * 41 / 2);
}

TEST(TreeFactor, RefusesAMatrixThatAsksForPivoting) {
  const Model model(loaded(kOwn + "fivebar_pendulum.json"));
  TreeFactor factor(model);
  Matrix a = Matrix::Ones(5, 5);
  a(4, 4) = 0;
  EXPECT_FALSE(factor.factorise(a));
}

}  // namespace
}  // namespace sinew::multibody
