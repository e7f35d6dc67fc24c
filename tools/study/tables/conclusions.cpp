// What the paper concludes, each sentence against what was counted here.
//
// The copy of the paper that this was written from lists conclusions 1, 3, 6 and 7 of section 5 (2, 4 and 5
// are lost in it), and all of section 4.2's.
#include <algorithm>
#include <cstdarg>
#include <cstdio>

#include "study/tables/judge.h"

namespace sinew::study {
namespace {

std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string text(const char* format, ...) {
  char buffer[256];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  return buffer;
}

/// Bodies up to which a mechanism is small and from which it is large, by the N < 8 and N < 11 that
/// section 4.2.1 quotes.
constexpr int kSmall = 7, kLarge = 11;
/// A tangent is "a key point" where doing without costs half as much again, and "not so important" below
/// that.
constexpr double kKey = 1.5;
/// An implicit integrator is "essential" where the explicit one costs twice as much.
constexpr double kEssential = 2;
/// "Much less efficient" is twice as much, too.
constexpr double kMuch = 2;
/// Error of positions from which a row is in trouble: a thousand tolerances.
constexpr double kFar = 1e-2;

constexpr const char* kBoth = "instructions, others over ours: at equal tolerance, at equal error";

using Which = bool (*)(const StudiedMechanism&);
bool any(const StudiedMechanism&) {
  return true;
}
bool open(const StudiedMechanism& m) {
  return !m.closed();
}
bool closed(const StudiedMechanism& m) {
  return m.closed();
}

/// Evidence of every mechanism among `which` for which `says` has an answer.
template <class Says>
std::vector<Evidence> gather(const TablesResult& r, Which which, const Says& says) {
  std::vector<Evidence> all;
  for (const StudiedMechanism& m : r.mechanisms) {
    Evidence e;
    if (which(m) && says(m, e)) {
      e.about = m.name;
      all.push_back(e);
    }
  }
  return all;
}

bool is_global(const std::string& method) {
  return method.find("Cartesian") != std::string::npos;
}

/// The mechanism's topological rows that end so: "JF" takes both RR-JF and RR-Rz-JF.
Methods rows(const TablesResult& r, const StudiedMechanism& m, std::initializer_list<const char*> integrators,
             const char* ending = "") {
  Methods out = methods_of(r, m.name, integrators);
  std::erase_if(out,
                [&](const std::string& method) { return is_global(method) || !method.ends_with(ending); });
  return out;
}

const std::initializer_list<const char*> kAllIntegrators = {"DE",    "ode15s",       "ode15sR",
                                                            "DASSL", "DASSL-strict", "RADAU5"};

Methods global_rows(const TablesResult& r, const StudiedMechanism& m) {
  Methods out = methods_of(r, m.name, kAllIntegrators);
  std::erase_if(out, [](const std::string& method) { return !is_global(method); });
  return out;
}

bool ratio_above(const Ratio& is, double bound, Evidence& e) {
  e.holds = is.above(bound);
  e.figures = is.text();
  return is.known();
}

double instructions(const TablesResult& r, const std::string& mechanism, const std::string& formulation) {
  const EvaluationCost* e = evaluation(r, mechanism, formulation);
  return e ? e->instructions : 0;
}

Conclusion crossover(const TablesResult& r) {
  return {"section 4.2.1, on Table I", "DSR evaluates small open chains faster than DTR, DTR large ones",
          "instructions of one evaluation, DTR and DSR",
          gather(r, open,
                 [&](const StudiedMechanism& m, Evidence& e) {
                   const double dtr = instructions(r, m.name, "DTR"), dsr = instructions(r, m.name, "DSR");
                   if (dtr == 0 || (m.coordinates > kSmall && m.coordinates < kLarge)) return false;
                   e.holds = m.coordinates <= kSmall ? dsr < dtr : dtr < dsr;
                   e.figures = text("%.0f, %.0f", dtr, dsr);
                   return true;
                 }),
          "Large chains are as the paper says. On small chains DTR's six-by-six products are short straight "
          "loops "
          "for today's "
          "compilers, and most of DSR's work is the pass over the forces, which DTR has in its own; DSR's "
          "factor was made "
          "branch-sparse, which did not turn the order"};
}

Conclusion explicit_is_best(const TablesResult& r, Which which, const char* place, const char* claim) {
  return {place, claim, kBoth,
          gather(r, which,
                 [&](const StudiedMechanism& m, Evidence& e) {
                   return !m.stiff &&
                          ratio_above(
                              ratio(r, m.name, rows(r, m, {"DE"}),
                                    rows(r, m, {"ode15s", "ode15sR", "DASSL", "DASSL-strict", "RADAU5"})),
                              1, e);
                 }),
          "Every implicit row took part, also those that the paper does not have"};
}

Conclusion implicit_on_stiff(const TablesResult& r) {
  return {"section 4.2.2, first",
          "On stiff problems an implicit integrator is essential (here: DE costs twice as much)", kBoth,
          gather(r, any,
                 [&](const StudiedMechanism& m, Evidence& e) {
                   return m.stiff && ratio_above(ratio(r, m.name, rows(r, m, {"ode15s", "ode15sR", "DASSL"}),
                                                       rows(r, m, {"DE"})),
                                                 kEssential, e);
                 }),
          ""};
}

Conclusion analytic_tangent(const TablesResult& r, Which which, const char* place, const char* integrator) {
  return {
      place,
      text("With %s the analytic tangent is a key point for large problems (1.5 times) and unimportant "
           "for small ones",
           integrator),
      "instructions, JN over JF: at equal tolerance, at equal error",
      gather(r, which,
             [&](const StudiedMechanism& m, Evidence& e) {
               const Ratio gain =
                   ratio(r, m.name, rows(r, m, {integrator}, "-JF"), rows(r, m, {integrator}, "-JN"));
               if (m.coordinates > kSmall && m.coordinates < kLarge) return false;
               e.holds = m.coordinates <= kSmall ? gain.below(kKey) : gain.above(kKey);
               e.figures = gain.text();
               return gain.known();
             }),
      std::string(integrator) == "DASSL"
          ? "DASSL asks for a tangent with every tenth step or so, which counts on small mechanisms as well"
          : "ode15sR asks for one or two tangents in a whole run since the mass is renewed by itself, so it "
            "cannot gain "
            "much from a cheap one; with the mass tied to the tangent it asked for 24 to 52"};
}

/// Instructions of the cheapest of these formulations that were counted.
double cheapest_evaluation(const TablesResult& r, const std::string& mechanism,
                           std::initializer_list<const char*> formulations) {
  double best = 0;
  for (const char* f : formulations)
    if (const double cost = instructions(r, mechanism, f); cost > 0 && (best == 0 || cost < best))
      best = cost;
  return best;
}

Conclusion residual_evaluation(const TablesResult& r) {
  return {"section 4.2.1, third", "The residual is faster to evaluate than the derivative",
          "instructions of the cheapest derivative and of the residual",
          gather(r, any,
                 [&](const StudiedMechanism& m, Evidence& e) {
                   const double rr = cheapest_evaluation(r, m.name, {"RR", "RR-Rz", "RR-Rz2"}),
                                derivative =
                                    cheapest_evaluation(r, m.name, {"DTR", "DSR", "DSR-Rz", "DSR-Rz2"});
                   e.holds = rr < derivative;
                   e.figures = text("%.0f, %.0f", derivative, rr);
                   return rr > 0;
                 }),
          ""};
}

Conclusion residual_simulation(const TablesResult& r, Which which, const char* tangent, const char* place,
                               const char* claim) {
  return {place, claim, "instructions, the cheapest ode15s over ode15sR: at equal tolerance, at equal error",
          gather(r, which,
                 [&](const StudiedMechanism& m, Evidence& e) {
                   return ratio_above(
                       ratio(r, m.name, rows(r, m, {"ode15sR"}, tangent), rows(r, m, {"ode15s"})), 1, e);
                 }),
          "An old matrix serves derivatives better than residuals: there it is multiplied by the mass of "
          "today, here it "
          "contains that of its factorisation. Tried: mass renewed with every factorisation and before a new "
          "tangent "
          "(kept), at a rate of convergence above 0.05 to 0.4 as well (fewer iterations on the five-bar, "
          "none elsewhere)"};
}

Conclusion no_tangent_for_dtr(const TablesResult& r) {
  return {"section 4.2.1, fourth", "DTR is not for stiff problems, because it has no analytic tangent",
          "instructions, the cheapest DTR over the cheapest other: at equal tolerance, at equal error",
          gather(r, open,
                 [&](const StudiedMechanism& m, Evidence& e) {
                   Methods others = rows(r, m, {"DE", "ode15s", "ode15sR", "DASSL"});
                   std::erase_if(others, [](const std::string& s) { return s.ends_with("DTR"); });
                   return m.stiff &&
                          ratio_above(ratio(r, m.name, others, rows(r, m, {"DE", "ode15s"}, "DTR")), 1, e);
                 }),
          ""};
}

Conclusion few_tangents(const TablesResult& r) {
  return {"section 3.4.2", "ode15s evaluates far fewer tangents than DASSL (here: less than half)",
          "tangents of ode15sR and of DASSL, both on residuals with JF",
          gather(r, any,
                 [&](const StudiedMechanism& m, Evidence& e) {
                   const std::string f = m.closed() ? "RR-Rz-JF" : "RR-JF";
                   const SimulationRun *s = find(r, m.name, "ode15sR · " + f),
                                       *d = find(r, m.name, "DASSL · " + f);
                   if (!r.counted || !s || !d || !s->stopped.empty() || !d->stopped.empty()) return false;
                   e.holds = 2 * s->tangents < d->tangents;
                   e.figures = text("%ld, %ld", s->tangents, d->tangents);
                   return true;
                 }),
          ""};
}

Conclusion suite_or_dassl(const TablesResult& r) {
  return {
      "sections 3.3 and 4.2", "ode15sR simulates faster than DASSL",
      "instructions, DASSL as published over ode15sR, both on residuals: at equal tolerance, at equal error",
      gather(r, any,
             [&](const StudiedMechanism& m, Evidence& e) {
               return ratio_above(ratio(r, m.name, rows(r, m, {"ode15sR"}), rows(r, m, {"DASSL"})), 1, e);
             }),
      "DASSL's root mean square asks for less than the worst component at the same tolerance, so it is "
      "favoured at equal "
      "tolerance and pays at equal error"};
}

Conclusion linear_work(const TablesResult& r) {
  const double dtr = growth_exponent(r.chains, &ChainPoint::dtr_instructions, 20),
               rr = growth_exponent(r.chains, &ChainPoint::rr_instructions, 20),
               dsr = growth_exponent(r.chains, &ChainPoint::dsr_instructions, 100);
  Conclusion c{"section 2.1",
               "DTR and RR are of order N, DSR tends to order N³ (here: beyond 1.8)",
               "exponent of the instructions over serial chains from 20 links on (DSR: 100)",
               {},
               ""};
  if (dtr > 0)
    c.evidence = {{"DTR", dtr < 1.15, text("%.2f", dtr)},
                  {"RR", rr < 1.15, text("%.2f", rr)},
                  {"DSR", dsr > 1.8, text("%.2f", dsr)}};
  return c;
}

/// Peers are timed, not counted: their margin is what a busy machine may not blur.
Conclusion faster_than_others(const TablesResult& r) {
  Conclusion c{"section 5, no. 7, and section 4.2.3, fourth",
               "The programs are always faster than an independent one (SIMPACK in the paper, Simbody here)",
               "time, Simbody's over ours of at most its error",
               {},
               ""};
  for (const Comparison& one : r.comparisons)
    if (one.peer.stopped.empty() && one.peer.method.starts_with("Simbody") && one.factor() > 0)
      c.evidence.push_back(
          {one.peer.mechanism + " (" + one.peer.method + ")", one.factor() > 1, text("%.1f", one.factor())});
  if (c.evidence.empty()) c.note = "needs a build with SINEW_PEERS and Simbody";
  return c;
}

void add_tangents(const TablesResult& r, std::vector<Conclusion>& all) {
  for (const char* integrator : {"DASSL", "ode15sR"}) {
    all.push_back(analytic_tangent(r, open, "section 4.2.1, second", integrator));
    all.push_back(analytic_tangent(r, closed, "section 4.2.2, second", integrator));
  }
}

void add_residuals(const TablesResult& r, std::vector<Conclusion>& all) {
  all.push_back(residual_evaluation(r));
  all.push_back(
      residual_simulation(r, open, "", "section 4.2.1, third",
                          "Implicit integrators do better on residuals than on derivatives (open chains)"));
  all.push_back(residual_simulation(
      r, closed, "-JN", "section 4.2.2, third",
      "Implicit integrators do better on residuals, even if the tangent is numeric (closed chains)"));
  all.push_back(
      residual_simulation(r, any, "-JF", "section 5, no. 6",
                          "With implicit integrators the residual algorithm is the more efficient one"));
}

Conclusion runge_kutta(const TablesResult& r) {
  return {
      "section 4.2.3, second", "RADAU5 is inferior to implicit multi-step methods in all examples", kBoth,
      gather(r, any,
             [&](const StudiedMechanism& m, Evidence& e) {
               return ratio_above(
                   ratio(r, m.name, rows(r, m, {"ode15s", "ode15sR", "DASSL"}), rows(r, m, {"RADAU5"})), 1,
                   e);
             }),
      "On motion that is smooth a method of order 5 with an error estimate of its own gives more digits than "
      "it was asked for, which counts at equal error. RADAU5 is as published, its rule of new tangents "
      "included; its complex factor is dense where the real one follows the tree"};
}

Conclusion global_is_slower(const TablesResult& r) {
  return {"section 5, no. 1",
          text("Global formulations are much less efficient than topological ones (here: %.0f times)", kMuch),
          kBoth,
          gather(r, any,
                 [&](const StudiedMechanism& m, Evidence& e) {
                   return ratio_above(ratio(r, m.name, rows(r, m, kAllIntegrators), global_rows(r, m)), kMuch,
                                      e);
                 }),
          ""};
}

double global_over_topological(const TablesResult& r, const StudiedMechanism& m) {
  const double topological = cheapest_evaluation(r, m.name, {"DTR", "DSR", "DSR-Rz", "DSR-Rz2"});
  const double global = cheapest_evaluation(r, m.name, {"Cartesian-penalty", "Cartesian-multipliers"});
  return topological > 0 ? global / topological : 0;
}

Conclusion especially_when_large(const TablesResult& r) {
  double small = 0;
  for (const StudiedMechanism& m : r.mechanisms)
    if (m.coordinates <= kSmall) small = std::max(small, global_over_topological(r, m));
  return {"section 5, no. 1", "… especially with large mechanisms",
          "instructions of a derivative, global over topological, and the largest such ratio of a small "
          "mechanism",
          gather(r, any,
                 [&](const StudiedMechanism& m, Evidence& e) {
                   const double large = global_over_topological(r, m);
                   e.holds = large > small;
                   e.figures = text("%.1f, %.1f", large, small);
                   return m.coordinates >= kLarge && large > 0 && small > 0;
                 }),
          "A sparse factor of a tree costs a fixed amount per body, as DTR does; only DSR's grows faster"};
}

/// Rows that stop before the end or are far from the truth at the paper's tolerance.
long in_trouble(const TablesResult& r, const std::string& mechanism, bool global) {
  return std::count_if(r.simulations.begin(), r.simulations.end(), [&](const SimulationRun& m) {
    return m.mechanism == mechanism && is_global(m.method) == global &&
           (!m.stopped.empty() || !(m.error.q < kFar));
  });
}

Conclusion fewer_constraint_problems(const TablesResult& r) {
  return {"section 5, no. 3",
          "Topological formulations reduce the problems of constraint equations (here: less than half of "
          "them, and "
          "no row stops or errs by 1e-2)",
          "equations and rows in trouble, global; topological",
          gather(r, any,
                 [&](const StudiedMechanism& m, Evidence& e) {
                   if (!r.counted || global_rows(r, m).empty()) return false;
                   const int global = 5 * m.coordinates + m.loop_equations;
                   const long stuck = in_trouble(r, m.name, false);
                   e.holds = 2 * m.loop_equations < global && stuck == 0;
                   e.figures = text("%d and %ld; %d and %ld", global, in_trouble(r, m.name, true),
                                    m.loop_equations, stuck);
                   return true;
                 }),
          ""};
}

}  // namespace

std::string verdict(const Conclusion& c) {
  const auto n = static_cast<long>(c.evidence.size());
  const auto k =
      std::count_if(c.evidence.begin(), c.evidence.end(), [](const Evidence& e) { return e.holds; });
  if (n == 0) return "not measured";
  if (k == n) return "holds";
  return k == 0 ? "does not hold" : text("holds on %ld of %ld", static_cast<long>(k), n);
}

std::vector<Conclusion> conclusions_of(const TablesResult& r) {
  std::vector<Conclusion> all = {
      linear_work(r), crossover(r),
      explicit_is_best(r, open, "section 4.2.1, first",
                       "DE (Adams–Bashforth–Moulton) is always the best on open chains that are not stiff")};
  add_tangents(r, all);
  add_residuals(r, all);
  all.push_back(no_tangent_for_dtr(r));
  all.push_back(explicit_is_best(r, closed, "section 4.2.2, first, and 4.2.3, first and third",
                                 "Closing loops does not take DE's lead on problems that are not stiff"));
  all.push_back(implicit_on_stiff(r));
  all.push_back(few_tangents(r));
  all.push_back(suite_or_dassl(r));
  all.push_back(faster_than_others(r));
  all.push_back(runge_kutta(r));
  all.push_back(global_is_slower(r));
  all.push_back(especially_when_large(r));
  all.push_back(fewer_constraint_problems(r));
  if (!r.counted)
    for (Conclusion& c : all)
      if (c.evidence.empty() && c.note.empty())
        c.note = "instructions are counted by valgrind, which is not there";
  return all;
}

}  // namespace sinew::study
