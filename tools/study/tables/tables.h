// `sinew study tables`: Tables I–VI of the paper, measured on this machine, and its conclusions checked
// against them.
#pragma once

#include <functional>

#include "study/tables/chains.h"
#include "study/tables/measure.h"

namespace sinew::study {

struct TablesOptions {
  std::string mechanisms;   ///< directory of the mechanism files; "": assets/mechanisms
  double tolerance = 1e-5;  ///< the paper's
  bool quick = false;       ///< fewer repeats and tolerances
};

/// Time of one evaluation (Tables I and III).
struct EvaluationTime {
  std::string mechanism, formulation;
  double microseconds = 0;
};

/// A run beside Sinew's quickest run of at most the same true error (Tables V and VI).
struct Comparison {
  Measurement peer, ours;
  /// How many times quicker; 0 when no run of ours was as accurate.
  double factor() const { return ours.method.empty() ? 0 : peer.milliseconds / ours.milliseconds; }
};

struct Conclusion {
  enum class Verdict { kHolds, kDoesNot, kNotMeasured };
  std::string claim;  ///< of the paper
  Verdict verdict = Verdict::kNotMeasured;
  std::string evidence;  ///< in a sentence, with the figures
};

struct TablesResult {
  std::vector<std::string> open, closed;    ///< mechanisms of Tables I, II and III, IV
  std::vector<EvaluationTime> evaluations;  ///< I and III
  std::vector<Measurement> simulations;     ///< II and IV
  std::vector<Comparison> comparisons;      ///< V and VI
  /// DE at `tolerance` on each non-stiff mechanism, and the quickest implicit run within its error.
  std::vector<Comparison> explicit_or_implicit;
  std::vector<ChainPoint> chains;
  std::vector<Conclusion> conclusions;
  double tolerance = 0;
  bool peers = false;  ///< built with SINEW_PEERS
};

/// "" or what is wrong. `progress(done, total)` may be empty.
std::string run_tables(const TablesOptions& options, const std::function<void(int, int)>& progress,
                       TablesResult& out);

/// Checks what the paper concludes against the measurements.
std::vector<Conclusion> conclusions_of(const TablesResult& result);

/// Quickest accurate-enough simulation of a mechanism; nullptr when there is none.
const Measurement* best_simulation(const TablesResult& result, const std::string& mechanism);
const Measurement* find(const TablesResult& result, const std::string& mechanism, const std::string& method);
double evaluation(const TablesResult& result, const std::string& mechanism, const std::string& formulation);

/// The six tables, the work of chains and the conclusions; bold text stands between `bold` and `plain`.
std::string tables_text(const TablesResult& result, const std::string& bold, const std::string& plain);
std::string tables_csv(const TablesResult& result);
nlohmann::json tables_json(const TablesResult& result);

}  // namespace sinew::study
