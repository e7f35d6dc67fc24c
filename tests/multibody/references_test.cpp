// Trajectories against the references in assets/mechanisms/reference (twelve digits, found by independent
// routes).
#include "mechanisms.h"

namespace sinew::multibody {
namespace {

struct Reference {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
};

Reference reference_of(const std::string& name) {
  std::ifstream file(kOwn + "reference/" + name + ".csv");
  Reference table;
  std::string line, cell;
  std::getline(file, line);
  for (std::stringstream cells(line); std::getline(cells, cell, ',');) table.columns.push_back(cell);
  while (std::getline(file, line)) {
    std::vector<double>& row = table.rows.emplace_back();
    for (std::stringstream cells(line); std::getline(cells, cell, ',');)
      row.push_back(std::atof(cell.c_str()));
  }
  return table;
}

struct Deviation {
  double q = 0, u = 0, point = 0;  ///< max |difference|/(1 + |value|) over all instants and coordinates
  double drift = 0;                ///< of kinetic + potential energy, J
  double closure = 0;              ///< m
  long steps = 0;
};

/// Joint coordinates and rates that the table has, by name; `nfourbar_2` has its first rocker only.
Deviation deviation(const std::string& name, Formulation formulation, Tangent tangent, Method method,
                    double tolerance, Closure closure = Closure::kInEvaluations) {
  const Reference reference = reference_of(name);
  const Mechanism mechanism = loaded(kOwn + name + ".json");
  const Model model(mechanism);
  SimulationSettings settings;
  settings.formulation = formulation;
  settings.tangent = tangent;
  settings.method = method;
  settings.closure = closure;
  settings.integrator.rtol = settings.integrator.atol = tolerance;
  for (const auto& row : reference.rows) settings.output.push_back(row[0]);
  const SimulationResult run = simulate(model, settings);
  EXPECT_EQ(run.stopped, "") << name;
  EXPECT_EQ(run.samples.size(), reference.rows.size()) << name;
  Deviation worst;
  worst.steps = run.steps.steps;
  const auto relative = [](double x, double is) { return std::abs(x - is) / (1 + std::abs(is)); };
  int compared = 0;
  for (std::size_t c = 1; c < reference.columns.size(); ++c) {
    const std::string kind = reference.columns[c].substr(0, 2);
    std::string of = reference.columns[c].substr(2);
    for (std::size_t s = 0; s < run.samples.size(); ++s) {
      const Sample& sample = run.samples[s];
      const double is = reference.rows[s][c];
      for (int i = 0; i < model.size(); ++i) {
        if (mechanism.joints[i].name != of) continue;
        if (kind == "q:") worst.q = std::max(worst.q, relative(sample.y[i], is)), ++compared;
        if (kind == "u:") worst.u = std::max(worst.u, relative(sample.y[model.size() + i], is));
      }
      for (std::size_t p = 0; p < mechanism.points.size(); ++p)
        if (mechanism.points[p].name == of && kind[0] >= 'x' && kind[0] <= 'z')
          worst.point = std::max(worst.point, relative(sample.points[p][kind[0] - 'x'], is));
    }
  }
  EXPECT_GT(compared, 0) << name;
  for (const Sample& s : run.samples) {
    worst.closure = std::max(worst.closure, s.closure);
    const Sample& first = run.samples.front();
    worst.drift = std::max(worst.drift, std::abs(s.kinetic + s.potential - first.kinetic - first.potential));
  }
  return worst;
}

struct Case {
  const char* name;
  /// Allowed deviation of positions and of rates in units of the tolerance: how much the mechanism amplifies
  /// an error until its end (section 3 of the research notes), and how many steps' local errors add up.
  double q_factor, u_factor;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class References : public testing::TestWithParam<Case> {
 protected:
  void expect_agreement(Formulation formulation, Tangent tangent, Method method) const {
    for (const double tolerance : {1e-6, 1e-9}) {
      const Case& c = GetParam();
      const Deviation d = deviation(c.name, formulation, tangent, method, tolerance);
      EXPECT_LT(d.q, c.q_factor * tolerance) << c.name << " at " << tolerance;
      EXPECT_LT(d.u, c.u_factor * tolerance) << c.name << " at " << tolerance;
      EXPECT_LT(d.point, c.q_factor * tolerance) << c.name << " at " << tolerance;
      EXPECT_LT(d.closure, 1e-8) << c.name;
    }
  }
};

TEST_P(References, ShampineGordonOnDerivatives) {
  expect_agreement(Formulation::kDsr, Tangent::kNumeric, Method::kDe);
}
TEST_P(References, Ode15sOnDerivatives) {
  expect_agreement(Formulation::kDsr, Tangent::kAnalytic, Method::kOde15s);
}
TEST_P(References, Ode15sROnResidualsWithAnalyticTangent) {
  expect_agreement(Formulation::kRr, Tangent::kAnalytic, Method::kOde15sR);
}
TEST_P(References, Ode15sROnResidualsWithNumericTangent) {
  expect_agreement(Formulation::kRr, Tangent::kNumeric, Method::kOde15sR);
}
TEST_P(References, DasslOnResiduals) {
  expect_agreement(Formulation::kRr, Tangent::kAnalytic, Method::kDassl);
}
TEST_P(References, StrictDasslOnResiduals) {
  expect_agreement(Formulation::kRr, Tangent::kAnalytic, Method::kDasslStrict);
}

INSTANTIATE_TEST_SUITE_P(Mechanisms, References,
                         testing::Values(Case{"fivebar_pendulum", 1e4, 1e5}, Case{"fivebar_planar", 1e5, 1e5},
                                         Case{"driver_nonstiff", 1e2, 1e4}, Case{"driver_stiff", 1e2, 1e3},
                                         Case{"driver_nonstiff_hands", 1e2, 1e4},
                                         Case{"driver_stiff_hands", 1e2, 1e3}, Case{"bricard", 1e3, 1e3},
                                         Case{"bricard_slender", 1e3, 1e3}, Case{"suspension_5ps", 1e2, 1e3},
                                         Case{"suspension_mfs", 1e2, 1e3}, Case{"slider_crank", 1e5, 1e5},
                                         Case{"nfourbar_2", 1e4, 1e5}, Case{"governor", 1e3, 1e4}),
                         [](const auto& given) { return std::string(given.param.name); });

TEST(Reference, ArticulatedInertiasReachTheDigitsOfTheTables) {
  // At 1e-13 what is left is rounding amplified by the motion: 14 × angles for the five-bar, 1.5 for the
  // driver.
  for (const char* name : {"fivebar_pendulum", "driver_nonstiff"}) {
    const Deviation d = deviation(name, Formulation::kDtr, Tangent::kNumeric, Method::kDe, 1e-13);
    EXPECT_LT(d.q, 1e-10) << name;
  }
}

TEST(Reference, AndrewsSqueezerEndsWhereTheTestSetSays) {
  // Published digits of the Test Set for IVP Solvers. Its own equations, integrated in extended precision
  // from its own start, end 7e-11 from them in positions and 3e-8 in rates, and within 1e-12 of what is found
  // here.
  for (const auto& [formulation, tangent, method] :
       {std::tuple{Formulation::kDsr, Tangent::kNumeric, Method::kDe},
        {Formulation::kRr, Tangent::kAnalytic, Method::kOde15sR},
        {Formulation::kRr, Tangent::kNumeric, Method::kDasslStrict}}) {
    const Deviation d = deviation("andrews", formulation, tangent, method, 1e-12);
    EXPECT_LT(d.q, 2e-10);
    EXPECT_LT(d.u, 1e-7);
  }
}

TEST(Reference, GovernorKeepsEnergyAndSpin) {
  // No torque about the shaft, no damping. 1e3 tolerances: the local errors of the steps add up.
  const Model model(loaded(kOwn + "governor.json"));
  SimulationSettings settings;
  settings.integrator.rtol = settings.integrator.atol = 1e-9;
  settings.output = instants(2, 20);
  const SimulationResult run = simulate(model, settings);
  ASSERT_EQ(run.stopped, "");
  const int n = model.size();
  BodyMotion motion(model);
  double spin = 0;
  for (const Sample& s : run.samples) {
    // Angular momentum about the vertical is what a unit rate of the shaft does work on: row `spin` of M q'.
    Matrix mass(n, n);
    move_to(model, s.y.head(n), motion);
    SemiRecursive(model).mass_matrix(motion, mass);
    const double now = mass.row(0).dot(s.y.tail(n));
    if (s.t == 0) spin = now;
    EXPECT_NEAR(now, spin, 1e-6 * spin) << s.t;
    EXPECT_NEAR(s.kinetic + s.potential, run.samples.front().kinetic + run.samples.front().potential, 1e-6);
  }
}

TEST(Reference, ClosingOncePerStepReachesTheSameMotion) {
  // Index 2, as the paper has it: positions drift by a step's local error before they are closed, so the
  // factors are those of the tables above.
  for (const Case& c :
       {Case{"bricard", 1e3, 1e3}, Case{"suspension_5ps", 1e2, 1e3}, Case{"suspension_mfs", 1e2, 1e3},
        Case{"driver_stiff_hands", 1e2, 1e3}, Case{"governor", 1e3, 1e4}})
    for (const auto& [formulation, tangent, method] :
         {std::tuple{Formulation::kDsr, Tangent::kNumeric, Method::kDe},
          {Formulation::kDsr, Tangent::kAnalytic, Method::kOde15s},
          {Formulation::kRr, Tangent::kNumeric, Method::kOde15sR},
          {Formulation::kRr, Tangent::kAnalytic, Method::kOde15sR},
          {Formulation::kRr, Tangent::kAnalytic, Method::kDasslStrict}}) {
      const double tolerance = 1e-7;
      const Deviation d = deviation(c.name, formulation, tangent, method, tolerance, Closure::kInSteps);
      EXPECT_LT(d.q, c.q_factor * tolerance) << c.name;
      EXPECT_LT(d.u, c.u_factor * tolerance) << c.name;
      EXPECT_LT(d.closure, 1e-8) << c.name;
    }
}

TEST(Reference, SingularPositionsArePassedWhenClosingOncePerStep) {
  // The Cholesky factor gives way to the orthogonal one there.
  const Deviation d = deviation("nfourbar_2", Formulation::kRr, Tangent::kAnalytic, Method::kOde15sR, 1e-7,
                                Closure::kInSteps);
  EXPECT_LT(d.q, 1e-3);  // 1e4 tolerances
  EXPECT_LT(d.closure, 1e-8);
}

TEST(Reference, BricardKeepsEnergyAndClosureInHundredsOfSteps) {
  for (const auto& [formulation, tangent, method] :
       {std::tuple{Formulation::kDsr, Tangent::kNumeric, Method::kDe},
        {Formulation::kRr, Tangent::kAnalytic, Method::kOde15sR},
        {Formulation::kRr, Tangent::kNumeric, Method::kOde15sR},
        {Formulation::kDsr, Tangent::kNumeric, Method::kDasslStrict},
        {Formulation::kRr, Tangent::kNumeric, Method::kDasslStrict},
        {Formulation::kRr, Tangent::kAnalytic, Method::kDasslStrict}}) {
    const Deviation d = deviation("bricard", formulation, tangent, method, 1e-5);
    EXPECT_LT(d.drift, 1e-3);    // J
    EXPECT_LT(d.closure, 1e-8);  // m
    EXPECT_LT(d.steps, 1000);
  }
}

TEST(Reference, PublishedDasslDriftsWhereTheStrictVariantDoesNot) {
  // It keeps a rate of convergence from step to step, which is too hopeful where the mass turns: it misses
  // the 1e-3 J of the test above, a known failure and the reason why the strict variant exists.
  double drift = 0;
  for (const Tangent tangent : {Tangent::kNumeric, Tangent::kAnalytic}) {
    const Deviation d = deviation("bricard", Formulation::kRr, tangent, Method::kDassl, 1e-5);
    drift = std::max(drift, d.drift);
    EXPECT_LT(d.closure, 1e-8);  // m
  }
  EXPECT_GT(drift, 1e-3) << "J: DASSL as published keeps energy now and belongs into the test above";
}

TEST(Reference, FixedStepSchemesConvergeToTheReference) {
  for (const char* name : {"driver_stiff", "bricard"}) {
    const Reference reference = reference_of(name);
    const Model model(loaded(kOwn + name + ".json"));
    double error[2];
    for (int i = 0; i < 2; ++i) {
      SimulationSettings settings;
      settings.method = Method::kBdf2;
      settings.t_end = settings.output.emplace_back(reference.rows[5][0]);
      settings.integrator.rtol = settings.integrator.atol = 1e-8;
      settings.integrator.fixed_step = settings.t_end / (i == 0 ? 500 : 1000);
      const SimulationResult run = simulate(model, settings);
      ASSERT_EQ(run.stopped, "");
      error[i] = 0;
      for (int k = 0; k < model.size(); ++k)
        error[i] = std::max(error[i], std::abs(run.samples.back().y[k] - reference.rows[5][1 + k]));
    }
    EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.3) << name;
  }
}

TEST(Reference, FixedStepSchemesCrossSingularPositions) {
  const Model model(loaded(kOwn + "nfourbar_2.json"));
  for (const Method method : {Method::kBdf1, Method::kBdf2}) {
    SimulationSettings settings;
    settings.method = method;
    settings.output = {10};
    const SimulationResult run = simulate(model, settings);
    EXPECT_EQ(run.stopped, "");
    EXPECT_LT(run.samples.back().closure, 1e-8);
  }
}

TEST(Reference, SingularPositionsArePassedAtEveryTolerance) {
  // In the horizontal position the loops lose rank and rounding is magnified without bound; steps that shrank
  // on its account would never get across.
  for (const double tolerance : {1e-4, 1e-5, 1e-7, 1e-8, 1e-10})
    for (const auto& [formulation, tangent, method] :
         {std::tuple{Formulation::kDsr, Tangent::kNumeric, Method::kDe},
          {Formulation::kDsr, Tangent::kAnalytic, Method::kOde15s},
          {Formulation::kRr, Tangent::kAnalytic, Method::kOde15sR},
          {Formulation::kRr, Tangent::kAnalytic, Method::kDassl}}) {
      const Deviation d = deviation("nfourbar_2", formulation, tangent, method, tolerance);
      EXPECT_LT(d.q, 1e4 * tolerance) << tolerance;
      EXPECT_LT(d.closure, 1e-8) << tolerance;
    }
}

TEST(Reference, FourBarPassesItsDeadPointsOverAndOver) {
  // Started at rest above its horizontal stretch, the own four-bar swings through positions in which other
  // coordinates must become independent; energy and closure hold throughout.
  const Model model(loaded(kOwn + "four_bar.json"));
  SimulationSettings settings;
  settings.integrator.rtol = settings.integrator.atol = 1e-8;
  settings.output = instants(2, 40);
  const SimulationResult run = simulate(model, settings);
  ASSERT_EQ(run.stopped, "");
  for (const Sample& s : run.samples) {
    EXPECT_LT(s.closure, 1e-10);
    EXPECT_NEAR(s.kinetic + s.potential, run.samples.front().potential, 1e-4);  // 1e4 tolerances
  }
}

TEST(Reference, EnergyBalanceHoldsWithEveryForceElement) {
  const Model model(loaded(kOwn + "chain.json"));
  SimulationSettings settings;
  settings.integrator.rtol = settings.integrator.atol = 1e-8;
  settings.output = instants(1, 20);
  settings.energy = true;
  const SimulationResult run = simulate(model, settings);
  ASSERT_EQ(run.stopped, "");
  EXPECT_LT(run.samples.back().work, -0.1);  // the dampers have taken something
  for (const Sample& s : run.samples) {
    const Sample& first = run.samples.front();
    EXPECT_NEAR(s.kinetic + s.potential - s.work, first.kinetic + first.potential, 1e-6);
  }
}

}  // namespace
}  // namespace sinew::multibody
