// The accuracy study as one page: the first screen for whoever has two minutes, then scene by scene.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/accuracy_report.h"
#include "study/page.h"
#include "study/web.h"
#include "study/words.h"

namespace sinew::study {
namespace {

constexpr double kWideChart = 720, kNarrowChart = 350;  // units, which are CSS pixels
constexpr double kTold = 1e-8;  // m: nobody asks how well smaller errors of a step are estimated

void replace(std::string& text, const std::string& what, const std::string& with) {
  text.replace(text.find(what), what.size(), with);
}

bool any_peers(const AccuracyReport& report) {
  return std::any_of(report.results.begin(), report.results.end(),
                     [](const AccuracyResult& r) { return has_peers(r.points); });
}

/// Every engine of the points once, in their order.
std::vector<std::string> engines_of(const std::vector<AccuracyPoint>& points) {
  std::vector<std::string> engines;
  for (const AccuracyPoint& p : points)
    if (p.survived && std::find(engines.begin(), engines.end(), p.engine) == engines.end())
      engines.push_back(p.engine);
  return engines;
}

std::string steps_of(const AccuracyPoint& p) {
  return p.h > 0 ? "steps of 1/" + number(1 / p.h) + " s" : "steps of its own choice";
}

std::string lead(const std::vector<SummaryRow>& rows, const std::vector<CrowdCost>& crowds) {
  std::string items;
  for (const std::string& sentence : summary_sentences(rows, crowds))
    items += "<li>" + escaped(sentence) + "</li>\n";
  return "<ul class='lead'>\n" + items + "</ul>\n";
}

std::string first_table(const std::vector<SummaryRow>& rows, const std::vector<CrowdCost>& crowds) {
  Table table;
  if (!rows.empty())
    table.head({"One character, 60 Hz", "within", "average frame", "99 % of frames below", "slowest frame",
                "in 1 ms of a core", "instructions a frame"});
  for (const SummaryRow& row : rows) {
    if (!row.ours.survived) {
      table.row({row.title, length(row.error), "not reached", "", "", "", ""});
      continue;
    }
    table.row({row.title, length(row.error), duration(row.ours.us), duration(row.ours.us_p99),
               duration(row.ours.us_worst), std::to_string(row.per_millisecond()),
               number(row.ours.instructions)});
  }
  if (!crowds.empty())
    table.head({"Whole scenes, 60 Hz, default setting", "characters", "average frame", "99 % of frames below",
                "slowest frame", "average per character", "solved at a time"});
  for (const CrowdCost& c : crowds)
    table.row({c.title, std::to_string(c.characters), duration(c.us.mean), duration(c.us.p99),
               duration(c.us.worst), duration(c.us.mean / c.characters), number(c.solved)});
  return table.html();
}

/// Where one of the peers is cheaper, or that none is; nothing without peers.
std::string cheaper_elsewhere(const std::vector<SummaryRow>& rows) {
  std::string items;
  bool compared = false;
  for (const SummaryRow& row : rows) {
    std::string cheaper;
    for (const AccuracyPoint& p : row.peers) {
      compared = true;
      if (!row.ours.survived || p.us < row.ours.us)
        cheaper += (cheaper.empty() ? "" : ", ") + p.engine + " " + duration(p.us);
    }
    if (!cheaper.empty())
      items += "<li>" +
               escaped(row.title + ", within " + length(row.error) + ": " + cheaper +
                       (row.ours.survived ? " (Sinew " + duration(row.ours.us) + ")"
                                          : " (Sinew does not get there)")) +
               "</li>\n";
  }
  if (!compared) return {};
  if (items.empty()) return "<p>In none of these is another engine cheaper.</p>\n";
  return "<p>Where another engine is cheaper:</p>\n<ul>" + items + "</ul>\n";
}

/// What the words of the page mean, a sentence each.
std::string glossary() {
  constexpr const char* kWords[][2] = {
      {"Within 1 cm",
       "At no moment of the scene is the body, averaged over its mass, further than that from "
       "where steps at least 64 times as fine put it."},
      {"A frame",
       "1/60 s; its cost is processor time of one thread, the median of repeated runs. Average, 99 % and "
       "slowest "
       "are over the frames of a scene: the second around the push, or the fall."},
      {"Default scheme",
       "How the runtime steps (“bossak” in the diagrams): second order, so half the step leaves a quarter of "
       "the "
       "error where nothing strikes."},
      {"bdf1",
       "Implicit Euler, the simplest scheme that does not explode: half the step leaves half the error, and "
       "limbs "
       "swing as if in honey; for comparison only."},
      {"bdf2", "Second order from the last two steps, whatever touches in between; for comparison only."},
      {"momentum",
       "bdf1 with rotations as a balance of angular momentum, as the talk wrote them that Sinew began with, "
       "instead of an energy to minimise, so that nothing keeps it from exploding; for comparison only."},
      {"float, double", "Numbers of 32 or 64 bits; games use float."}};
  std::string html = "<dl>\n";
  for (const auto& word : kWords) html += std::string("<dt>") + word[0] + "</dt><dd>" + word[1] + "</dd>\n";
  return html + "</dl>\n";
}

/// "21 µs · 84 µs · 92 µs" of a measured setting: average, 99 %, slowest.
std::string frames_of(const nlohmann::json& setting, const std::string& key) {
  std::string text = duration(setting[key]);
  if (setting.contains(key + "_worst"))
    text += " · " + duration(setting[key + "_p99"]) + " · " + duration(setting[key + "_worst"]);
  return text;
}

std::string preset_table(const nlohmann::json& dial) {
  if (!dial.contains("presets")) return {};
  Table table;
  table.head({"preset", "meant for", "wanted", "error", "setting", "pushed: average · 99 % · slowest frame",
              "limp: average · 99 % · slowest frame"});
  std::vector<std::pair<std::string, nlohmann::json>> presets;
  for (const auto& [name, preset] : dial["presets"].items()) presets.emplace_back(name, preset);
  std::stable_sort(presets.begin(), presets.end(), [](const auto& a, const auto& b) {
    return a.second["wanted_m"].template get<double>() > b.second["wanted_m"].template get<double>();
  });
  for (const auto& [name, p] : presets) {
    const int parts = p["substeps"];
    std::string setting = p["precision"].get<std::string>() + ", " + std::to_string(parts) +
                          (parts == 1 ? " substep, " : " substeps, ") + length(p["tolerance"]);
    if (p.contains("same_as")) setting = "the same as " + p["same_as"].get<std::string>();
    table.row({name, p["for"], length(p["wanted_m"]), length(p["error_m"]), setting, frames_of(p, "us"),
               frames_of(p, "us_limp")});
  }
  std::string scenes;
  for (const auto& scene : dial["scenes"]) scenes += (scenes.empty() ? "" : ", ") + scene.get<std::string>();
  return "<section>\n<h2>Presets</h2>\n" +
         paragraph(
             "The cheapest settings that were measured within the error that is wanted, or, where none was, "
             "the most accurate. The error is the largest over " +
             scenes +
             "; times are per character and 1/60 s. In a scene that nobody measured the error may be twice "
             "as large: --max-error asks for half of what it is given.") +
         table.html() + "</section>\n";
}

/// Steps of 1/60 s by every option: average, 99 % and slowest frame.
std::string frame_table(const AccuracyResult& result) {
  Table table;
  table.head({"steps of 1/60 s", "error", "average frame", "99 % below", "slowest", "instructions a frame"});
  bool any = false;
  for (const AccuracyPoint& p : result.points) {
    if (!p.survived || (p.varied != "step" && p.varied != "policy")) continue;
    if (p.varied == "step" && std::abs(p.h * 60 - 1) > 1e-6) continue;
    any = true;
    table.row({p.label(), length(p.error), duration(p.us), duration(p.us_p99), duration(p.us_worst),
               number(p.instructions)});
  }
  return any ? table.html() : "";
}

/// What it costs to stay within each bound, engine by engine; a cell is average · 99 % · slowest.
std::string price_table(const AccuracyResult& result, bool angles) {
  const std::vector<AccuracyPoint> points = at_60_hz(result.points);
  const std::vector<std::string> engines = engines_of(points);
  if (engines.empty()) return {};
  Table table;
  std::vector<std::string> head{"to stay within, at 60 Hz"};
  for (const std::string& engine : engines) head.push_back(engine + ": average · 99 % · slowest frame");
  table.head(head);
  bool reached = false;
  const auto add = [&](const std::string& bound, double limit, double AccuracyPoint::*error) {
    std::vector<std::string> row{bound};
    for (const std::string& engine : engines) {
      const AccuracyPoint* best = cheapest(points, engine, limit, error);
      std::string cell = best ? duration(best->us) : "–";
      reached |= best != nullptr;
      if (best && best->us_worst >= 0)
        cell += " · " + duration(best->us_p99) + " · " + duration(best->us_worst);
      row.push_back(cell);
    }
    table.row(row);
  };
  if (angles)
    for (const double angle : kAngles) add(number(angle) + "°", angle, &AccuracyPoint::degrees);
  else
    for (const double error : kPrices) add(length(error), error, &AccuracyPoint::error);
  if (!reached)
    return paragraph("At 60 Hz no setting gets within " +
                     (angles ? number(kAngles[0]) + "°" : length(kPrices[0])) + ".");
  return table.html();
}

std::string chart(const AccuracyResult& result) {
  const std::vector<ChartLine> lines = chart_lines(result);
  if (lines.empty()) return {};
  std::string key;
  for (const ChartLine& line : lines) key += key_entry(line.label, line.colour);
  return figure(chart_svg(result, kWideChart, 400), chart_svg(result, kNarrowChart, 330)) +
         "<p class='key'>" + key + "</p>\n";
}

/// Who is ahead of ours at 60 Hz; nothing where no peer was measured.
std::string ahead_sentence(const AccuracyResult& result) {
  const std::vector<AccuracyPoint> ahead = ahead_of_ours(result.points);
  if (ahead.empty() || !has_peers(result.points)) return {};
  const auto named = [](const AccuracyPoint& p) {
    return (p.engine == "Sinew" ? "Our " : p.engine + " ") + p.option + " in " + steps_of(p) + " (" +
           duration(p.us) + ", " + length(p.error) + ")";
  };
  std::string text = named(ahead[0]);
  if (ahead.size() == 1)
    return paragraph(text + " is on the front: no peer measured here is both cheaper and closer.");
  for (std::size_t n = 1; n < ahead.size(); ++n) text += (n == 1 ? " is behind " : ", ") + named(ahead[n]);
  return paragraph(text + ". What it would take: " + result.scene.to_catch_up);
}

std::string orders(const AccuracyResult& result) {
  if (result.slopes.empty()) return {};
  std::string text = "Order found when the step is halved: ";
  for (const Slope& s : result.slopes) {
    text += (&s == &result.slopes[0] ? "" : ", ") + s.option + " ";
    text += s.found != 0 ? fmt::format("{:.2f}", s.found) : "none, all errors below " + length(kExact);
    if (s.expected != 0) text += " (theory " + number(s.expected) + ")";
  }
  return paragraph(text + ".");
}

/// Who did not get to the end, and who did not begin.
std::string missing(const AccuracyResult& result) {
  std::string lost, html;
  std::vector<std::string> refused;
  for (const AccuracyPoint& p : result.points) {
    if (p.survived) continue;
    if (p.refusal.empty()) {
      lost += (lost.empty() ? "" : ", ") + p.label() + " in " + steps_of(p);
      continue;
    }
    const std::string sentence = p.engine + " is not here: " + p.refusal + ".";
    if (std::find(refused.begin(), refused.end(), sentence) == refused.end()) refused.push_back(sentence);
  }
  if (!lost.empty()) html += paragraph("Did not survive: " + lost + ".");
  for (const std::string& sentence : refused) html += paragraph(sentence);
  return html;
}

std::string scene_section(const AccuracyResult& result) {
  const bool peers = has_peers(result.points);
  std::string html = "<section>\n<h2>" + escaped(result.scene.title) + "</h2>\n" +
                     paragraph(result.scene.reading + (peers ? " " + result.scene.beside_peers : "")) +
                     chart(result) + frame_table(result) + price_table(result, false);
  if (result.scene.drive) html += price_table(result, true);
  std::vector<EstimatedFrame> estimates;
  for (const EstimatedFrame& f : result.estimates)
    if (f.estimated > 0 && f.truth > kTold) estimates.push_back(f);
  if (estimates.size() > 3)
    html +=
        paragraph(
            "What a step of 1/60 s estimates its own error to be (telemetry's estimated_error_m) against the "
            "truth: dots above the line are too careful, dots below it too bold. Steps that were played, and "
            "said so, are not shown.") +
        figure(agreement_svg(estimates, 460), agreement_svg(estimates, kNarrowChart));
  html += ahead_sentence(result);
  if (result.uncertainty >= 0)
    html += paragraph("The finest run and one of twice its step lie " + length(result.uncertainty) +
                      " apart: nothing below that tells settings apart here.");
  html += orders(result);
  if (result.references_apart >= 0)
    html += paragraph("The finest runs of two engines lie " + length(result.references_apart) + " apart.");
  return html + missing(result) + "</section>\n";
}

std::string falls_section(const std::vector<Ensemble>& falls) {
  if (falls.empty()) return {};
  std::string html =
      "<section>\n<h2>Falls, judged as a crowd</h2>\n" +
      paragraph(
          "After an impact a single fall is chaos: the finest runs are decimetres apart within a second, so "
          "positions say nothing. The mean energy of many falls does: a scheme whose falls have too little "
          "looks heavy, one with too much explodes.");
  for (const EnsembleScene& scene : ensemble_scenes())
    for (const double hz : {60.0, 30.0})
      if (const std::string svg = ensembles_svg(falls, scene, hz); !svg.empty()) html += figure(svg);
  Table table;
  table.head({"share of the true mean energy", "steps", "falls", "after 0.5 s", "0.75 s", "1 s", "1.5 s"});
  for (const Ensemble& e : falls) {
    std::vector<std::string> row{e.scene + ", " + e.engine + " " + e.option, rate(1 / e.hz),
                                 std::to_string(e.seeds)};
    for (const double at : {0.5, 0.75, 1.0, 1.5}) {
      const double share = 100 * e.share(at), off = 100 * e.uncertainty(at);
      row.push_back(std::isfinite(share) && share < 1e4 ? number(share) + " ± " + number(off) + " %"
                                                        : "exploded");
    }
    table.row(row);
  }
  return html + table.html() + "</section>\n";
}

std::string how_to_read(bool peers) {
  return std::string(
             "<section>\n<h2>Scene by scene</h2>\n<p>Each dot is one setting: to the right it costs more "
             "processor time per simulated 1/60 s, further down it is more accurate. The best lie at the "
             "lower left; ringed dots are what nothing beats in both. Error is the largest root mean square "
             "displacement of all mass from ") +
         (peers ? "the finest run of the same engine, since contact laws differ between engines"
                : "the finest run") +
         ". Point at a dot for its setting.</p>\n</section>\n";
}

}  // namespace

std::string accuracy_html(const AccuracyReport& report) {
  const std::vector<SummaryRow> rows = summary_rows(report.results);
  std::string first;
  if (!report.busy.empty())
    first += "<p class='busy'>The machine was busy: " + escaped(report.busy) +
             ". Times on this page are not to be relied on, and no presets were written.</p>\n";
  if (!rows.empty() || !report.crowds.empty())
    first += lead(rows, report.crowds) + first_table(rows, report.crowds);
  if (!rows.empty())
    first += "<h3>How many fit into one millisecond of one core</h3>\n" +
             figure(summary_svg(rows, kWideChart), summary_svg(rows, kNarrowChart)) + cheaper_elsewhere(rows);
  std::string body = preset_table(report.dial) + how_to_read(any_peers(report));
  for (const AccuracyResult& result : report.results) body += scene_section(result);
  body += falls_section(report.falls);
  for (const ReportPicture& p : report.pictures)
    body += "<section>\n<h2>" + escaped(p.title) + "</h2>\n" + paragraph(p.reading) + figure(p.svg) +
            "</section>\n";
  std::string page = web::kReport;
  replace(page, "@MACHINE@", escaped(machine()));
  replace(page, "@FIRST@", first);
  replace(page, "@WORDS@", glossary());
  replace(page, "@BODY@", body);
  return page;
}

}  // namespace sinew::study
