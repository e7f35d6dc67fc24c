// Values over time, as scene files list them.
#pragma once

#include <utility>
#include <vector>

namespace sinew::scene {

template <class Value>
using Timeline = std::vector<std::pair<double, Value>>;  ///< (time, value), times rising

constexpr double kNow = 1e-9;  ///< s: sums of steps are rounded

/// The last value that has come by t, or `otherwise`.
template <class Value>
Value value_at(const Timeline<Value>& line, double t, Value otherwise) {
  for (const auto& [time, value] : line)
    if (time <= t + 1e-9) otherwise = value;
  return otherwise;
}

/// Values joined by straight lines. Where a time stands twice, the second counts from then on. Not of an
/// empty line.
template <class Value>
Value ramp_at(const Timeline<Value>& line, double t) {
  if (t < line.front().first) return line.front().second;
  for (std::size_t i = 1; i < line.size(); ++i)
    if (t < line[i].first - kNow) {
      const double u = (t - line[i - 1].first) / (line[i].first - line[i - 1].first);
      return line[i - 1].second + u * (line[i].second - line[i - 1].second);
    }
  return line.back().second;
}

/// Change per second of ramp_at from t on.
template <class Value>
Value slope_at(const Timeline<Value>& line, double t) {
  for (std::size_t i = 1; i < line.size(); ++i)
    if (t >= line[i - 1].first - 1e-9 && t < line[i].first - 1e-9)
      return (line[i].second - line[i - 1].second) / (line[i].first - line[i - 1].first);
  return line.front().second - line.front().second;
}

/// Integral of ramp_at from 0 to t; of a jump at t what comes before it.
inline double integral_at(const Timeline<double>& line, double t) {
  double sum = 0, from = 0;
  for (const auto& [time, value] : line) {
    if (time - kNow > t) break;
    sum += (time - from) * (ramp_at(line, from) + value) / 2;
    from = time;
  }
  return sum + (t - from) * (ramp_at(line, from) + ramp_at(line, t)) / 2;
}

}  // namespace sinew::scene
