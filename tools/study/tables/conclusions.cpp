// The paper's conclusions, each against the figures measured here.
#include <cstdarg>
#include <cstdio>

#include "study/tables/tables.h"

namespace sinew::study {
namespace {

using Verdict = Conclusion::Verdict;

std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string text(const char* format, ...) {
  char buffer[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  return buffer;
}

Conclusion judged(const char* claim, bool holds, const std::string& evidence) {
  return {claim, holds ? Verdict::kHolds : Verdict::kDoesNot, evidence};
}

/// Evidence gathered clause by clause: "a; b; " to "a; b.".
std::string sentence(std::string clauses) {
  if (clauses.size() > 2) clauses.replace(clauses.size() - 2, 2, ".");
  return clauses;
}

double ms(const TablesResult& r, const std::string& mechanism, const std::string& method) {
  const Measurement* m = find(r, mechanism, method);
  return m && m->stopped.empty() ? m->milliseconds : 0;
}

Conclusion crossover(const TablesResult& r) {
  const double five_dtr = evaluation(r, "fivebar_pendulum", "DTR"),
               five_dsr = evaluation(r, "fivebar_pendulum", "DSR"),
               driver_dtr = evaluation(r, "driver_nonstiff", "DTR"),
               driver_dsr = evaluation(r, "driver_nonstiff", "DSR");
  const bool small = five_dsr < five_dtr, large = driver_dtr < driver_dsr;
  std::string evidence = text("Five-bar: DSR %.2f µs, DTR %.2f µs; driver: DTR %.2f µs, DSR %.2f µs.",
                              five_dsr, five_dtr, driver_dtr, driver_dsr);
  if (!small && large)
    evidence +=
        " The second half holds. For five bodies the two are close: six-by-six products are short straight "
        "loops for today's compilers, and three fifths of DSR's time is the pass over the forces, which DTR "
        "has in its own.";
  return judged("DSR is faster than DTR for the five-bar pendulum, DTR for the driver with 41 coordinates",
                small && large, evidence);
}

Conclusion explicit_on_smooth(const TablesResult& r) {
  bool holds = true;
  std::string evidence;
  for (const Comparison& c : r.explicit_or_implicit) {
    evidence += text("%s: %.2f ms for an error of %.0e / %.0e", c.peer.mechanism.c_str(), c.peer.milliseconds,
                     c.peer.error.q, c.peer.error.u);
    if (c.ours.method.empty()) {
      evidence += ", no implicit run as accurate; ";
      continue;
    }
    holds = holds && c.peer.milliseconds < c.ours.milliseconds;
    evidence += text(", %s %.2f ms; ", c.ours.method.c_str(), c.ours.milliseconds);
  }
  return judged("DE (Adams–Bashforth–Moulton PECE) is always the best on non-stiff problems", holds,
                "DE against the quickest implicit run of at most its true error: " + sentence(evidence));
}

Conclusion residual_is_cheaper(const TablesResult& r) {
  bool holds = true;
  std::string evidence;
  for (const std::string& name : r.open) {
    const double dtr = evaluation(r, name, "DTR"), dsr = evaluation(r, name, "DSR"),
                 rr = evaluation(r, name, "RR");
    holds = holds && rr < dtr && rr < dsr;
    evidence += text("%s: RR %.2f, DTR %.2f, DSR %.2f µs; ", name.c_str(), rr, dtr, dsr);
  }
  for (const std::string& name : r.closed) {
    const double dsr = evaluation(r, name, "DSR-Rz"), rr = evaluation(r, name, "RR-Rz");
    holds = holds && rr < dsr;
    evidence += text("%s: RR-Rz %.2f, DSR-Rz %.2f µs; ", name.c_str(), rr, dsr);
  }
  return judged("Evaluating the residual is cheaper than evaluating the derivative", holds,
                sentence(evidence));
}

Conclusion analytic_tangent(const TablesResult& r) {
  const auto gain = [&](const char* mechanism, const char* integrator) {
    const std::string numeric = std::string(integrator) + " · RR-JN",
                      analytic = std::string(integrator) + " · RR-JF";
    return ms(r, mechanism, numeric) / ms(r, mechanism, analytic);
  };
  const double large = gain("driver_stiff", "DASSL"), large_suite = gain("driver_stiff", "ode15sR"),
               small = gain("fivebar_pendulum", "DASSL"), small_suite = gain("fivebar_pendulum", "ode15sR");
  return judged(
      "The analytic tangent is decisive for large implicit problems and unimportant for small ones",
      large > 1.5 && large_suite > 1.3 && small < large && small_suite < large_suite,
      text("RR-JN over RR-JF: stiff driver %.1f× (DASSL) and %.1f× (ode15sR), five-bar %.1f× and %.1f×; "
           "ode15sR asks for few tangents, so it gains less.",
           large, large_suite, small, small_suite));
}

Conclusion implicit_on_stiff(const TablesResult& r) {
  const double explicit_mfs = ms(r, "suspension_mfs", "DE · DSR-Rz"),
               implicit_mfs = ms(r, "suspension_mfs", "ode15sR · RR-Rz-JF"),
               explicit_driver = ms(r, "driver_stiff", "DE · DTR"),
               implicit_driver = ms(r, "driver_stiff", "ode15sR · RR-JF"),
               explicit_bricard = ms(r, "bricard", "DE · DSR-Rz"),
               implicit_bricard = ms(r, "bricard", "ode15sR · RR-Rz-JF");
  return judged(
      "An implicit integrator on residuals is essential for stiff problems (MFS, stiff driver), not for "
      "others",
      explicit_mfs > 3 * implicit_mfs && explicit_driver > 3 * implicit_driver &&
          explicit_bricard < implicit_bricard,
      text("DE and ode15sR: MFS %.1f and %.1f ms, stiff driver %.1f and %.1f ms; on Bricard, not stiff, %.2f "
           "and "
           "%.2f ms.",
           explicit_mfs, implicit_mfs, explicit_driver, implicit_driver, explicit_bricard, implicit_bricard));
}

Conclusion few_tangents(const TablesResult& r) {
  bool holds = true;
  std::string evidence;
  for (const auto& [name, suite, dassl] : {std::tuple{"driver_stiff", "ode15sR · RR-JF", "DASSL · RR-JF"},
                                           {"driver_nonstiff", "ode15sR · RR-JF", "DASSL · RR-JF"},
                                           {"suspension_mfs", "ode15sR · RR-Rz-JF", "DASSL · RR-Rz-JF"}}) {
    const Measurement *s = find(r, name, suite), *d = find(r, name, dassl);
    if (!s || !d) continue;
    holds = holds && 1.5 * static_cast<double>(s->tangents) < static_cast<double>(d->tangents);
    evidence += text("%s: %ld against %ld; ", name, s->tangents, d->tangents);
  }
  if (!holds)
    evidence +=
        "ode15s renews a tangent when Newton's method fails, DASSL also when the step has doubled; where "
        "that "
        "is seldom and the mass turns with the mechanism, both need about as many; ";
  return judged("ode15s asks for far fewer tangents than DASSL", holds, sentence(evidence));
}

/// The comparison in which Sinew's lead is smallest, among programs whose name starts so.
const Comparison* closest_to(const TablesResult& r, const char* program) {
  const Comparison* closest = nullptr;
  for (const Comparison& c : r.comparisons)
    if (c.peer.stopped.empty() && c.peer.method.starts_with(program) &&
        (!closest || c.factor() < closest->factor()))
      closest = &c;
  return closest;
}

Conclusion faster_than_others(const TablesResult& r) {
  constexpr const char* kClaim =
      "The programs are always faster than an independent one (SIMPACK in the paper, Simbody here)";
  const Comparison* simbody = closest_to(r, "Simbody");
  if (!simbody) return {kClaim, Verdict::kNotMeasured, "This build has no peers (SINEW_PEERS)."};
  std::string evidence;
  for (const char* program : {"Simbody", "SUNDIALS", "Odeint"})
    if (const Comparison* c = closest_to(r, program))
      evidence += text("%s comes closest on %s, %.2f ms against %.2f ms (%.1f×); ", c->peer.method.c_str(),
                       c->peer.mechanism.c_str(), c->peer.milliseconds, c->ours.milliseconds, c->factor());
  return judged(kClaim, simbody->factor() > 1,
                "At most the same true error: " + sentence(evidence) +
                    " SUNDIALS and Odeint are integrators fed with Sinew's own evaluations.");
}

Conclusion linear_work(const TablesResult& r) {
  const double dtr = growth_exponent(r.chains, &ChainPoint::dtr, 20),
               rr = growth_exponent(r.chains, &ChainPoint::rr, 20),
               dsr = growth_exponent(r.chains, &ChainPoint::dsr, 100);
  return judged("DTR and RR are of order N, DSR tends to order N³ (section 2.1)",
                dtr < 1.15 && rr < 1.15 && dsr > 1.8,
                text("Time ~ links^p: DTR p = %.2f and RR p = %.2f from 20 links on, DSR p = %.2f from 100.",
                     dtr, rr, dsr));
}

}  // namespace

std::vector<Conclusion> conclusions_of(const TablesResult& r) {
  std::vector<Conclusion> all;
  if (evaluation(r, "driver_nonstiff", "DTR") > 0) {
    all = {crossover(r),         explicit_on_smooth(r), residual_is_cheaper(r), analytic_tangent(r),
           implicit_on_stiff(r), few_tangents(r),       faster_than_others(r)};
  } else {
    all = {residual_is_cheaper(r)};  // the paper's mechanisms are not there
  }
  all.push_back(linear_work(r));
  return all;
}

}  // namespace sinew::study
