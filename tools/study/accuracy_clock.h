// Processor time, and whether the machine was quiet enough to believe it.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace sinew::study {

/// s, that the calling thread has spent on a processor: others' work and waiting do not count.
double processor_seconds();
/// s, that asking for it takes: of each measured interval so much is the clock's own.
double clock_cost();

/// Both in seconds since some moment. A test brings its own.
struct Clocks {
  std::function<double()> processor = processor_seconds;
  std::function<double()> wall;  ///< empty: the system's
};

/// A fixed piece of work, run before, during and after a study. On a quiet machine it takes as long every
/// time, and no longer than it computes.
class MachineCheck {
 public:
  /// `work` empty: a few milliseconds of arithmetic on a table that fits into the second cache.
  explicit MachineCheck(Clocks clocks = {}, std::function<void()> work = {});
  /// Runs the work a few times. Costs about 0.1 s.
  void run();
  /// Two runs disagree by more than kDisagreement, or one was made to wait for more than kWaiting of its
  /// time.
  bool busy() const { return !reason().empty(); }
  /// In words, or empty.
  std::string reason() const;

  static constexpr double kDisagreement = 0.05;  ///< of the shortest: quiet runs differ by 1 to 2 %
  static constexpr double kWaiting = 0.1;  ///< of the processor time: a core to itself waits for nothing

 private:
  Clocks clocks_;
  std::function<void()> work_;
  std::vector<double> processor_, waited_;  ///< [run] s, median; share
};

}  // namespace sinew::study
