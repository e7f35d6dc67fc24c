// Figures of the first screen.
#include <algorithm>

#include "study/accuracy_report.h"

namespace sinew::study {
namespace {

std::string title_of(const std::string& scene) {
  if (scene == "tracking") return "A walker is pushed";
  if (scene == "running") return "A runner is pushed";
  return "A standing figure goes limp";
}

}  // namespace

bool has_peers(const std::vector<AccuracyPoint>& points) {
  return std::any_of(points.begin(), points.end(),
                     [](const AccuracyPoint& p) { return p.engine != "Sinew" && p.survived; });
}

std::vector<SummaryRow> summary_rows(const std::vector<AccuracyResult>& results) {
  std::vector<SummaryRow> rows;
  for (const char* scene : kSummaryScenes)
    for (const AccuracyResult& result : results) {
      if (result.scene.name != scene) continue;
      const std::vector<AccuracyPoint> points = at_60_hz(result.points);
      std::vector<std::string> peers;
      for (const AccuracyPoint& p : points)
        if (p.engine != "Sinew" && std::find(peers.begin(), peers.end(), p.engine) == peers.end())
          peers.push_back(p.engine);
      for (const double error : kSummaryErrors) {
        SummaryRow& row = rows.emplace_back();
        row.scene = scene;
        row.title = title_of(scene);
        row.error = error;
        if (const AccuracyPoint* best = cheapest(points, "Sinew", error)) row.ours = *best;
        for (const std::string& peer : peers)
          if (const AccuracyPoint* best = cheapest(points, peer, error)) row.peers.push_back(*best);
      }
    }
  return rows;
}

}  // namespace sinew::study
