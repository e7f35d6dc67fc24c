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

/// Instructions in thousands or millions.
std::string instructions(double x) {
  if (!(x > 0)) return "–";
  return x < 1e5 ? number(x / 1e3) + " k" : number(x / 1e6) + " M";
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
  for (const std::string& m : mechanisms) {
    grid.rows[0].push_back({m, false});
    grid.rows[0].push_back({"µs", false});
  }
  for (const std::string& f : formulations) {
    auto& row = grid.rows.emplace_back();
    row.push_back({f, false});
    for (const std::string& m : mechanisms) {
      const auto cost = [&](const std::string& formulation) {
        const EvaluationCost* e = evaluation(r, m, formulation);
        return !e ? 0 : r.counted ? e->instructions : e->microseconds;
      };
      const double here = cost(f);
      const bool best =
          here > 0 && std::all_of(formulations.begin(), formulations.end(),
                                  [&](const std::string& other) { return here <= cost(other); });
      const EvaluationCost* e = evaluation(r, m, f);
      row.push_back({e ? instructions(e->instructions) : "–", best});
      row.push_back({e ? number(e->microseconds) : "–", false});
    }
  }
  return grid;
}

Grid simulations(const TablesResult& r, const std::string& title,
                 const std::vector<std::string>& mechanisms) {
  Grid grid{title, {{{"integrator · formulation", false}}}};
  std::vector<std::string> methods;
  for (const SimulationRun& m : r.simulations)
    if (std::find(mechanisms.begin(), mechanisms.end(), m.mechanism) != mechanisms.end() &&
        std::find(methods.begin(), methods.end(), m.method) == methods.end())
      methods.push_back(m.method);
  for (const std::string& m : mechanisms) {
    grid.rows[0].push_back({m, false});
    for (const char* column : {"ms", "error q / u", "steps"}) grid.rows[0].push_back({column, false});
  }
  for (const std::string& method : methods) {
    auto& row = grid.rows.emplace_back();
    row.push_back({method, false});
    for (const std::string& mechanism : mechanisms) {
      const SimulationRun* m = find(r, mechanism, method);
      if (!m || !m->stopped.empty()) {
        row.insert(row.end(), {{"–", false}, {"", false}, {m ? brief(m->stopped) : "", false}, {"", false}});
        continue;
      }
      row.push_back({instructions(m->instructions), m == best_simulation(r, mechanism)});
      row.push_back({number(m->milliseconds), false});
      row.push_back({exponent(m->error.q) + " / " + exponent(m->error.u), false});
      row.push_back({std::to_string(m->steps), false});
    }
  }
  return grid;
}

bool is_closed(const TablesResult& r, const std::string& mechanism) {
  return std::any_of(r.mechanisms.begin(), r.mechanisms.end(),
                     [&](const StudiedMechanism& m) { return m.name == mechanism && m.closed(); });
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
    if (is_closed(r, c.peer.mechanism) == open) continue;
    const auto error = [](const SimulationRun& m) {
      return exponent(m.error.q) + " / " + exponent(m.error.u);
    };
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

nlohmann::json as_json(const SimulationRun& m) {
  return {{"mechanism", m.mechanism},
          {"method", m.method},
          {"tolerance", m.tolerance},
          {"ms", m.milliseconds},
          {"instructions", m.instructions},
          {"error_q", m.error.q},
          {"error_u", m.error.u},
          {"steps", m.steps},
          {"evaluations", m.evaluations},
          {"tangents", m.tangents},
          {"factorisations", m.factorisations},
          {"closure_m", m.closure},
          {"energy_drift_J", m.energy_drift},
          {"stopped", m.stopped}};
}

}  // namespace

namespace {

/// The paper's mechanisms that differ from ours in a way that the tables cannot show.
constexpr const char* kDifferences =
    "The paper simulates Bricard's mechanism for 5 s, here it runs for 10; the paper's MFS has 14 degrees of "
    "freedom, here it "
    "has 13 (tie rods are distance equations, so their spins are no coordinates). Mechanisms beyond its own "
    "are marked by not "
    "being in its tables; the paper's data are not published, the figures of other mechanisms are not to be "
    "compared with "
    "its own.\n\n";

std::string conclusions_text(const TablesResult& r, const std::string& bold, const std::string& plain) {
  std::string out = "Conclusions of the paper, judged by instructions on every mechanism\n\n";
  int index = 0;
  for (const Conclusion& c : r.conclusions) {
    const std::string is = verdict(c);
    out += std::to_string(++index) + ". " + c.claim + " (" + c.place + "): " + bold + is + plain + ".";
    std::string list;
    for (const Evidence& e : c.evidence)
      list += (list.empty() ? " " : "; ") + e.about + " " + e.figures + (e.holds ? "" : " (not)");
    if (!list.empty()) out += " " + c.figures_are + ":" + list + ".";
    if (!c.note.empty() && is != "holds") out += " " + c.note + ".";
    out += "\n";
  }
  return out;
}

std::string chains_text(const TablesResult& r, const std::string& bold, const std::string& plain) {
  Grid chains{"Work of serial chains: one evaluation",
              {{{"links", false},
                {"DTR", false},
                {"µs", false},
                {"DSR", false},
                {"µs", false},
                {"RR", false},
                {"µs", false}}}};
  for (const ChainPoint& c : r.chains)
    chains.rows.push_back({{std::to_string(c.links), false},
                           {instructions(c.dtr_instructions), false},
                           {number(c.dtr), false},
                           {instructions(c.dsr_instructions), false},
                           {number(c.dsr), false},
                           {instructions(c.rr_instructions), false},
                           {number(c.rr), false}});
  return chains.text(bold, plain);
}

}  // namespace

