// `sinew study tables`: Tables I–VI of the paper, measured on this machine, and its conclusions checked
// against them.
#pragma once

#include <functional>

#include "study/tables/chains.h"
#include "study/tables/measure.h"

namespace sinew::study {

struct TablesOptions {
  std::string mechanisms;              ///< directory of the mechanism files; "": assets/mechanisms
  double tolerance = 1e-5;             ///< the paper's
  bool quick = false;                  ///< fewer mechanisms, repeats and tolerances
  std::vector<std::string> only = {};  ///< mechanisms; none: all that the study knows
  bool recount = false;                ///< count again what an earlier run of the same build has counted
};

/// A mechanism of the tables.
struct StudiedMechanism {
  std::string name;
  int coordinates = 0, loop_equations = 0, bodies = 0;
  bool stiff = false;
  bool closed() const { return loop_equations > 0; }
};

/// Cost of one evaluation (Tables I and III).
struct EvaluationCost {
  std::string mechanism, formulation;
  double microseconds = 0;
  double instructions = 0;  ///< counted; 0: not counted
};

/// A run beside Sinew's quickest run of at most the same true error (Tables V and VI).
struct Comparison {
  SimulationRun peer, ours;
  /// How many times quicker; 0 when no run of ours was as accurate.
  double factor() const { return ours.method.empty() ? 0 : peer.milliseconds / ours.milliseconds; }
};

/// What one mechanism says about a claim.
struct Evidence {
  std::string about;  ///< the mechanism
  bool holds = false;
  std::string figures;  ///< "1.9 and 2.1"
};

/// A conclusion of the paper, judged.
struct Conclusion {
  std::string place;  ///< "section 5, no. 6"
  std::string claim;
  std::string figures_are;         ///< what the figures of the evidence mean
  std::vector<Evidence> evidence;  ///< none: not measured
  std::string note;                ///< where it does not hold: what was tried; or why it was not measured
};

struct TablesResult {
  std::vector<StudiedMechanism> mechanisms;
  std::vector<EvaluationCost> evaluations;  ///< I and III
  std::vector<SimulationRun> simulations;   ///< II and IV: at `tolerance`
  std::vector<SimulationRun> curves;        ///< the same rows at other tolerances too, for equal errors
  std::vector<Comparison> comparisons;      ///< V and VI
  std::vector<ChainPoint> chains;
  std::vector<Conclusion> conclusions;
  double tolerance = 0;
  bool peers = false;    ///< built with SINEW_PEERS
  bool counted = false;  ///< instructions were counted: without valgrind nothing is judged

  std::vector<std::string> names(bool closed) const;
};

/// "" or what is wrong. `progress(done, total)` may be empty.
std::string run_tables(const TablesOptions& options, const std::function<void(int, int)>& progress,
                       TablesResult& out);

/// Checks what the paper concludes against what was counted.
std::vector<Conclusion> conclusions_of(const TablesResult& result);

/// "holds", "holds on 4 of 6", "does not hold", "not measured".
std::string verdict(const Conclusion& conclusion);

/// Cheapest simulation of a mechanism by instructions, or by time where they were not counted; nullptr when
/// there is none.
const SimulationRun* best_simulation(const TablesResult& result, const std::string& mechanism);
const SimulationRun* find(const TablesResult& result, const std::string& mechanism,
                          const std::string& method);
const EvaluationCost* evaluation(const TablesResult& result, const std::string& mechanism,
                                 const std::string& formulation);

/// The six tables, the work of chains and the conclusions; bold text stands between `bold` and `plain`.
std::string tables_text(const TablesResult& result, const std::string& bold, const std::string& plain);
std::string tables_csv(const TablesResult& result);
nlohmann::json tables_json(const TablesResult& result);

}  // namespace sinew::study
