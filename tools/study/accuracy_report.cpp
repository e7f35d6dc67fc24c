// The accuracy study as CSV and JSON.
#include "study/accuracy_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <thread>

namespace sinew::study {
namespace {

nlohmann::json summary_json(const std::vector<SummaryRow>& rows) {
  nlohmann::json out = nlohmann::json::array();
  for (const SummaryRow& row : rows) {
    nlohmann::json peers = nlohmann::json::array();
    for (const AccuracyPoint& p : row.peers) peers.push_back(point_json(p));
    out.push_back({{"scene", row.scene},
                   {"title", row.title},
                   {"error_m", row.error},
                   {"sinew", row.ours.survived ? point_json(row.ours) : nlohmann::json()},
                   {"per_millisecond", row.per_millisecond()},
                   {"peers", peers}});
  }
  return out;
}

nlohmann::json crowds_json(const std::vector<CrowdCost>& crowds) {
  nlohmann::json out = nlohmann::json::array();
  for (const CrowdCost& c : crowds)
    out.push_back({{"name", c.name},
                   {"title", c.title},
                   {"characters", c.characters},
                   {"solved", c.solved},
                   {"us", c.us.mean},
                   {"us_p99", c.us.p99},
                   {"us_worst", c.us.worst}});
  return out;
}

}  // namespace

std::vector<AccuracyPoint> ahead_of_ours(const std::vector<AccuracyPoint>& points) {
  std::vector<AccuracyPoint> out;
  for (const AccuracyPoint& p : points)
    if (out.empty() && p.engine == "Sinew" && p.option == "bossak float" && p.varied == "step" &&
        p.survived && std::abs(p.h - 1.0 / 60) < 1e-6)
      out.push_back(p);
  if (out.empty()) return out;
  for (const AccuracyPoint& p : points) {
    if (p.engine == "Sinew" || !p.survived || p.us > out[0].us || p.error > out[0].error) continue;
    const auto same =
        std::find_if(out.begin(), out.end(), [&](const AccuracyPoint& q) { return q.engine == p.engine; });
    if (same == out.end())
      out.push_back(p);
    else if (p.us < same->us)
      *same = p;
  }
  return out;
}

std::string machine() {
  std::ifstream info("/proc/cpuinfo");
  std::string line, name = "unknown processor";
  while (std::getline(info, line))
    if (line.rfind("model name", 0) == 0) {
      name = line.substr(line.find(':') + 2);
      break;
    }
  return name + ", " + std::to_string(std::max(1u, std::thread::hardware_concurrency())) +
         " virtual cores, of which one is used; GCC " __VERSION__;
}

std::string accuracy_csv(const std::vector<AccuracyResult>& results) {
  std::string csv =
      "scene,engine,option,varied,h_s,tolerance_m,substeps,max_iterations,sink_depth_m,stick_speed,survived,"
      "error_m,error_deg,"
      "energy,momentum,us_per_"
      "frame,"
      "us_q1,us_q3,us_p99,us_worst,instructions,passes,pareto\n";
  char line[400];
  for (const AccuracyResult& result : results)
    for (const AccuracyPoint& p : result.points) {
      std::snprintf(line, sizeof line,
                    "%s,%s,%s,%s,%.9g,%.3g,%d,%d,%.3g,%.3g,%d,%.6g,%.4g,%.6g,%.4g,%.4g,%.4g,%.4g,%.4g,%.4g,%."
                    "9g,%.3f,%d\n",
                    result.scene.name.c_str(), p.engine.c_str(), p.option.c_str(), p.varied.c_str(), p.h,
                    p.accuracy.tolerance, p.accuracy.substeps, p.accuracy.max_iterations,
                    p.accuracy.sink_depth, p.accuracy.stick_speed, p.survived, p.error, p.degrees, p.energy,
                    p.momentum, p.us, p.us_low, p.us_high, p.us_p99, p.us_worst, p.instructions, p.passes,
                    p.pareto);
      csv += line;
    }
  return csv;
}

nlohmann::json point_json(const AccuracyPoint& p) {
  return {{"engine", p.engine},
          {"option", p.option},
          {"varied", p.varied},
          {"h", p.h},
          {"tolerance", p.accuracy.tolerance},
          {"substeps", p.accuracy.substeps},
          {"max_iterations", p.accuracy.max_iterations},
          {"max_splits", p.accuracy.max_splits},
          {"sink_depth", p.accuracy.sink_depth},
          {"stick_speed", p.accuracy.stick_speed},
          {"survived", p.survived},
          {"refusal", p.refusal},
          {"error", p.error},
          {"degrees", p.degrees},
          {"energy", p.energy},
          {"momentum", p.momentum},
          {"us", p.us},
          {"us_low", p.us_low},
          {"us_high", p.us_high},
          {"us_p99", p.us_p99},
          {"us_worst", p.us_worst},
          {"instructions", p.instructions},
          {"passes", p.passes},
          {"pareto", p.pareto}};
}

AccuracyPoint point_from(const nlohmann::json& json) {
  AccuracyPoint p;
  p.engine = json.at("engine");
  p.option = json.at("option");
  p.varied = json.at("varied");
  p.h = json.at("h");
  p.accuracy.tolerance = json.at("tolerance");
  p.accuracy.substeps = json.at("substeps");
  p.accuracy.max_iterations = json.at("max_iterations");
  p.accuracy.max_splits = json.at("max_splits");
  p.accuracy.sink_depth = json.at("sink_depth");
  p.accuracy.stick_speed = json.at("stick_speed");
  p.survived = json.at("survived");
  p.refusal = json.at("refusal");
  if (!p.survived) return p;  // what it did then is no number
  p.error = json.at("error");
  p.degrees = json.at("degrees");
  p.energy = json.at("energy");
  p.momentum = json.at("momentum");
  p.us = json.at("us");
  p.us_low = json.at("us_low");
  p.us_high = json.at("us_high");
  p.us_p99 = json.at("us_p99");
  p.us_worst = json.at("us_worst");
  p.instructions = json.at("instructions");
  p.passes = json.at("passes");
  return p;
}

nlohmann::json accuracy_json(const AccuracyReport& report) {
  nlohmann::json scenes = nlohmann::json::array();
  for (const AccuracyResult& result : report.results) {
    nlohmann::json points = nlohmann::json::array(), slopes = points, prices = points, angles = points,
                   estimates = points, ahead = points;
    for (const AccuracyPoint& p : ahead_of_ours(result.points)) ahead.push_back(point_json(p));
    for (const AccuracyPoint& p : result.points) points.push_back(point_json(p));
    for (const Slope& s : result.slopes)
      slopes.push_back(
          {{"engine", s.engine}, {"option", s.option}, {"found", s.found}, {"expected", s.expected}});
    const std::vector<AccuracyPoint> offered = at_60_hz(result.points);
    const auto price = [&](double bound, double AccuracyPoint::*error) {
      nlohmann::json row = {{"error", bound}};
      for (const AccuracyPoint& p : offered) {
        const AccuracyPoint* best = cheapest(offered, p.engine, bound, error);
        row[p.engine] = best ? best->us : -1;
      }
      return row;
    };
    for (const double error : kPrices) prices.push_back(price(error, &AccuracyPoint::error));
    for (const double angle : kAngles)
      if (result.scene.drive) angles.push_back(price(angle, &AccuracyPoint::degrees));
    for (const EstimatedFrame& f : result.estimates)
      if (f.estimated > 0 && f.truth > 0) estimates.push_back({f.truth, f.estimated});
    scenes.push_back({{"name", result.scene.name},
                      {"title", result.scene.title},
                      {"reading", result.scene.reading},
                      {"ahead", ahead},
                      {"to_catch_up", result.scene.to_catch_up},
                      {"references_apart", result.references_apart},
                      {"uncertainty", result.uncertainty},
                      {"points", points},
                      {"slopes", slopes},
                      {"prices", prices},
                      {"angles", angles},
                      {"estimates", estimates}});
  }
  return {{"machine", machine()},
          {"busy", report.busy},
          {"summary", summary_json(summary_rows(report.results))},
          {"crowds", crowds_json(report.crowds)},
          {"falls", ensembles_json(report.falls).at("ensembles")},
          {"scenes", scenes},
          {"dial", report.dial}};
}

}  // namespace sinew::study
