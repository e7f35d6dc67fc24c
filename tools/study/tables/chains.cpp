#include "study/tables/chains.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include "study/tables/measure.h"

namespace sinew::study {
namespace {

using multibody::Formulation;
using multibody::Vector;

/// Rods of 0.1 m and 0.1 kg, hinges alternately about x and y.
multibody::Mechanism chain_of(int links) {
  multibody::Mechanism m;
  m.name = "chain of " + std::to_string(links);
  for (int i = 0; i < links; ++i) {
    multibody::Body body;
    body.name = "link" + std::to_string(i);
    body.mass = 0.1;
    body.center_of_mass = Vec3<double>(0, 0, -0.1 * i - 0.05);
    body.inertia = Vec3<double>(1e-4, 1e-4, 1e-5).asDiagonal();
    multibody::HingeOrSlider joint;
    joint.name = "hinge" + std::to_string(i);
    joint.parent = i - 1;  // the first hangs on the ground, −1
    joint.child = i;
    joint.anchor = Vec3<double>(0, 0, -0.1 * i);
    joint.axis = i % 2 == 0 ? Vec3<double>::UnitX() : Vec3<double>::UnitY();
    m.bodies.push_back(body);
    m.joints.push_back(joint);
  }
  return m;
}

double time_of(const multibody::Model& model, Formulation formulation, int repeats) {
  multibody::Equations equations(model, formulation, multibody::Tangent::kNumeric);
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 0.1);
  Vector y(2 * model.size()), yp(y.size()), r(y.size());
  for (double& x : y) x = normal(random);
  yp.setOnes();
  const int rounds = std::max(1, 4000 / model.size());
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repeats; ++i) {
    const double begin = cpu_seconds();
    for (int k = 0; k < rounds; ++k) {
      if (formulation == Formulation::kRr)
        equations.residual(0, y, yp, r);
      else
        equations.derivative(0, y, r);
    }
    best = std::min(best, (cpu_seconds() - begin) / rounds);
  }
  return 1e6 * best;
}

}  // namespace

std::vector<ChainPoint> measure_chains(bool quick, const std::function<void()>& done_one) {
  std::vector<ChainPoint> chains;
  const int repeats = quick ? 3 : 7;
  for (const int links : {5, 10, 20, 50, 100, 200, 500, 1000}) {
    if (quick && links > 200) break;
    const multibody::Model model(chain_of(links));
    ChainPoint& point = chains.emplace_back();
    point.links = links;
    point.dtr = time_of(model, Formulation::kDtr, repeats);
    point.rr = time_of(model, Formulation::kRr, repeats);
    point.dsr = time_of(model, Formulation::kDsr, links > 200 ? 2 : repeats);
    if (done_one) done_one();
  }
  return chains;
}

double growth_exponent(const std::vector<ChainPoint>& chains, double ChainPoint::*time, int from) {
  // Slope of the least-squares line through (log links, log time).
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const ChainPoint& c : chains) {
    if (c.links < from || !(c.*time > 0)) continue;
    const double lx = std::log(c.links), ly = std::log(c.*time);
    n += 1, x += lx, y += ly, xx += lx * lx, xy += lx * ly;
  }
  const double spread = n * xx - x * x;
  return spread > 0 ? (n * xy - x * y) / spread : 0;
}

std::string chains_csv(const std::vector<ChainPoint>& chains) {
  std::string csv = "links,DTR_us,DSR_us,RR_us\n";
  char line[128];
  for (const ChainPoint& c : chains) {
    std::snprintf(line, sizeof line, "%d,%.4g,%.4g,%.4g\n", c.links, c.dtr, c.dsr, c.rr);
    csv += line;
  }
  return csv;
}

std::string plot_chains(const std::string& csv, const std::string& png) {
  FILE* gnuplot = popen("gnuplot 2>/dev/null", "w");
  if (!gnuplot) return "gnuplot cannot be started";
  std::fprintf(gnuplot,
               "set terminal pngcairo size 900,600 font 'DejaVu Sans,11'\nset output '%s'\n"
               "set datafile separator ','\nset logscale xy\nset grid\nset key top left\n"
               "set xlabel 'links'\nset ylabel 'time per evaluation, µs'\n"
               "plot '%s' using 1:2 with linespoints lw 2 title 'DTR (articulated)', "
               "'' using 1:3 with linespoints lw 2 title 'DSR (semi-recursive)', "
               "'' using 1:4 with linespoints lw 2 title 'RR (residual)', "
               "0.1*x with lines dt 2 lc 'gray' title 'linear'\n",
               png.c_str(), csv.c_str());
  return pclose(gnuplot) == 0 ? "" : "gnuplot is not installed or failed: no " + png;
}

}  // namespace sinew::study
