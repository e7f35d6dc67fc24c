// The tables as text, CSV and JSON.
#include <algorithm>
#include <cstdio>

#include "study/tables/tables.h"

namespace sinew::study {
namespace {

std::string number(double x) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, x >= 100 ? "%.0f" : x >= 10 ? "%.1f" : "%.2f", x);
  return buffer;
}

std::string exponent(double x) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.0e", x);
  return buffer;
}

/// Characters of UTF-8 text: bytes that do not continue one.
std::size_t width(const std::string& text) {
  return std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; });
}

/// First line only, short enough for a column.
std::string brief(const std::string& reason) {
  const std::string line = reason.substr(0, reason.find('\n'));
  return line.size() <= 60 ? line : line.substr(0, 57) + "…";
}

std::string verdict(const Conclusion& c) {
  switch (c.verdict) {
    case Conclusion::Verdict::kHolds:
      return "holds";
    case Conclusion::Verdict::kDoesNot:
      return "does not hold here";
    case Conclusion::Verdict::kNotMeasured:
      break;
  }
  return "not measured";
}

struct Cell {
  std::string text;
  bool bold = false;
};

struct Grid {
  std::string title;
  std::vector<std::vector<Cell>> rows;

  /// `bold` and `plain` around bold cells; they take room where they are not terminal escapes.
  std::string text(const std::string& bold, const std::string& plain) const {
    const auto marked = [&](const Cell& cell) { return cell.bold ? bold + cell.text + plain : cell.text; };
    const std::size_t room = bold.starts_with('\033') ? 0 : bold.size() + plain.size();
    const auto width_of = [&](const Cell& cell) { return width(cell.text) + (cell.bold ? room : 0); };
    std::vector<std::size_t> widths;
    for (const auto& row : rows)
      for (std::size_t c = 0; c < row.size(); ++c) {
        if (widths.size() <= c) widths.push_back(0);
        widths[c] = std::max(widths[c], width_of(row[c]));
      }
    std::string out = title + "\n\n";
    for (std::size_t r = 0; r < rows.size(); ++r) {
      for (std::size_t c = 0; c < rows[r].size(); ++c) {
        const std::string pad(widths[c] - width_of(rows[r][c]), ' ');
        out += c == 0 ? "| " + marked(rows[r][c]) + pad : " | " + pad + marked(rows[r][c]);
      }
      out += " |\n";
      if (r > 0) continue;
      for (std::size_t c = 0; c < widths.size(); ++c)
        out.append("|").append(widths[c] + 1, '-').append(c == 0 ? "-" : ":");
      out += "|\n";
    }
    return out + "\n";
  }
};

Grid evaluations(const TablesResult& r, const std::string& title, const std::vector<std::string>& mechanisms,
                 const std::vector<std::string>& formulations) {
  Grid grid{title, {{{"formulation", false}}}};
  for (const std::string& m : mechanisms) grid.rows[0].push_back({m, false});
  for (const std::string& f : formulations) {
    auto& row = grid.rows.emplace_back();
    row.push_back({f, false});
    for (const std::string& m : mechanisms) {
      const double here = evaluation(r, m, f);
      const bool best = std::all_of(formulations.begin(), formulations.end(), [&](const std::string& other) {
        return here <= evaluation(r, m, other);
      });
      row.push_back({number(here), best});
    }
  }
  return grid;
}

Grid simulations(const TablesResult& r, const std::string& title,
                 const std::vector<std::string>& mechanisms) {
  Grid grid{title, {{{"integrator · formulation", false}}}};
  std::vector<std::string> methods;
  for (const Measurement& m : r.simulations)
    if (std::find(mechanisms.begin(), mechanisms.end(), m.mechanism) != mechanisms.end() &&
        std::find(methods.begin(), methods.end(), m.method) == methods.end())
      methods.push_back(m.method);
  for (const std::string& m : mechanisms) {
    grid.rows[0].push_back({m, false});
    grid.rows[0].push_back({"error q / u", false});
    grid.rows[0].push_back({"steps", false});
  }
  for (const std::string& method : methods) {
    auto& row = grid.rows.emplace_back();
    row.push_back({method, false});
    for (const std::string& mechanism : mechanisms) {
      const Measurement* m = find(r, mechanism, method);
      if (!m || !m->stopped.empty()) {
        row.insert(row.end(), {{"–", false}, {m ? brief(m->stopped) : "", false}, {"", false}});
        continue;
      }
      row.push_back({number(m->milliseconds), m == best_simulation(r, mechanism)});
      row.push_back({exponent(m->error.q) + " / " + exponent(m->error.u), false});
      row.push_back({std::to_string(m->steps), false});
    }
  }
  return grid;
}

Grid comparisons(const TablesResult& r, const std::string& title, bool open) {
  Grid grid{title,
            {{{"mechanism", false},
              {"program", false},
              {"ms", false},
              {"error q / u", false},
              {"Sinew, error at most that", false},
              {"tolerance", false},
              {"ms", false},
              {"error q / u", false},
              {"factor", false}}}};
  for (const Comparison& c : r.comparisons) {
    const bool is_open = std::find(r.open.begin(), r.open.end(), c.peer.mechanism) != r.open.end();
    if (is_open != open) continue;
    const auto error = [](const Measurement& m) { return exponent(m.error.q) + " / " + exponent(m.error.u); };
    auto& row = grid.rows.emplace_back();
    row = {{c.peer.mechanism, false}, {c.peer.method, false}};
    if (!c.peer.stopped.empty()) {
      row.insert(row.end(), {{"–", false}, {brief(c.peer.stopped), false}, {}, {}, {}, {}, {}});
      continue;
    }
    const bool ours_wins = c.factor() > 1;
    row.push_back({number(c.peer.milliseconds), !ours_wins});
    row.push_back({error(c.peer), false});
    if (c.ours.method.empty()) {
      row.insert(row.end(), {{"none as accurate", false}, {}, {}, {}, {}});
      continue;
    }
    row.push_back({c.ours.method, false});
    row.push_back({exponent(c.ours.tolerance), false});
    row.push_back({number(c.ours.milliseconds), ours_wins});
    row.push_back({error(c.ours), false});
    row.push_back({number(c.factor()) + "×", false});
  }
  return grid;
}

