// Ordinary situations of a game, each a scene file of assets/scenes/situations, judged from recorded poses
// alone. `sinew study scenes` runs them; a bound stays where it was set when the situation was thought of.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scene/run.h"
#include "study/scenes/judge.h"

namespace sinew::study {

struct Criterion {
  std::string name;  ///< with its unit
  double value = 0, bound = 0;
  bool passed = false;
};

/// A run of a scene, as its judges see it. Keeps its address: the judge looks at the recording beside it.
struct Played {
  scene::Recording recording;
  scene::Telemetry telemetry;
  std::string refused;

  explicit Played(const scene::Scene& scene);
  Played(const Played&) = delete;
  Played& operator=(const Played&) = delete;

  Judge judge() const { return Judge(recording); }
};

/// Collects the criteria of a situation: over its runs, the worst counts.
class Findings {
 public:
  void at_most(const char* name, double value, double bound);
  void at_least(const char* name, double value, double bound);
  /// What no bound is set for, such as a time: the largest over all runs.
  void note(const char* name, double value);
  /// A scene that cannot be read or stepped.
  void refuse(const std::string& reason) { refused_ = reason; }

  /// Finite, joints closed to 1 mm; `depth` m: most that anything may lie in floor and obstacles in any
  /// frame. What is driven goes where it is driven: `skipped` is left out. Bodies in each other: see
  /// depth_between().
  void sound(const Played& played, double depth, int skipped = -1);

  const std::vector<Criterion>& criteria() const { return criteria_; }
  const std::map<std::string, double>& notes() const { return notes_; }
  const std::string& refused() const { return refused_; }
  bool passed() const;

 private:
  Criterion& find(const char* name, double bound, double start);

  std::vector<Criterion> criteria_;
  std::map<std::string, double> notes_;
  std::string refused_;
};

struct Situation {
  const char* name;   ///< assets/scenes/FOLDER/NAME.json
  const char* about;  ///< what is asked, in one line
  void (*judge)(const scene::Scene& scene, bool quick, Findings& findings);
  const char* folder = "situations";
};

/// In the order in which they are printed.
std::vector<Situation> situations();

struct SituationResult {
  Situation situation;
  Findings findings;
  double seconds = 0;  ///< that it took
  bool known = false;  ///< to fail today: known_to_fail()
};

/// Why a situation fails today, or nullptr. The one list.
const char* known_to_fail(const std::string& situation);

/// Path of a situation's scene file.
std::string situation_file(const Situation& situation);

SituationResult run_situation(const Situation& situation, bool quick);

std::string situation_table(const SituationResult& result);
/// {"scenes": [{"name", "about", "passed", "known", "criteria": [{"name", "value", "bound", "passed"}],
/// "notes": {name: value}}], "passed", "failed"}
nlohmann::json situations_json(const std::vector<SituationResult>& results);

}  // namespace sinew::study
