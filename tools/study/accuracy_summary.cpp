// Figures and sentences of the first screen.
#include <algorithm>
#include <cctype>
#include <iterator>

#include "study/accuracy_report.h"
#include "study/words.h"

namespace sinew::study {
namespace {

/// Of kSummaryScenes: alone, and within a sentence.
constexpr const char* kNames[][2] = {{"A walker is pushed", "a walker who is pushed"},
                                     {"A runner is pushed", "a runner who is pushed"},
                                     {"A standing figure goes limp", "a figure that goes limp"}};
static_assert(std::size(kNames) == std::size(kSummaryScenes));

/// "a walker who is pushed costs 15 µs a frame where 1 cm is close enough, 40 µs for 1 mm: 66 or 25 of them
/// fit into a millisecond of one core".
std::string price_sentence(const SummaryRow& rough, const SummaryRow& fine) {
  if (!rough.ours.survived) return rough.who + " does not get within " + length(rough.error);
  std::string text = rough.who + " costs " + duration(rough.ours.us) + " a frame where " +
                     length(rough.error) + " is close enough";
  if (!fine.ours.survived)
    return text + " (" + std::to_string(rough.per_millisecond()) + " of them in a millisecond of one core)";
  return text + ", " + duration(fine.ours.us) + " for " + length(fine.error) + ": " +
         std::to_string(rough.per_millisecond()) + " or " + std::to_string(fine.per_millisecond()) +
         " of them fit into a millisecond of one core";
}

}  // namespace

bool has_peers(const std::vector<AccuracyPoint>& points) {
  return std::any_of(points.begin(), points.end(),
                     [](const AccuracyPoint& p) { return p.engine != "Sinew" && p.survived; });
}

std::vector<SummaryRow> summary_rows(const std::vector<AccuracyResult>& results) {
  std::vector<SummaryRow> rows;
  for (std::size_t n = 0; n < std::size(kSummaryScenes); ++n)
    for (const AccuracyResult& result : results) {
      if (result.scene.name != kSummaryScenes[n]) continue;
      const std::vector<AccuracyPoint> points = at_60_hz(result.points);
      std::vector<std::string> peers;
      for (const AccuracyPoint& p : points)
        if (p.engine != "Sinew" && std::find(peers.begin(), peers.end(), p.engine) == peers.end())
          peers.push_back(p.engine);
      for (const double error : kSummaryErrors) {
        SummaryRow& row = rows.emplace_back();
        row.scene = kSummaryScenes[n];
        row.title = kNames[n][0];
        row.who = kNames[n][1];
        row.error = error;
        if (const AccuracyPoint* best = cheapest(points, "Sinew", error)) row.ours = *best;
        for (const std::string& peer : peers)
          if (const AccuracyPoint* best = cheapest(points, peer, error)) row.peers.push_back(*best);
      }
    }
  return rows;
}

std::vector<std::string> summary_sentences(const std::vector<SummaryRow>& rows,
                                           const std::vector<CrowdCost>& crowds) {
  std::vector<std::string> sentences;
  for (std::size_t n = 0; n + 1 < rows.size(); n += 2) {
    std::string sentence = price_sentence(rows[n], rows[n + 1]) + ".";
    if (n == 0)
      sentence = "At 60 frames a second, " + sentence;
    else
      sentence[0] = static_cast<char>(std::toupper(sentence[0]));
    sentences.push_back(sentence);
  }
  for (const CrowdCost& c : crowds)
    if (c.name == "walkers_hit")
      sentences.push_back(c.title + ": " + duration(c.us.mean) + " a frame, at worst " +
                          duration(c.us.worst) + " (" + number(c.solved) + " of them are solved at a time).");
  return sentences;
}

}  // namespace sinew::study
