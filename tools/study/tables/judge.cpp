#include "study/tables/judge.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sinew::study {
namespace {

struct Point {
  double error, cost;
};

/// Runs of a method that no other run of it beats in both, from cheap and coarse to dear and accurate.
std::vector<Point> envelope(const TablesResult& r, const std::string& mechanism, const std::string& method) {
  std::vector<Point> points;
  for (const SimulationRun& m : r.curves)
    if (m.mechanism == mechanism && m.method == method && m.stopped.empty() && m.instructions > 0 &&
        m.error.q > 0)
      points.push_back({m.error.q, m.instructions});
  std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.cost < b.cost; });
  std::vector<Point> front;
  for (const Point& p : points)
    if (front.empty() || p.error < front.back().error) front.push_back(p);
  return front;
}

const SimulationRun* counted(const TablesResult& r, const std::string& mechanism, const std::string& method) {
  const SimulationRun* m = find(r, mechanism, method);
  return m && m->stopped.empty() && m->instructions > 0 ? m : nullptr;
}

const SimulationRun* cheapest(const TablesResult& r, const std::string& mechanism, const Methods& methods) {
  const SimulationRun* best = nullptr;
  for (const std::string& method : methods)
    if (const SimulationRun* m = counted(r, mechanism, method);
        m && (!best || m->instructions < best->instructions))
      best = m;
  return best;
}

double cheapest_at(const TablesResult& r, const std::string& mechanism, const Methods& methods,
                   double error) {
  double best = 0;
  for (const std::string& method : methods)
    if (const double cost = cost_at_error(r, mechanism, method, error);
        cost > 0 && (best == 0 || cost < best))
      best = cost;
  return best;
}

}  // namespace

std::string Ratio::text() const {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.2f, %.2f", at_tolerance, at_error);
  return buffer;
}

double cost_at_error(const TablesResult& r, const std::string& mechanism, const std::string& method,
                     double error) {
  const std::vector<Point> front = envelope(r, mechanism, method);
  if (front.empty()) return 0;
  if (front.front().error <= error) return front.front().cost;
  for (std::size_t i = 1; i < front.size(); ++i) {
    if (front[i].error > error) continue;
    const Point &coarse = front[i - 1], &fine = front[i];
    const double s = std::log(error / coarse.error) / std::log(fine.error / coarse.error);
    return coarse.cost * std::pow(fine.cost / coarse.cost, s);
  }
  return 0;
}

Ratio ratio(const TablesResult& r, const std::string& mechanism, const Methods& a, const Methods& b) {
  const SimulationRun *of_a = cheapest(r, mechanism, a), *of_b = cheapest(r, mechanism, b);
  if (!of_a || !of_b) return {};
  const double error = std::max(of_a->error.q, of_b->error.q);
  const double cost_a = cheapest_at(r, mechanism, a, error), cost_b = cheapest_at(r, mechanism, b, error);
  return {of_b->instructions / of_a->instructions, cost_a > 0 ? cost_b / cost_a : 0};
}

Methods methods_of(const TablesResult& r, const std::string& mechanism,
                   std::initializer_list<const char*> integrators) {
  Methods out;
  for (const SimulationRun& m : r.simulations)
    for (const char* integrator : integrators)
      if (m.mechanism == mechanism && m.method.starts_with(std::string(integrator) + " · "))
        out.push_back(m.method);
  return out;
}

}  // namespace sinew::study
