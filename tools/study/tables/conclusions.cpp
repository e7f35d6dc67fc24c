// The paper's conclusions, each against the figures measured here.
#include <cstdarg>
#include <cstdio>

#include "study/tables/tables.h"

namespace sinew::study {
namespace {

std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string text(const char* format, ...) {
  char buffer[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  return buffer;
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
  Conclusion c{
      "DSR is faster than DTR for the five-bar pendulum, DTR for the driver with 41 coordinates", {}, {}};
  c.holds = five_dsr < five_dtr && driver_dtr < driver_dsr;
  c.evidence = text("Five-bar: DSR %.2f µs, DTR %.2f µs; driver: DTR %.2f µs, DSR %.2f µs.", five_dsr,
                    five_dtr, driver_dtr, driver_dsr);
  if (!c.holds && driver_dtr < driver_dsr)
    c.evidence +=
        " The second half holds. For five bodies the two are close here: the cost of a factorisation's calls "
        "weighs as "
        "much as its operations, and six-by-six products are short loops for today's compilers.";
  return c;
}

Conclusion explicit_on_smooth(const TablesResult& r) {
  Conclusion c{"DE (Adams–Bashforth–Moulton PECE) is always the best on non-stiff problems", true, {}};
  for (const char* name : {"fivebar_pendulum", "driver_nonstiff", "bricard", "suspension_5ps"}) {
    const Measurement* best = best_simulation(r, name);
    if (!best) continue;
    const bool de = best->method.starts_with("DE");
    c.holds = c.holds && de;
    c.evidence += text("%s: best is %s, %.2f ms (error %.0e / %.0e)", name, best->method.c_str(),
                       best->milliseconds, best->error.q, best->error.u);
    const Measurement* own = find(
        r, name,
        std::string(name) == "bricard" || std::string(name) == "suspension_5ps" ? "DE · DSR-Rz" : "DE · DTR");
    if (!de && own)
      c.evidence += text(", DE needs %.2f ms for an error of %.0e / %.0e", own->milliseconds, own->error.q,
                         own->error.u);
    c.evidence += "; ";
  }
  if (!c.evidence.empty()) c.evidence.replace(c.evidence.size() - 2, 2, ".");
  if (!c.holds)
    c.evidence +=
        " Where DE does not have the shortest time at equal tolerance it has the smallest true error.";
  return c;
}

Conclusion residual_is_cheaper(const TablesResult& r) {
  Conclusion c{"Evaluating the residual is cheaper than evaluating the derivative", true, {}};
  for (const std::string& name : r.open) {
    const double dtr = evaluation(r, name, "DTR"), dsr = evaluation(r, name, "DSR"),
                 rr = evaluation(r, name, "RR");
    c.holds = c.holds && rr < dtr && rr < dsr;
    c.evidence += text("%s: RR %.2f, DTR %.2f, DSR %.2f µs; ", name.c_str(), rr, dtr, dsr);
  }
  for (const std::string& name : r.closed) {
    const double dsr = evaluation(r, name, "DSR-Rz"), rr = evaluation(r, name, "RR-Rz");
    c.holds = c.holds && rr < dsr;
    c.evidence += text("%s: RR-Rz %.2f, DSR-Rz %.2f µs; ", name.c_str(), rr, dsr);
  }
  if (!c.evidence.empty()) c.evidence.replace(c.evidence.size() - 2, 2, ".");
  return c;
}

Conclusion analytic_tangent(const TablesResult& r) {
  const double large = ms(r, "driver_stiff", "DASSL · RR-JN") / ms(r, "driver_stiff", "DASSL · RR-JF"),
               large_suite =
                   ms(r, "driver_stiff", "ode15sR · RR-JN") / ms(r, "driver_stiff", "ode15sR · RR-JF"),
               small =
                   ms(r, "fivebar_pendulum", "DASSL · RR-JN") / ms(r, "fivebar_pendulum", "DASSL · RR-JF"),
               small_suite = ms(r, "fivebar_pendulum", "ode15sR · RR-JN") /
                             ms(r, "fivebar_pendulum", "ode15sR · RR-JF");
  Conclusion c{
      "The analytic tangent is decisive for large implicit problems and unimportant for small ones", {}, {}};
  c.holds = large > 1.5 && large_suite > 1.3 && small < large && small_suite < large_suite;
  c.evidence = text(
      "RR-JN over RR-JF: stiff driver %.1f× (DASSL) and %.1f× (ode15sR), five-bar %.1f× and %.1f×; ode15sR "
      "asks for few "
      "tangents, so it gains less.",
      large, large_suite, small, small_suite);
  return c;
}

Conclusion implicit_on_stiff(const TablesResult& r) {
  const double explicit_mfs = ms(r, "suspension_mfs", "DE · DSR-Rz"),
               implicit_mfs = ms(r, "suspension_mfs", "ode15sR · RR-Rz-JF"),
               explicit_driver = ms(r, "driver_stiff", "DE · DTR"),
               implicit_driver = ms(r, "driver_stiff", "ode15sR · RR-JF"),
               explicit_bricard = ms(r, "bricard", "DE · DSR-Rz"),
               implicit_bricard = ms(r, "bricard", "ode15sR · RR-Rz-JF");
  Conclusion c{
      "An implicit integrator on residuals is essential for stiff problems (MFS, stiff driver)", {}, {}};
  c.holds = explicit_mfs > 3 * implicit_mfs && explicit_driver > 2 * implicit_driver &&
            explicit_bricard < implicit_bricard;
  c.evidence = text(
      "DE over ode15sR: MFS %.1f/%.1f ms, stiff driver %.1f/%.1f ms; on Bricard, not stiff, %.2f/%.2f ms.",
      explicit_mfs, implicit_mfs, explicit_driver, implicit_driver, explicit_bricard, implicit_bricard);
  return c;
}

Conclusion few_tangents(const TablesResult& r) {
  Conclusion c{"ode15s asks for far fewer tangents than DASSL", true, {}};
  for (const auto& [name, suite, dassl] : {std::tuple{"driver_stiff", "ode15sR · RR-JF", "DASSL · RR-JF"},
                                           {"driver_nonstiff", "ode15sR · RR-JF", "DASSL · RR-JF"},
                                           {"suspension_mfs", "ode15sR · RR-Rz-JF", "DASSL · RR-Rz-JF"}}) {
    const Measurement *s = find(r, name, suite), *d = find(r, name, dassl);
    if (!s || !d) continue;
    c.holds = c.holds && 1.5 * static_cast<double>(s->tangents) < static_cast<double>(d->tangents);
    c.evidence += text("%s: %ld against %ld; ", name, s->tangents, d->tangents);
  }
  if (!c.evidence.empty()) c.evidence.replace(c.evidence.size() - 2, 2, ".");
  return c;
}

Conclusion faster_than_others(const TablesResult& r) {
  Conclusion c{
      "The programs are always faster than the independent program (SIMPACK there, Simbody and SUNDIALS "
      "here)",
      r.peers,
      {}};
  if (!r.peers) {
    c.evidence = "Not measured: built without SINEW_PEERS.";
    return c;
  }
  const Comparison* closest = nullptr;
  int unmatched = 0;
  for (const Comparison& x : r.comparisons) {
    if (!x.peer.stopped.empty()) continue;
    if (x.ours.method.empty()) ++unmatched;
    if (!closest || x.factor() < closest->factor()) closest = &x;
  }
  c.holds = closest && closest->factor() > 1;
  if (closest)
    c.evidence = text("At most the same true error, the closest: %s on %s, %.2f ms against %.2f ms (%.1f×).",
                      closest->peer.method.c_str(), closest->peer.mechanism.c_str(),
                      closest->peer.milliseconds, closest->ours.milliseconds, closest->factor());
  if (unmatched > 0) c.evidence += text(" %d runs of peers were more accurate than any of ours.", unmatched);
  return c;
}

Conclusion linear_work(const TablesResult& r) {
  const double dtr = growth_exponent(r.chains, &ChainPoint::dtr, 20),
               rr = growth_exponent(r.chains, &ChainPoint::rr, 20),
               dsr = growth_exponent(r.chains, &ChainPoint::dsr, 20);
  Conclusion c{"DTR and RR are of order N, DSR is of order N³ (section 2.1)", {}, {}};
  c.holds = dtr < 1.15 && rr < 1.15 && dsr > 1.5;
  c.evidence =
      text("Time ~ links^p from 20 links on: DTR p = %.2f, RR p = %.2f, DSR p = %.2f.", dtr, rr, dsr);
  return c;
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
