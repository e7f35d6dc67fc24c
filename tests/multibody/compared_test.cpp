// What the runtime's formulations and integrators are compared with: global formulations in Cartesian
// coordinates, and RADAU5.
#include "mechanisms.h"
#include "study/tables/global/cartesian_equations.h"
#include "study/tables/radau5.h"
#include "study/tables/walk.h"

namespace sinew::study {
namespace {

using multibody::BodyMotion;
using multibody::Equations;
using multibody::Formulation;
using multibody::Model;
using multibody::Tangent;
using multibody::Vector;

/// Accelerations of the bodies, [6·bodies], by DSR at a state with closed loops.
Vector body_accelerations(const Model& model, Equations& equations, const Vector& joints) {
  Vector rates(joints.size());
  EXPECT_TRUE(equations.derivative(0, joints, rates));
  const int n = model.size();
  BodyMotion motion(model);
  move_to(model, joints.head(n), motion);
  set_rates(model, joints.tail(n), motion);
  accelerate(model, rates.tail(n), motion);
  Vector out(6 * n);
  for (int i = 0; i < n; ++i)
    out.segment<6>(6 * i) << acceleration_at(motion, i, motion.pose.center[i]), motion.alpha[i];
  return out;
}

/// √(aᵀ M a): accelerations by what they move. The spin of a strut's thin rod (1e-6 kg·m²) does not count as
/// much as the car's.
double weighed(const Model& model, const BodyMotion& motion, const Vector& a) {
  double sum = 0;
  for (int i = 0; i < model.size(); ++i) {
    const Vec3<double> turning = motion.pose.rotation[i].transpose() * a.segment<3>(6 * i + 3);
    sum +=
        model.tree.mass[i] * a.segment<3>(6 * i).squaredNorm() + turning.dot(model.tree.inertia[i] * turning);
  }
  return std::sqrt(sum);
}

/// Largest difference of accelerations between a global formulation and DSR, over the accelerations or
/// gravity, whichever is larger (some start at rest), at the start and at states near it.
double difference(const std::string& path, GlobalClosure closure) {
  const Model model(multibody::loaded(path));
  Equations equations(model, Formulation::kDsr, Tangent::kNumeric);
  CartesianEquations global(model, closure);
  Vector start;
  EXPECT_EQ(global.start(start), "");
  std::mt19937 random(7);
  double worst = 0;
  for (const double away : {0.0, 0.02, 0.02}) {
    Vector joints = disturbed_start(equations, away, random);
    EXPECT_TRUE(equations.close(joints));
    const Vector is = body_accelerations(model, equations, joints);
    Vector rates;
    EXPECT_TRUE(global.derivative(0, global.state_of(joints), rates)) << path;
    Vector gravity = Vector::Zero(is.size());
    for (int i = 0; i < model.size(); ++i) gravity.segment<3>(6 * i) = model.mechanism().gravity;
    const auto size = [&](const Vector& a) { return weighed(model, global.motion(), a); };
    worst = std::max(worst, size(rates.tail(is.size()) - is) / std::max(size(is), size(gravity)));
  }
  return worst;
}

std::vector<std::string> all_mechanisms() {
  std::vector<std::string> all = multibody::open_mechanisms();
  for (const std::string& path : multibody::closed_mechanisms()) all.push_back(path);
  return all;
}

TEST(GlobalFormulation, MultipliersGiveTheAccelerationsOfTheSemiRecursiveOne) {
  for (const std::string& path : all_mechanisms())
    EXPECT_LT(difference(path, GlobalClosure::kMultipliers), 1e-9) << path;  // rounding of two sparse solves
}

TEST(GlobalFormulation, PenaltyGivesThemUpToTheForcesOfTheJointsOverThePenalty) {
  // α is 1e7 mean masses: equations are violated by 1e-7 of the accelerations that the forces of joints alone
  // would cause, which may be a thousand times those of the motion.
  for (const std::string& path : all_mechanisms())
    EXPECT_LT(difference(path, GlobalClosure::kPenalty), 1e-4) << path;
}

TEST(GlobalFormulation, JointCoordinatesComeBackFromTheBodies) {
  for (const std::string& path : all_mechanisms()) {
    const Model model(multibody::loaded(path));
    Equations equations(model, Formulation::kDsr, Tangent::kNumeric);
    std::mt19937 random(3);
    const Vector joints = disturbed_start(equations, 0.1, random);
    CartesianEquations global(model, GlobalClosure::kPenalty);
    // Rounding of Euler parameters, by rates up to tens of rad/s.
    EXPECT_LT((global.joints_of(global.state_of(joints)) - joints).cwiseAbs().maxCoeff(), 1e-11) << path;
  }
}

SimulationRun run_of(const char* mechanism, const char* formulation, const char* integrator,
                     double tolerance) {
  StudyCase c;
  EXPECT_EQ(load_case(source_dir() + "/assets/mechanisms", mechanism, c), "");
  return measure(c, formulation, integrator, tolerance, 1);
}

TEST(GlobalFormulation, ComesToTheReferenceMotion) {
  // Open, stiff, over-constrained (equations left out), driven with three redundant ones. Factors of the
  // tolerance as in references_test.cpp.
  struct Row {
    const char *mechanism, *integrator;
    double factor;
  };
  for (const Row& row : {Row{"fivebar_pendulum", "DE", 1e4}, Row{"driver_stiff", "ode15s", 1e2},
                         Row{"bricard", "DE", 1e3}, Row{"andrews", "DE", 1e2}})
    for (const char* formulation : {"Cartesian-multipliers", "Cartesian-penalty"}) {
      const SimulationRun m = run_of(row.mechanism, formulation, row.integrator, 1e-6);
      EXPECT_EQ(m.stopped, "") << row.mechanism << " " << m.method;
      EXPECT_LT(m.error.q, row.factor * 1e-6) << row.mechanism << " " << m.method;
      EXPECT_LT(m.closure, 1e-4) << row.mechanism << " " << m.method;  // 1e2 tolerances
    }
}

TEST(GlobalFormulation, OneTangentServesTheStiffDriverAsItDoesInJointCoordinates) {
  for (const char* formulation : {"Cartesian-multipliers", "Cartesian-penalty"})
    EXPECT_LE(run_of("driver_stiff", formulation, "ode15s", 1e-5).tangents, 3) << formulation;
}

/// x'' = −x, with both halves of its iteration matrix [c −1; 1 c].
class Oscillator : public multibody::System {
 public:
  int size() const override { return 2; }
  bool derivative(double, const Vector& y, Vector& yp) override {
    yp = Vector{{y[1], -y[0]}};
    return true;
  }
  bool residual(double t, const Vector& y, const Vector& yp, Vector& r) override {
    derivative(t, y, r);
    r = yp - r;
    return true;
  }
  bool tangent(double, const Vector&, const Vector&, double, bool) override { return true; }
  bool factorise(double c) override {
    c_ = c;
    return true;
  }
  void solve(Vector& r) override { r = Vector(solved<double>(c_, r)); }

