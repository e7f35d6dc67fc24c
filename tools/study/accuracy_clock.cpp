#include "study/accuracy_clock.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ctime>

namespace sinew::study {
namespace {

double read(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

double wall_seconds() {
  return read(CLOCK_MONOTONIC);
}

/// Multiplications that wait for each other, on numbers that are fetched from all over a table.
void fixed_work() {
  constexpr unsigned kSize = 1u << 15;  // 256 kB of doubles
  constexpr int kTimes = 1'500'000;     // about 8 ms
  static std::array<double, kSize> table{};
  double sum = 1;
  unsigned at = 1;
  for (int n = 0; n < kTimes; ++n) {
    at = (1664525u * at + 1013904223u) % kSize;
    sum = 0.5 * sum + table[at] + 1;
    table[at] = 1e-3 * sum;
  }
  volatile double result = sum;
  (void)result;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

}  // namespace

double processor_seconds() {
  return read(CLOCK_THREAD_CPUTIME_ID);
}

double clock_cost() {
  static const double cost = [] {
    std::vector<double> intervals;
    for (int n = 0; n < 1001; ++n) {
      const double begin = processor_seconds();
      intervals.push_back(processor_seconds() - begin);
    }
    return median(intervals);
  }();
  return cost;
}

MachineCheck::MachineCheck(Clocks clocks, std::function<void()> work)
    : clocks_(std::move(clocks)), work_(std::move(work)) {
  if (!clocks_.wall) clocks_.wall = wall_seconds;
  if (!work_) work_ = fixed_work;
}

void MachineCheck::run() {
  constexpr int kRepetitions = 11;
  std::vector<double> times;
  double all = 0;
  work_();  // fetches its table
  const double wall = clocks_.wall();
  for (int n = 0; n < kRepetitions; ++n) {
    const double begin = clocks_.processor();
    work_();
    times.push_back(clocks_.processor() - begin);
    all += times.back();
  }
  waited_.push_back((clocks_.wall() - wall) / all - 1);
  processor_.push_back(median(times));
}

std::string MachineCheck::reason() const {
  if (processor_.empty()) return {};
  const auto [least, most] = std::minmax_element(processor_.begin(), processor_.end());
  const double waited = *std::max_element(waited_.begin(), waited_.end());
  if (waited > kWaiting)
    return fmt::format(
        "other programs kept the processor from this one for {:.0f} % of the time in which a fixed piece of "
        "work ran",
        100 * waited / (1 + waited));
  if (*most > (1 + kDisagreement) * *least)
    return fmt::format("a fixed piece of work took {:.1f} ms once and {:.1f} ms another time", 1e3 * *least,
                       1e3 * *most);
  return {};
}

}  // namespace sinew::study
