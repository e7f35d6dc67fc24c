// The integrators by themselves: orders, stiffness, interpolation, and how they stop.
#include "mechanisms.h"

namespace sinew::multibody {
namespace {

/// x'' = −x: known solution, not stiff.
class Oscillator : public System {
 public:
  int size() const override { return 2; }
  bool derivative(double, const Vector& y, Vector& yp) override {
    yp << y[1], -y[0];
    return true;
  }
  bool residual(double t, const Vector& y, const Vector& yp, Vector& r) override {
    Vector f(2);
    derivative(t, y, f);
    r = yp - f;
    return true;
  }
  bool tangent(double, const Vector&, const Vector&, double, bool) override { return true; }
  bool factorise(double c) override {
    c_ = c;
    return true;
  }
  void solve(Vector& r) override {  // [c −1; 1 c]⁻¹
    const double d = c_ * c_ + 1;
    r = Vector{{(c_ * r[0] + r[1]) / d, (c_ * r[1] - r[0]) / d}};
  }

 private:
  double c_ = 0;
};

struct Walk {
  double error = 0;
  long steps = 0;
};

constexpr double kWalkTime = 10;  ///< s

Walk walk(Method method, int max_order, double tolerance) {
  Oscillator system;
  const Vector y0{{1, 0}};
  IntegratorSettings settings{.rtol = tolerance, .atol = tolerance, .max_order = max_order};
  const auto integrator = start(method, system, 0, y0, kWalkTime, settings);
  while (integrator->time() < kWalkTime)
    if (const std::string why = integrator->step(); !why.empty()) {
      ADD_FAILURE() << why;
      break;
    }
  const Vector y = integrator->at(kWalkTime);
  return {(y - Vector{{std::cos(kWalkTime), -std::sin(kWalkTime)}}).norm(), integrator->counts().steps};
}

/// Slope of log(error) over log(steps): least squares over tolerances spread evenly from loose to tight.
double measured_order(Method method, int max_order, double loose, double tight) {
  constexpr int kWalks = 13;
  Eigen::MatrixX2d line(kWalks, 2);
  Vector errors(kWalks);
  for (int i = 0; i < kWalks; ++i) {
    const Walk w = walk(method, max_order, loose * std::pow(tight / loose, double(i) / (kWalks - 1)));
    line.row(i) << std::log(static_cast<double>(w.steps)), 1;
    errors[i] = std::log(w.error);
  }
  return -line.householderQr().solve(errors)[0];
}

TEST(Integrators, OdeSuiteAndDasslShowTheOrderTheyAreLimitedTo) {
  // Error ~ steps^−k. Half an order is the scatter of the slope; DASSL, which keeps a step until it can be
  // doubled, scatters more, too much for order 5 (5.7 here).
  const auto slope = [](Method method, int k) {
    return k == 1 ? measured_order(method, k, 1e-4, 1e-7) : measured_order(method, k, 1e-6, 1e-9);
  };
  for (int k = 1; k <= 5; ++k) EXPECT_NEAR(slope(Method::kOde15sR, k), k, 0.5) << "ode15sR, order " << k;
  for (int k = 1; k <= 4; ++k)
    for (const Method method : {Method::kDassl, Method::kDasslStrict})
      EXPECT_NEAR(slope(method, k), k, 0.6) << "DASSL, order " << k;
}

TEST(Integrators, ShampineGordonShowsItsOrderWithLocalExtrapolation) {
  // Predictor of order k, corrector extrapolated to k + 1. From order 6 on the short steps of the start,
  // taken at lower orders, are too large a share of all to read a slope off.
  for (int k = 1; k <= 5; ++k)
    EXPECT_NEAR(measured_order(Method::kDe, k, 1e-5, 1e-9), k + 1, 0.5) << "limited to order " << k;
}

TEST(Integrators, ShampineGordonUsesHighOrdersForTightTolerances) {
  Oscillator system;
  const Vector y0{{1, 0}};
  const auto integrator = start(Method::kDe, system, 0, y0, kWalkTime, {.rtol = 1e-12, .atol = 1e-12});
  int highest = 0;
  while (integrator->time() < kWalkTime) {
    ASSERT_EQ(integrator->step(), "");
    highest = std::max(highest, integrator->order());
  }
  EXPECT_GE(highest, 9);
  EXPECT_LE(highest, 12);
}

TEST(Integrators, FixedStepSchemesAreOfFirstAndSecondOrder) {
  for (const auto& [method, order] : {std::pair{Method::kBdf1, 1}, {Method::kBdf2, 2}}) {
    double error[2];
    for (int i = 0; i < 2; ++i) {
      Oscillator system;
      const Vector y0{{1, 0}};
      const auto integrator =
          start(method, system, 0, y0, 2, {.rtol = 1e-10, .atol = 1e-10, .fixed_step = i == 0 ? 2e-3 : 1e-3});
      while (integrator->time() < 2 - 1e-9) ASSERT_EQ(integrator->step(), "");
      error[i] = (integrator->at(2) - Vector{{std::cos(2), -std::sin(2)}}).norm();
    }
    EXPECT_NEAR(std::log2(error[0] / error[1]), order, 0.1);
  }
}

TEST(Integrators, InterpolationInsideAStepIsAsGoodAsItsEnds) {
  for (const Method method : {Method::kDe, Method::kOde15sR, Method::kDassl, Method::kDasslStrict}) {
    Oscillator system;
    const Vector y0{{1, 0}};
    const auto integrator = start(method, system, 0, y0, kWalkTime, {.rtol = 1e-8, .atol = 1e-8});
    double at_ends = 0, inside = 0;
    while (integrator->time() < kWalkTime) {
      ASSERT_EQ(integrator->step(), "");
      const double t = integrator->time(), middle = t - 0.4 * integrator->last_step();
      at_ends = std::max(at_ends, std::abs(integrator->state()[0] - std::cos(t)));
      inside = std::max(inside, std::abs(integrator->at(middle)[0] - std::cos(middle)));
    }
    EXPECT_LT(inside, 2 * at_ends + 1e-8);  // plus one tolerance: the error of the polynomial itself
  }
}

TEST(Integrators, PendulumComesBackAfterThePeriodOfTheEllipticIntegral) {
  // T = 4 √(2L/3g) K(sin(θ/2)), released at 90° from the vertical; K by the arithmetic–geometric mean.
  double a = 1, b = std::cos(M_PI / 4);
  for (int i = 0; i < 8; ++i) {
    const double mean = (a + b) / 2;
    b = std::sqrt(a * b);
    a = mean;
  }
  const double period = 4 * std::sqrt(2 / (3 * 9.81)) * M_PI / (2 * a);
  const Model model(loaded(kOwn + "pendulum.json"));
  for (const auto& [formulation, method] : {std::pair{Formulation::kDtr, Method::kDe},
                                            {Formulation::kRr, Method::kOde15sR},
                                            {Formulation::kRr, Method::kDassl}}) {
    SimulationSettings settings;
    settings.formulation = formulation;
    settings.tangent = formulation == Formulation::kDtr ? Tangent::kNumeric : Tangent::kAnalytic;
    settings.method = method;
    settings.integrator.rtol = settings.integrator.atol = 1e-10;
    settings.t_end = period;
    settings.output = {period};
    const SimulationResult run = simulate(model, settings);
    ASSERT_EQ(run.stopped, "");
    // 1e3 tolerances: the local errors of the steps of one period add up.
    EXPECT_LT(run.samples.back().y.norm(), 1e-7);
  }
}

TEST(Integrators, StiffMechanismIsReportedByTheExplicitMethodOnly) {
  const Model model(loaded(kOwn + "driver_stiff.json"));
  SimulationSettings settings;
  const SimulationResult implicit = simulate(model, settings);
  settings.formulation = Formulation::kDtr;
  settings.tangent = Tangent::kNumeric;
  settings.method = Method::kDe;
  const SimulationResult explicit_run = simulate(model, settings);
  EXPECT_TRUE(explicit_run.looks_stiff);
  EXPECT_FALSE(implicit.looks_stiff);
  EXPECT_GT(explicit_run.steps.steps, 3 * implicit.steps.steps);
}

TEST(Integrators, UnreachableTolerancesStopWithTimeReasonAndWhatWasComputed) {
  const Model model(loaded(kOwn + "chain.json"));
  for (const auto& [formulation, method] : {std::pair{Formulation::kDsr, Method::kDe},
                                            {Formulation::kDsr, Method::kOde15s},
                                            {Formulation::kRr, Method::kOde15sR},
                                            {Formulation::kRr, Method::kDassl}}) {
    SimulationSettings settings;
    settings.formulation = formulation;
    settings.method = method;
    settings.integrator.rtol = settings.integrator.atol = 1e-16;
    settings.output = instants(1, 10);
    const SimulationResult run = simulate(model, settings);
    EXPECT_NE(run.stopped.find("stopped at t = "), std::string::npos);
    EXPECT_NE(run.stopped.find("tolerance"), std::string::npos);
    ASSERT_FALSE(run.samples.empty());
    EXPECT_EQ(run.samples.front().t, 0);
  }
}

TEST(Integrators, MotionTooFastForItsToleranceStopsInsteadOfGoingOnForHours) {
  Mechanism fast = loaded(kOwn + "figure1.json");
  fast.gravity *= 1e12;
  SimulationSettings settings;
  settings.max_steps = 2000;
  settings.output = instants(1, 10);
  const Model model(fast);
  const SimulationResult run = simulate(model, settings);
  EXPECT_NE(run.stopped.find("the most steps allowed"), std::string::npos) << run.stopped;
  EXPECT_EQ(run.steps.steps, 2000);
  EXPECT_GT(run.samples.back().t, 0);
}

TEST(Integrators, FormulationsThatDoNotFitTheMethodAreRefusedWithTheOneThatDoes) {
  const Model open(loaded(kOwn + "chain.json")), closed(loaded(kOwn + "four_bar.json"));
  SimulationSettings settings;
  settings.method = Method::kDe;
  EXPECT_NE(mismatch(open, settings).find("DTR or DSR"), std::string::npos);
  settings.formulation = Formulation::kDtr;
  settings.tangent = Tangent::kNumeric;
  EXPECT_EQ(mismatch(open, settings), "");
  EXPECT_NE(mismatch(closed, settings).find("DSR-Rz"), std::string::npos);
  settings.method = Method::kOde15sR;
  EXPECT_NE(mismatch(open, settings).find("RR"), std::string::npos);
}

}  // namespace
}  // namespace sinew::multibody
