#include "study/scenes/situation.h"

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace sinew::study {

Played::Played(const scene::Scene& scene) {
  if (const convert::Error error = scene::run_scene(scene, recording, telemetry, nullptr))
    refused = error.message;
}

Criterion& Findings::find(const char* name, double bound, double start) {
  const auto known =
      std::find_if(criteria_.begin(), criteria_.end(), [&](const Criterion& c) { return c.name == name; });
  if (known != criteria_.end()) return *known;
  criteria_.push_back({name, start, bound, true});
  return criteria_.back();
}

void Findings::at_most(const char* name, double value, double bound) {
  Criterion& c = find(name, bound, value);
  if (!(value <= c.value)) c.value = value;
  c.passed = c.passed && value <= bound;
}

void Findings::at_least(const char* name, double value, double bound) {
  Criterion& c = find(name, bound, value);
  if (!(value >= c.value)) c.value = value;
  c.passed = c.passed && value >= bound;
}

void Findings::note(const char* name, double value) {
  double& most = notes_.try_emplace(name, value).first->second;
  most = std::max(most, value);
}

void Findings::sound(const Played& played, double depth, int skipped) {
  if (!played.refused.empty()) return refuse(played.refused);
  const Judge judge = played.judge();
  double gap = 0, deepest = 0;
  for (int f = 0; f < judge.frames(); ++f) {
    if (!judge.finite(f)) return refuse("a pose of frame " + std::to_string(f) + " is not finite");
    gap = std::max(gap, judge.joint_gap(f));
    for (int m = 0; m < judge.members(); ++m)
      if (m != skipped) deepest = std::max(deepest, judge.depth_in_surroundings(f, m));
  }
  at_most("joints stand open (m)", gap, 1e-3);
  at_most("deepest in floor and obstacles (m)", deepest, depth);
}

bool Findings::passed() const {
  return refused_.empty() && !criteria_.empty() &&
         std::all_of(criteria_.begin(), criteria_.end(), [](const Criterion& c) { return c.passed; });
}

std::string situation_file(const Situation& situation) {
  return std::string(SINEW_ASSETS_DIR "/scenes/") + situation.folder + "/" + situation.name + ".json";
}

SituationResult run_situation(const Situation& situation, bool quick) {
  SituationResult result{situation, {}, 0, known_to_fail(situation.name) != nullptr};
  const auto begin = std::chrono::steady_clock::now();
  scene::Scene scene;
  if (const convert::Error error = scene::load_scene(situation_file(situation), scene))
    result.findings.refuse(error.message);
  else
    situation.judge(scene, quick, result.findings);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

std::string situation_table(const SituationResult& result) {
  std::string text;
  char line[300];
  const bool passed = result.findings.passed();
  std::snprintf(line, sizeof line, "%-21s %-6s %s\n", result.situation.name,
                passed         ? "pass"
                : result.known ? "known"
                               : "FAIL",
                result.situation.about);
  text += line;
  if (!result.findings.refused().empty()) text += "    " + result.findings.refused() + "\n";
  for (const Criterion& c : result.findings.criteria()) {
    std::snprintf(line, sizeof line, "    %-4s %-48s %10.4g   bound %.4g\n", c.passed ? "" : "FAIL",
                  c.name.c_str(), c.value, c.bound);
    text += line;
  }
  for (const auto& [name, value] : result.findings.notes()) {
    std::snprintf(line, sizeof line, "         %-48s %10.4g\n", name.c_str(), value);
    text += line;
  }
  if (!passed && result.known) text += std::string("    ") + known_to_fail(result.situation.name) + "\n";
  return text;
}

nlohmann::json situations_json(const std::vector<SituationResult>& results) {
  nlohmann::json scenes = nlohmann::json::array();
  int passed = 0;
  for (const SituationResult& r : results) {
    nlohmann::json criteria = nlohmann::json::array();
    for (const Criterion& c : r.findings.criteria())
      criteria.push_back({{"name", c.name}, {"value", c.value}, {"bound", c.bound}, {"passed", c.passed}});
    scenes.push_back({{"name", r.situation.name},
                      {"about", r.situation.about},
                      {"passed", r.findings.passed()},
                      {"known", r.known},
                      {"reason", r.findings.refused()},
                      {"criteria", criteria},
                      {"notes", r.findings.notes()}});
    passed += r.findings.passed();
  }
  return {{"scenes", scenes}, {"passed", passed}, {"failed", int(results.size()) - passed}};
}

}  // namespace sinew::study