std::string tables_text(const TablesResult& r, const std::string& bold, const std::string& plain) {
  const std::string at =
      " at tolerance " + exponent(r.tolerance) +
      " (instructions; ms of CPU time; error max |Δ|/(1+|x|); the fewest instructions are bold)";
  const std::vector<std::string> open = r.names(false), closed = r.names(true);
  std::string out;
  if (!open.empty()) {
    out += evaluations(r, "Table I. Open chains: instructions and time of one derivative or residual", open,
                       {"DTR", "DSR", "RR", "Cartesian-penalty", "Cartesian-multipliers"})
               .text(bold, plain);
    out += simulations(r, "Table II. Open chains: simulation" + at, open).text(bold, plain);
  }
  if (!closed.empty()) {
    out += evaluations(r, "Table III. Closed chains: instructions and time of one derivative or residual",
                       closed,
                       {"DSR-Rz", "RR-Rz", "DSR-Rz2", "RR-Rz2", "Cartesian-penalty", "Cartesian-multipliers"})
               .text(bold, plain);
    out += simulations(r, "Table IV. Closed chains: simulation" + at, closed).text(bold, plain);
  }
  out += kDifferences;
  if (r.peers) {
    out += comparisons(r, "Table V. Open chains against independent programs" + at, true).text(bold, plain);
    out +=
        comparisons(r, "Table VI. Closed chains against independent programs" + at, false).text(bold, plain);
  } else {
    out += "Tables V and VI (against independent programs) need a build with -DSINEW_PEERS=ON.\n\n";
  }
  return out + chains_text(r, bold, plain) + conclusions_text(r, bold, plain);
}

std::string tables_csv(const TablesResult& r) {
  std::string csv =
      "table,mechanism,method,tolerance,instructions,ms,error_q,error_u,steps,evaluations,tangents,"
      "factorisations,closure_"
      "m,"
      "energy_drift_J,stopped\n";
  char line[512];
  const auto add = [&](const char* table, const SimulationRun& m) {
    std::snprintf(line, sizeof line, "%s,%s,%s,%g,%.0f,%.5g,%.3g,%.3g,%ld,%ld,%ld,%ld,%.3g,%.3g,\"%s\"\n",
                  table, m.mechanism.c_str(), m.method.c_str(), m.tolerance, m.instructions, m.milliseconds,
                  m.error.q, m.error.u, m.steps, m.evaluations, m.tangents, m.factorisations, m.closure,
                  m.energy_drift, m.stopped.c_str());
    csv += line;
  };
  for (const EvaluationCost& e : r.evaluations) {
    SimulationRun one;
    one.mechanism = e.mechanism;
    one.method = e.formulation;
    one.milliseconds = 1e-3 * e.microseconds;
    one.instructions = e.instructions;
    one.evaluations = 1;
    add(is_closed(r, e.mechanism) ? "III" : "I", one);
  }
  for (const SimulationRun& m : r.curves) add(is_closed(r, m.mechanism) ? "IV" : "II", m);
  for (const Comparison& c : r.comparisons) {
    const char* table = is_closed(r, c.peer.mechanism) ? "VI" : "V";
    add(table, c.peer);
    if (!c.ours.method.empty()) add(table, c.ours);
  }
  return csv;
}

nlohmann::json tables_json(const TablesResult& r) {
  nlohmann::json out = {{"tolerance", r.tolerance}, {"peers", r.peers}};
  for (const EvaluationCost& e : r.evaluations)
    out["evaluations"].push_back({{"mechanism", e.mechanism},
                                  {"formulation", e.formulation},
                                  {"us", e.microseconds},
                                  {"instructions", e.instructions}});
  for (const SimulationRun& m : r.simulations) out["simulations"].push_back(as_json(m));
  for (const SimulationRun& m : r.curves) out["curves"].push_back(as_json(m));
  for (const Comparison& c : r.comparisons)
    out["comparisons"].push_back(
        {{"peer", as_json(c.peer)}, {"sinew", as_json(c.ours)}, {"factor", c.factor()}});
  for (const ChainPoint& c : r.chains)
    out["chains"].push_back({{"links", c.links}, {"DTR_us", c.dtr}, {"DSR_us", c.dsr}, {"RR_us", c.rr}});
  for (const Conclusion& c : r.conclusions) {
    nlohmann::json evidence = nlohmann::json::array();
    for (const Evidence& e : c.evidence)
      evidence.push_back({{"about", e.about}, {"holds", e.holds}, {"figures", e.figures}});
    out["conclusions"].push_back({{"place", c.place},
                                  {"claim", c.claim},
                                  {"verdict", verdict(c)},
                                  {"figures_are", c.figures_are},
                                  {"evidence", evidence},
                                  {"note", c.note}});
  }
  return out;
}

}  // namespace sinew::study
