#include "study/tables/chains.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "study/tables/count.h"
#include "study/tables/measure.h"

namespace sinew::study {

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

std::vector<ChainPoint> measure_chains(bool quick, bool recount, const std::function<void()>& done_one) {
  std::vector<ChainPoint> chains;
  std::vector<CountJob> jobs;
  const int repeats = quick ? 3 : 7;
  for (const int links : {5, 10, 20, 50, 100, 200, 500, 1000}) {
    if (quick && links > 200) break;
    const std::string name = "chain:" + std::to_string(links);
    StudyCase c;
    if (!load_mechanism_only("", name, c).empty()) continue;
    ChainPoint& point = chains.emplace_back();
    point.links = links;
    point.dtr = evaluation_time(c, "DTR", repeats);
    point.rr = evaluation_time(c, "RR", repeats);
    point.dsr = evaluation_time(c, "DSR", links > 200 ? 2 : repeats);
    for (const char* formulation : {"DTR", "DSR", "RR"}) jobs.push_back({name, formulation, "", 0});
    if (done_one) done_one();
  }
  const std::vector<double> counted = count(".", jobs, recount);
  for (std::size_t i = 0; i < chains.size(); ++i) {
    chains[i].dtr_instructions = counted[3 * i];
    chains[i].dsr_instructions = counted[3 * i + 1];
    chains[i].rr_instructions = counted[3 * i + 2];
  }
  return chains;
}

double growth_exponent(const std::vector<ChainPoint>& chains, double ChainPoint::*cost, int from) {
  // Slope of the least-squares line through (log links, log cost).
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const ChainPoint& c : chains) {
    if (c.links < from || !(c.*cost > 0)) continue;
    const double lx = std::log(c.links), ly = std::log(c.*cost);
    n += 1, x += lx, y += ly, xx += lx * lx, xy += lx * ly;
  }
  const double spread = n * xx - x * x;
  return spread > 0 ? (n * xy - x * y) / spread : 0;
}

std::string chains_csv(const std::vector<ChainPoint>& chains) {
  std::string csv = "links,DTR_us,DSR_us,RR_us,DTR_instructions,DSR_instructions,RR_instructions\n";
  char line[128];
  for (const ChainPoint& c : chains) {
    std::snprintf(line, sizeof line, "%d,%.4g,%.4g,%.4g,%.0f,%.0f,%.0f\n", c.links, c.dtr, c.dsr, c.rr,
                  c.dtr_instructions, c.dsr_instructions, c.rr_instructions);
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