  ComplexHalf complex_half() {
    return {[this](std::complex<double> c) {
              complex_c_ = c;
              return true;
            },
            [this](Eigen::VectorXcd& r) { r = solved<std::complex<double>>(complex_c_, r); }};
  }

 private:
  template <class Scalar>
  static multibody::VectorOf<Scalar> solved(Scalar c, const multibody::VectorOf<Scalar>& r) {
    const Scalar d = c * c + 1.0;
    return multibody::VectorOf<Scalar>{{(c * r[0] + r[1]) / d, (c * r[1] - r[0]) / d}};
  }

  double c_ = 0;
  std::complex<double> complex_c_;
};

struct Walked {
  double error = 0, worst_inside = 0;
  long steps = 0;
};

/// Ten seconds of it; also the largest error in the middle of steps.
Walked walked(double tolerance) {
  Oscillator system;
  Radau5 radau(system, system.complex_half(), 0, Vector{{1, 0}}, 10, {.rtol = tolerance, .atol = tolerance});
  const auto error = [&](double t) { return (radau.at(t) - Vector{{std::cos(t), -std::sin(t)}}).norm(); };
  Walked w;
  while (radau.time() < 10) {
    if (const std::string why = radau.step(); !why.empty()) {
      ADD_FAILURE() << why;
      break;
    }
    w.worst_inside = std::max(w.worst_inside, error(radau.time() - 0.5 * radau.last_step()));
  }
  w.error = error(10);
  w.steps = radau.counts().steps;
  return w;
}

TEST(Radau5, IsOfOrderFive) {
  // Slope of log(error) over log(steps), by least squares; half an order is the scatter of the slope.
  constexpr int kWalks = 9;
  Eigen::MatrixX2d line(kWalks, 2);
  Vector errors(kWalks);
  for (int i = 0; i < kWalks; ++i) {
    const Walked w = walked(1e-5 * std::pow(10, -0.5 * i));
    line.row(i) << std::log(static_cast<double>(w.steps)), 1;
    errors[i] = std::log(w.error);
  }
  EXPECT_NEAR(-line.householderQr().solve(errors)[0], 5, 0.5);
}

TEST(Radau5, InterpolatesByCollocation) {
  // The polynomial inside a step is of order 3, and its local error what the step control keeps below the
  // method's own tolerance, 0.1·tol^(2/3).
  const double tolerance = 1e-7;
  EXPECT_LT(walked(tolerance).worst_inside, std::pow(tolerance, 2.0 / 3));
}

TEST(Radau5, ReachesThePublishedDigitsOfAndrewsSqueezer) {
  // As the other methods do in references_test.cpp, where it is said how far the digits can be trusted.
  for (const char* formulation : {"RR-Rz-JF", "DSR-Rz"}) {
    const SimulationRun m = run_of("andrews", formulation, "RADAU5", 1e-11);
    EXPECT_EQ(m.stopped, "");
    EXPECT_LT(m.error.q, 2e-10) << formulation;
    EXPECT_LT(m.error.u, 1e-7) << formulation;
  }
}

TEST(Radau5, TakesResidualsAndDerivativesOfOpenAndClosedMechanisms) {
  struct Row {
    const char *mechanism, *formulation;
    double factor;
  };
  for (const Row& row : {Row{"fivebar_pendulum", "RR-JN", 1e4}, Row{"driver_stiff", "RR-JF", 1e2},
                         Row{"driver_stiff", "DSR-JF", 1e2}, Row{"suspension_mfs", "RR-Rz2-JF", 1e2},
                         Row{"bricard", "DSR-Rz-JF", 1e3}, Row{"nfourbar_2", "RR-Rz-JF", 1e4}}) {
    const SimulationRun m = run_of(row.mechanism, row.formulation, "RADAU5", 1e-6);
    EXPECT_EQ(m.stopped, "") << row.mechanism << " " << row.formulation;
    EXPECT_LT(m.error.q, row.factor * 1e-6) << row.mechanism << " " << row.formulation;
  }
}

TEST(Radau5, UnreachableTolerancesStopWithTimeAndReason) {
  const SimulationRun m = run_of("fivebar_pendulum", "RR-JF", "RADAU5", 1e-24);
  EXPECT_NE(m.stopped.find("stopped at t = "), std::string::npos) << m.stopped;
  EXPECT_NE(m.stopped.find("tolerance"), std::string::npos) << m.stopped;
}

TEST(BadRow, UnknownNamesAndPairsThatDoNotFitAreSaid) {
  const auto said = [](const char* formulation, const char* integrator) {
    return run_of("bricard", formulation, integrator, 1e-5).stopped;
  };
  EXPECT_NE(said("Cartesian-lagrange", "DE").find("unknown formulation 'Cartesian-lagrange'"),
            std::string::npos);
  EXPECT_NE(said("RR-JF", "RADAU9").find("unknown integrator 'RADAU9'"), std::string::npos);
  EXPECT_NE(said("Cartesian-penalty", "RADAU5").find("RADAU5"), std::string::npos);
  EXPECT_NE(said("Cartesian-penalty", "ode15sR").find("use ode15s"), std::string::npos);
  EXPECT_NE(said("DTR", "DE").find("open chains"), std::string::npos);
}

TEST(BadRow, MechanismThatCannotBeAssembledNamesItsLoop) {
  multibody::Mechanism apart = multibody::loaded(multibody::kOwn + "four_bar.json");
  apart.loops[0].point_a += Vec3<double>(10, 0, 0);
  const Model model(apart);
  for (const auto& [formulation, integrator] :
       {std::pair{"Cartesian-penalty", "DE"}, {"Cartesian-multipliers", "DE"}, {"RR-Rz-JF", "RADAU5"}}) {
    SimulationRun run;
    Trajectory out;
    walk(model, formulation, integrator, 1e-5, {}, run, out);
    EXPECT_NE(run.stopped.find("loop '" + apart.loops[0].name + "'"), std::string::npos) << run.stopped;
  }
}

TEST(BadRow, StateThatIsNotFiniteIsRefused) {
  const Model model(multibody::loaded(multibody::kOwn + "four_bar.json"));
  CartesianEquations global(model, GlobalClosure::kMultipliers);
  Vector state, rates;
  ASSERT_EQ(global.start(state), "");
  ASSERT_TRUE(global.derivative(0, state, rates));
  state[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(global.derivative(0, state, rates));
}

}  // namespace
}  // namespace sinew::study
