#include "cli/study.h"

#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "cli/files.h"
#include "cli/terminal.h"
#include "study/accuracy.h"
#include "study/accuracy_dial.h"
#include "study/behaviour/behaviour_study.h"
#include "study/effects.h"
#include "study/ensembles.h"
#include "study/maps.h"
#include "study/scenes/situation.h"
#include "study/study.h"
#include "study/talk/talk.h"
#include "study/words.h"

namespace sinew::cli {
namespace {

convert::Error make_directory(const std::string& directory) {
  std::error_code failed;
  std::filesystem::create_directories(directory, failed);
  if (failed) return {directory + ": cannot be made: " + failed.message()};
  return {};
}

void print_accuracy(const study::AccuracyResult& result) {
  say("%s\n", result.scene.title.c_str());
  for (const study::Slope& s : result.slopes) {
    say("  order of %s %s: ", s.engine.c_str(), s.option.c_str());
    if (s.found == 0) say("none, all errors are below %s", study::length(study::kExact).c_str());
    if (s.found != 0) say("%.2f", s.found);
    if (s.expected > 0) say(" (theory %.0f)", s.expected);
    say("\n");
  }
  for (const study::AccuracyPoint& p : result.points)
    if (p.pareto) {
      say("  front: %s, %s off: %s", study::duration(p.us).c_str(), study::length(p.error).c_str(),
          p.label().c_str());
      if (p.h > 0) say(" 1/%.0f s", 1 / p.h);
      say(", tolerance %s, substeps %d, cap %d\n", study::length(p.accuracy.tolerance).c_str(),
          p.accuracy.substeps, p.accuracy.max_iterations);
    }
}

/// Both failure maps as CSV, SVG and PNG into a directory.
convert::Error draw_maps(const std::string& directory, bool quick) {
  const auto draw = [&](const study::FailureMap& map, const std::string& name) {
    const std::string file = directory + "/" + name;
    if (convert::Error error = write_atomically(file + ".csv", study::map_csv(map))) return error;
    if (convert::Error error = study::draw_map(map, file + ".svg")) return error;
    return study::draw_map(map, file + ".png");
  };
  if (convert::Error error =
          draw(study::map_of_speeds(quick, progress_line("joint speeds")), "failure_map_speed"))
    return error;
  return draw(study::map_of_masses(quick, progress_line("mass ratios")), "failure_map_mass");
}

/// The maps of a directory, for the report.
std::vector<study::ReportPicture> drawn_maps(const std::string& directory) {
  const auto read = [&](const char* name) {
    std::ifstream in(directory + "/" + name);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  return {{"How long a step free motion bears",
           "A second of flight of the figure of 37 degrees of freedom, by its joints' speed. Rows are steps; "
           "a cell is "
           "the worst of its runs.",
           read("failure_map_speed.svg")},
          {"How long a step a heavy tip bears",
           "A chain of five links let go, by the mass of the last over the first.",
           read("failure_map_mass.svg")}};
}

}  // namespace

convert::Error StabilityCommand::run() const {
  if (convert::Error error = make_directory(directory)) return error;
  if (!json_output) say("%s", study::stability_table_head().c_str());
  const auto print = [&](const study::StabilityResult& result) {
    if (json_output) return;
    say("%s", study::stability_table(result).c_str());
    if (!only.empty()) say("%s\n", study::set_up_of(result.hard_case).c_str());
    std::fflush(stdout);
  };
  const auto results =
      study::run_stability({quick, only}, json_output ? progress_line("stability") : nullptr, print);
  if (results.empty()) return {"there is no hard case '" + only + "'"};
  const nlohmann::json summary = study::stability_json(results);
  if (convert::Error error = write_atomically(directory + "/stability.csv", study::stability_csv(results)))
    return error;
  if (only.empty() && !json_output)
    if (convert::Error error = draw_maps(directory, quick)) return error;
  if (json_output)
    std::puts(json_text(summary).c_str());
  else
    say("%d cases passed, %d failed; %s/stability.csv\n", summary["passed"].get<int>(),
        summary["failed"].get<int>(), directory.c_str());
  return {};
}

convert::Error AccuracyCommand::run_ensembles() const {
  const std::vector<study::Ensemble> all = study::run_ensembles(quick, progress_line("ensembles"));
  const nlohmann::json json = study::ensembles_json(all);
  if (convert::Error error = write_atomically(directory + "/ensembles.json", json.dump() + "\n"))
    return error;
  for (const study::EnsembleScene& scene : study::ensemble_scenes())
    for (const int hz : {60, 30})
      for (const char* ending : {".svg", ".png"}) {
        const std::string file = directory + "/ensemble_" + scene.name + "_" + std::to_string(hz) + ending;
        if (convert::Error error = study::draw_ensembles(all, scene, hz, file)) return error;
      }
  if (json_output)
    std::puts(json_text(json).c_str());
  else
    say("%s%s/ensembles.json\n", study::ensembles_table(all).c_str(), directory.c_str());
  return {};
}

/// What is measured when no scene is asked for: presets, crowds, falls, maps.
convert::Error AccuracyCommand::run_all(study::AccuracyReport& report, study::MachineCheck& machine) const {
  const auto front = study::dial_front(study::measure_dial(quick, progress_line("presets")));
  machine.run();
  char date[32];
  const std::time_t now = std::time(nullptr);
  std::strftime(date, sizeof date, "%Y-%m-%d", std::gmtime(&now));
  report.dial = study::dial_json(front, study::machine(), date);
  report.crowds = study::measure_crowds(quick, progress_line("crowds"));
  machine.run();
  constexpr int kFalls = 32;  // for a quick look: their means are certain to a twentieth or so
  report.falls = study::run_ensembles(quick, progress_line("falls"), quick ? kFalls : 0);
  if (convert::Error error = draw_maps(directory, quick)) return error;
  report.pictures = drawn_maps(directory);
  return {};
}

convert::Error AccuracyCommand::write(const study::AccuracyReport& report) const {
  const std::string base = directory + "/accuracy";
  if (convert::Error error = write_atomically(base + ".csv", study::accuracy_csv(report.results)))
    return error;
  if (convert::Error error = write_atomically(base + ".html", study::accuracy_html(report))) return error;
  for (const study::AccuracyResult& result : report.results)
    for (const char* ending : {".svg", ".png"})
      if (convert::Error error = study::draw_accuracy(result, base + "_" + result.scene.name + ending))
        return error;
  if (json_output) {
    std::puts(json_text(study::accuracy_json(report)).c_str());
    return {};
  }
  for (const study::AccuracyResult& result : report.results) print_accuracy(result);
  say("\n");
  for (const std::string& sentence :
       study::summary_sentences(study::summary_rows(report.results), report.crowds))
    say("%s\n", sentence.c_str());
  say("%s.html\n", base.c_str());
  return {};
}

convert::Error AccuracyCommand::run() {
  if (convert::Error error = make_directory(directory)) return error;
  if (ensembles) return run_ensembles();
  const std::string store = directory + "/accuracy_points.jsonl";
  study::MachineCheck machine;
  machine.run();
  study::AccuracyReport report;
  report.results = study::run_accuracy({quick, only, store}, progress_line("accuracy"));
  if (report.results.empty()) return {"there is no accuracy scene '" + only + "'"};
  machine.run();
  if (only.empty())
    if (convert::Error error = run_all(report, machine)) return error;
  report.busy = machine.reason();
  if (convert::Error error = write(report)) return error;
  if (machine.busy()) {
    std::error_code ignored;
    std::filesystem::remove(store, ignored);  // its times are no better
  }
  if (!only.empty()) {
    if (machine.busy()) say_error("times are not to be relied on: " + report.busy);
    return {};
  }
  const convert::Error error = study::store_presets(
      report.dial, directory, machine,
      [](const std::string& path, const std::string& text) { return write_atomically(path, text); });
  if (error && machine.busy()) exit_code = kBusy;
  return error;
}

convert::Error ScenesCommand::run() const {
  if (convert::Error error = make_directory(directory)) return error;
  std::vector<study::Situation> asked = talk ? study::talk_scenes() : study::situations();
  if (!only.empty()) std::erase_if(asked, [&](const study::Situation& s) { return s.name != only; });
  if (asked.empty()) return {"there is no scene '" + only + "'"};
  std::vector<study::SituationResult> results;
  const auto progress = progress_line("scenes");
  for (const study::Situation& situation : asked) {
    results.push_back(study::run_situation(situation, quick));
    if (json_output)
      progress(static_cast<int>(results.size()), static_cast<int>(asked.size()));
    else
      say("%s", study::situation_table(results.back()).c_str());
    std::fflush(stdout);
  }
  const nlohmann::json summary = study::situations_json(results);
  const std::string file = directory + (talk ? "/talk.json" : "/scenes.json");
  if (convert::Error error = write_atomically(file, summary.dump(1) + "\n")) return error;
  if (json_output)
    std::puts(json_text(summary).c_str());
  else
    say("%d scenes passed, %d failed; %s\n", summary["passed"].get<int>(), summary["failed"].get<int>(),
        file.c_str());
  return {};
}

convert::Error BehaviourCommand::run() const {
  if (convert::Error error = make_directory(directory)) return error;
  study::BehaviourPlan plan = quick ? study::BehaviourPlan::quick() : study::BehaviourPlan::full();
  for (study::PushSweep& sweep : plan.sweeps) {
    if (directions > 0) sweep.directions = directions;
    if (seeds > 0) sweep.seeds = seeds;
  }
  study::BehaviourResult result;
  if (convert::Error error = study::run_behaviour(plan, progress_line("pushes"), result)) return error;
  const std::string summary = study::behaviour_json(result).dump();
  if (convert::Error error = write_atomically(directory + "/behaviour.json", summary + "\n")) return error;
  for (const char* ending : {".svg", ".png"})
    if (convert::Error error = study::draw_push_maps(result.maps, directory + "/push_map" + ending))
      return error;
  if (json_output)
    std::puts(summary.c_str());
  else
    std::printf("%s%s/push_map.png\n", study::behaviour_table(result).c_str(), directory.c_str());
  return {};
}

convert::Error EffectsCommand::run() const {
  if (convert::Error error = make_directory(directory)) return error;
  std::error_code unknown;
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
  const std::string program = (here / "sinew-effect-cost").string();
  if (!std::filesystem::exists(program, unknown))
    return {program + ": the counting program does not stand beside sinew"};
  study::EffectStudy found;
  if (convert::Error error = study::run_effects({program, directory, quick}, progress_line("effects"), found))
    return error;
  const std::string base = directory + "/effects";
  if (convert::Error error = write_atomically(base + ".csv", study::effects_csv(found))) return error;
  for (const char* ending : {".svg", ".png"})
    if (convert::Error error = study::draw_effects(found, base + ending)) return error;
  if (json_output)
    std::puts(json_text(study::effects_json(found)).c_str());
  else
    say("%s\n%s.png\n", study::effects_table(found).c_str(), base.c_str());
  return {};
}

}  // namespace sinew::cli
