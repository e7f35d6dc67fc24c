// The accuracy study as CSV, JSON and one page to read.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "study/accuracy.h"
#include "study/web.h"

namespace sinew::study {
namespace {

constexpr double kPrices[] = {1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5};  // m

void replace(std::string& text, const std::string& what, const std::string& with) {
  text.replace(text.find(what), what.size(), with);
}

}  // namespace

std::string machine() {
  std::ifstream info("/proc/cpuinfo");
  std::string line, name = "unknown processor";
  while (std::getline(info, line))
    if (line.rfind("model name", 0) == 0) {
      name = line.substr(line.find(':') + 2);
      break;
    }
  return name + ", one core; GCC " __VERSION__ "; medians of repeated runs, quartiles on hover.";
}

std::string accuracy_csv(const std::vector<AccuracyResult>& results) {
  std::string csv =
      "scene,engine,option,varied,h_s,tolerance_m,substeps,max_iterations,survived,error_m,energy,us_per_"
      "frame,"
      "us_q1,us_q3,passes,pareto\n";
  char line[300];
  for (const AccuracyResult& result : results)
    for (const AccuracyPoint& p : result.points) {
      std::snprintf(line, sizeof line, "%s,%s,%s,%s,%.9g,%.3g,%d,%d,%d,%.6g,%.6g,%.4g,%.4g,%.4g,%.3f,%d\n",
                    result.scene.name.c_str(), p.engine.c_str(), p.option.c_str(), p.varied.c_str(), p.h,
                    p.accuracy.tolerance, p.accuracy.substeps, p.accuracy.max_iterations, p.survived, p.error,
                    p.energy, p.us, p.us_low, p.us_high, p.passes, p.pareto);
      csv += line;
    }
  return csv;
}

nlohmann::json accuracy_json(const std::vector<AccuracyResult>& results) {
  nlohmann::json scenes = nlohmann::json::array();
  for (const AccuracyResult& result : results) {
    nlohmann::json points = nlohmann::json::array(), slopes = points, prices = points;
    for (const AccuracyPoint& p : result.points)
      points.push_back({{"engine", p.engine},
                        {"option", p.option},
                        {"varied", p.varied},
                        {"h", p.h},
                        {"tolerance", p.accuracy.tolerance},
                        {"substeps", p.accuracy.substeps},
                        {"max_iterations", p.accuracy.max_iterations},
                        {"survived", p.survived},
                        {"refusal", p.refusal},
                        {"error", p.error},
                        {"energy", p.energy},
                        {"us", p.us},
                        {"us_low", p.us_low},
                        {"us_high", p.us_high},
                        {"passes", p.passes},
                        {"pareto", p.pareto}});
    for (const Slope& s : result.slopes)
      slopes.push_back(
          {{"engine", s.engine}, {"option", s.option}, {"found", s.found}, {"expected", s.expected}});
    for (const double error : kPrices) {
      nlohmann::json row = {{"error", error}};
      for (const AccuracyPoint& p : result.points) row[p.engine] = price_of(result.points, p.engine, error);
      prices.push_back(row);
    }
    scenes.push_back({{"name", result.scene.name},
                      {"title", result.scene.title},
                      {"reading", result.scene.reading},
                      {"references_apart", result.references_apart},
                      {"points", points},
                      {"slopes", slopes},
                      {"prices", prices}});
  }
  return {{"machine", machine()}, {"scenes", scenes}};
}

std::string accuracy_html(const std::vector<AccuracyResult>& results) {
  std::string page = web::kReport, data = accuracy_json(results).dump();
  for (std::size_t at; (at = data.find("</")) != std::string::npos;) data.replace(at, 2, "<\\/");
  replace(page, "@UPLOT_CSS@", web::kChartStyle);
  replace(page, "@UPLOT_JS@", web::kChartScript);
  replace(page, "@DATA@", data);
  return page;
}

}  // namespace sinew::study
