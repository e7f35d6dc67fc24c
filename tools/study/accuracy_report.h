// The accuracy study for readers: figures of the first screen, CSV, JSON, pictures and the page.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "convert/convert.h"
#include "study/accuracy.h"
#include "study/accuracy_crowds.h"
#include "study/canvas.h"
#include "study/ensembles.h"

namespace sinew::study {

/// What one character costs at 60 Hz where it happens and where so much error is allowed.
struct SummaryRow {
  std::string scene, title, who;  ///< "tracking", "A walker is pushed", "a walker who is pushed"
  double error = 0;               ///< m, allowed
  /// The runtime's cheapest setting within it, of steps of 1/60 s and finer; AccuracyPoint::survived is false
  /// where there is none.
  AccuracyPoint ours;
  std::vector<AccuracyPoint> peers;  ///< each peer's cheapest, those that get there
  /// How many of them fit into a millisecond of one core.
  int per_millisecond() const { return ours.us > 0 ? static_cast<int>(1000 / ours.us) : 0; }
};
/// Pushed walker, pushed runner, limp figure; 1 cm and 1 mm each. Scenes that were not run are left out.
std::vector<SummaryRow> summary_rows(const std::vector<AccuracyResult>& results);
/// "At 60 frames a second, a walker who is pushed costs …": what they say, and what the crowd costs.
std::vector<std::string> summary_sentences(const std::vector<SummaryRow>& rows,
                                           const std::vector<CrowdCost>& crowds);
bool has_peers(const std::vector<AccuracyPoint>& points);

/// Errors for which scenes say what they cost.
constexpr double kPrices[] = {1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5};  // m
constexpr double kAngles[] = {5, 2, 1, 0.5, 0.2};                   // degrees

/// A drawn picture that the page shows: heading, help to read it, SVG.
struct ReportPicture {
  std::string title, reading, svg;
};

/// All that the page tells.
struct AccuracyReport {
  std::vector<AccuracyResult> results;
  nlohmann::json dial;  ///< see dial_json(); may be null
  std::vector<CrowdCost> crowds = {};
  std::vector<Ensemble> falls = {};
  std::vector<ReportPicture> pictures = {};
  std::string busy = {};  ///< MachineCheck::reason(): why times are not to be believed
};

/// Processor and compiler, for whoever compares.
std::string machine();
std::string accuracy_csv(const std::vector<AccuracyResult>& results);
nlohmann::json accuracy_json(const AccuracyReport& report);
/// One self-contained page, whose text, tables and pictures need no script.
std::string accuracy_html(const AccuracyReport& report);

/// What a line of a diagram is called and how it is drawn.
struct ChartLine {
  std::string label;
  Colour colour;
};
/// Lines of a scene's diagram, in the order in which they are drawn.
std::vector<ChartLine> chart_lines(const AccuracyResult& result);
/// The diagram without legend, of about that size; empty where there is nothing to draw.
std::string chart_svg(const AccuracyResult& result, double width, double height);
/// How many characters fit into a millisecond, as bars.
std::string summary_svg(const std::vector<SummaryRow>& rows, double width);
/// Estimated error of single steps against the true one; on the line they agree.
std::string agreement_svg(const std::vector<EstimatedFrame>& frames, double width);
/// One scene's diagram with its legend, .png or .svg.
convert::Error draw_accuracy(const AccuracyResult& result, const std::string& file);

}  // namespace sinew::study
