// When Newton's iteration has converged: one rule for every implicit method here, so that none is favoured.
//
// Source: Shampine & Reichelt, "The MATLAB ODE Suite", section 2.3: the rate of contraction is kept as long
// as the iteration matrix, the error that is left after a correction d is |d|·rate/(1 − rate), and an
// iteration that cannot arrive in time is given up. Only DASSL under its own name judges as its authors
// published, and its strict variant forgets the rate with every step (dassl.cpp).
#pragma once

#include <algorithm>
#include <cmath>

namespace sinew::multibody {

class NewtonConvergence {
 public:
  enum class Answer { kConverged, kGoOn, kGiveUp };

  /// `enough`: error left in units of the tolerance; `at_most`: iterations.
  constexpr NewtonConvergence(double enough, int at_most) : enough_(enough), at_most_(at_most) {}

  int at_most() const { return at_most_; }
  /// The iteration matrix is another one: what was known of the rate does not count.
  void forget_rate() { rate_ = 0; }
  /// A new iteration begins, with the matrix as it is.
  void begin() { done_ = 0; }

  /// `size` of a correction in units of the tolerance; at or below `negligible` it is rounding.
  Answer judge(double size, double negligible) {
    if (!std::isfinite(size)) return Answer::kGiveUp;
    if (size <= negligible) return Answer::kConverged;
    const int iteration = done_++;
    if (iteration == 0) {
      before_ = size;
      // With a rate of earlier steps the first correction must promise ten times as much.
      return rate_ > 0 && left(size) <= 0.1 * enough_ ? Answer::kConverged : Answer::kGoOn;
    }
    const double rate = size / before_;
    before_ = size;
    if (rate >= kTooSlow) return Answer::kGiveUp;
    rate_ = std::max(kFading * rate_, rate);
    if (left(size) <= enough_) return Answer::kConverged;
    const bool late = left(size) * std::pow(rate_, at_most_ - 1 - iteration) > enough_;
    return late || done_ >= at_most_ ? Answer::kGiveUp : Answer::kGoOn;
  }

 private:
  static constexpr double kTooSlow = 0.9;  ///< rate from which the iteration is taken to diverge
  static constexpr double kFading = 0.9;   ///< of an old rate, per iteration

  double left(double size) const { return size * rate_ / (1 - rate_); }

  double enough_, rate_ = 0, before_ = 0;
  int at_most_, done_ = 0;
};

}  // namespace sinew::multibody
