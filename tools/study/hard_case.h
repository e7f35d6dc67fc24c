// A hard case: set-up, pass criterion, and what is measured while it runs.
#pragma once

#include <string>
#include <vector>

#include "study/stage.h"

namespace sinew::study {

/// One run of a case.
struct Trial {
  double h = 1.0 / 60;  ///< in place of the scene's frame rate
  bool quick = false;   ///< shortened, for the test suite
  scene::Scene scene;  ///< as its file says; a case may change a copy, to repeat it with another seed or mass
  /// Length of a run, s: the catalogue's, or a shorter one in quick trials.
  double lasting(double full, double shortened) const { return quick ? shortened : full; }
};

/// Collects the requirements of a case; the first that fails is the reason reported.
class Verdict {
 public:
  explicit Verdict(const Measurement& measured) : measured_(measured) {}

  /// `what` names the quantity, the figure reached and the bound.
  void require(bool holds, const std::string& what) {
    if (!holds && reason_.empty()) reason_ = what;
  }
  void at_most(const char* what, double value, double bound);
  void at_least(const char* what, double value, double bound);
  /// Not refused, finite, joints closed (by the recorded poses), at most 0.1 % of the steps unconverged.
  void sound();
  /// The catalogue's conditions G: sound, and no energy without work, after any step nor for its way (1e-3 of
  /// the largest kinetic energy met). Only where nothing is driven: the work of muscles and driven bodies is
  /// booked to first order in h.
  void general();

  /// A line for people, below the case's.
  void note(const std::string& text) { notes_.push_back(text); }

  bool passed() const { return reason_.empty(); }
  const std::string& reason() const { return reason_; }
  const std::vector<std::string>& notes() const { return notes_; }
  const Measurement& measured() const { return measured_; }

 private:
  Measurement measured_;
  std::string reason_;
  std::vector<std::string> notes_;
};

/// The catalogue's condition on what solving a step of any case may cost: at most 8 passes in 99 of 100
/// solves, 16 in any. In words what exceeds that, or empty.
std::string excess_of(const Measurement& measured);

using Run = Verdict (*)(const Trial&);

struct HardCase {
  const char* name;
  const char* row;        ///< of the catalogue (research/hard-cases-and-solvers.md section 2), or "figure"
  const char* source;     ///< who documented the failure
  const char* criterion;  ///< beside the general conditions
  std::vector<double> steps;  ///< h, s
  Run in_float = nullptr;     ///< null with in_double: the runtime cannot do this yet
  Run in_double = nullptr;
  const char* unsupported = "";  ///< what is missing
  /// Its set-up, assets/scenes/hard_cases/NAME.json; as the case is called where null, none where
  /// why_without_scene says so.
  const char* scene = nullptr;
};

/// What has no scene file, and why; nullptr for all others. The one list: scene_files.cpp.
const char* why_without_scene(const std::string& case_name);
/// Path of a case's scene file; "" where it has none.
std::string scene_file(const HardCase& hard_case);
/// A line for people: the file, or why there is none.
std::string set_up_of(const HardCase& hard_case);

/// The catalogue, in its order.
std::vector<HardCase> hard_cases();

std::vector<HardCase> rotation_cases();
std::vector<HardCase> mass_cases();
std::vector<HardCase> loop_cases();
std::vector<HardCase> contact_cases();
std::vector<HardCase> pile_cases();
std::vector<HardCase> muscle_cases();
std::vector<HardCase> actuation_cases();
std::vector<HardCase> input_cases();
std::vector<HardCase> general_cases();

/// Why a case is known to fail today, or nullptr; of some that pass in quick trials, at full length. The one
/// list: known_failures.cpp.
const char* known_failure(const std::string& case_name, bool quick = true);
/// Why a case's steps are known to cost more than they may (excess_of), or nullptr.
const char* known_excess(const std::string& case_name, bool quick = true);

}  // namespace sinew::study