nlohmann::json as_json(const Measurement& m) {
  return {{"mechanism", m.mechanism}, {"method", m.method},
          {"tolerance", m.tolerance}, {"ms", m.milliseconds},
          {"error_q", m.error.q},     {"error_u", m.error.u},
          {"steps", m.steps},         {"evaluations", m.evaluations},
          {"tangents", m.tangents},   {"factorisations", m.factorisations},
          {"closure_m", m.closure},   {"energy_drift_J", m.energy_drift},
          {"stopped", m.stopped}};
}

}  // namespace

std::string tables_text(const TablesResult& r, const std::string& bold, const std::string& plain) {
  const std::string at =
      " at tolerance " + exponent(r.tolerance) + " (ms of CPU time; error max |Δ|/(1+|x|))";
  std::string out;
  if (!r.open.empty()) {
    out += evaluations(r, "Table I. Open chains: time of one derivative or residual (µs)", r.open,
                       {"DTR", "DSR", "RR"})
               .text(bold, plain);
    out += simulations(r, "Table II. Open chains: time of the simulation" + at, r.open).text(bold, plain);
  }
  if (!r.closed.empty()) {
    out += evaluations(r, "Table III. Closed chains: time of one derivative or residual (µs)", r.closed,
                       {"DSR-Rz", "RR-Rz"})
               .text(bold, plain);
    out += simulations(r, "Table IV. Closed chains: time of the simulation" + at, r.closed).text(bold, plain);
  }
  if (r.peers) {
    out += comparisons(r, "Table V. Open chains against independent programs" + at, true).text(bold, plain);
    out +=
        comparisons(r, "Table VI. Closed chains against independent programs" + at, false).text(bold, plain);
  } else {
    out += "Tables V and VI (against independent programs) need a build with -DSINEW_PEERS=ON.\n\n";
  }
  Grid chains{"Work of serial chains: time of one evaluation (µs)",
              {{{"links", false}, {"DTR", false}, {"DSR", false}, {"RR", false}}}};
  for (const ChainPoint& c : r.chains)
    chains.rows.push_back({{std::to_string(c.links), false},
                           {number(c.dtr), false},
                           {number(c.dsr), false},
                           {number(c.rr), false}});
  out += chains.text(bold, plain) + "Conclusions of the paper\n\n";
  int index = 0;
  for (const Conclusion& c : r.conclusions)
    out += std::to_string(++index) + ". " + c.claim + ": " + bold + verdict(c) + plain + ". " + c.evidence +
           "\n";
  return out;
}

std::string tables_csv(const TablesResult& r) {
  std::string csv =
      "table,mechanism,method,tolerance,ms,error_q,error_u,steps,evaluations,tangents,factorisations,closure_"
      "m,"
      "energy_drift_J,stopped\n";
  char line[512];
  const auto add = [&](const char* table, const Measurement& m) {
    std::snprintf(line, sizeof line, "%s,%s,%s,%g,%.5g,%.3g,%.3g,%ld,%ld,%ld,%ld,%.3g,%.3g,\"%s\"\n", table,
                  m.mechanism.c_str(), m.method.c_str(), m.tolerance, m.milliseconds, m.error.q, m.error.u,
                  m.steps, m.evaluations, m.tangents, m.factorisations, m.closure, m.energy_drift,
                  m.stopped.c_str());
    csv += line;
  };
  const auto is_open = [&](const std::string& name) {
    return std::find(r.open.begin(), r.open.end(), name) != r.open.end();
  };
  for (const EvaluationTime& e : r.evaluations) {
    Measurement one;
    one.mechanism = e.mechanism;
    one.method = e.formulation;
    one.milliseconds = 1e-3 * e.microseconds;
    one.evaluations = 1;
    add(is_open(e.mechanism) ? "I" : "III", one);
  }
  for (const Measurement& m : r.simulations) add(is_open(m.mechanism) ? "II" : "IV", m);
  for (const Comparison& c : r.comparisons) {
    const char* table = is_open(c.peer.mechanism) ? "V" : "VI";
    add(table, c.peer);
    if (!c.ours.method.empty()) add(table, c.ours);
  }
  return csv;
}

nlohmann::json tables_json(const TablesResult& r) {
  nlohmann::json out = {{"tolerance", r.tolerance}, {"peers", r.peers}};
  for (const EvaluationTime& e : r.evaluations)
    out["evaluations"].push_back(
        {{"mechanism", e.mechanism}, {"formulation", e.formulation}, {"us", e.microseconds}});
  for (const Measurement& m : r.simulations) out["simulations"].push_back(as_json(m));
  for (const Comparison& c : r.comparisons)
    out["comparisons"].push_back(
        {{"peer", as_json(c.peer)}, {"sinew", as_json(c.ours)}, {"factor", c.factor()}});
  for (const ChainPoint& c : r.chains)
    out["chains"].push_back({{"links", c.links}, {"DTR_us", c.dtr}, {"DSR_us", c.dsr}, {"RR_us", c.rr}});
  for (const Conclusion& c : r.conclusions)
    out["conclusions"].push_back({{"claim", c.claim}, {"verdict", verdict(c)}, {"evidence", c.evidence}});
  return out;
}

}  // namespace sinew::study
