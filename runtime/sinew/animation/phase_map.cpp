#include "sinew/animation/phase_map.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "sinew/animation/bspline.h"

namespace sinew {
namespace {

constexpr int kControls = PhaseMap::kControls;
constexpr int kMostMarkers = 8;
constexpr double kSlowest = 0.1;  ///< of the mean rate of time by phase

/// A phase among the controls of maps of so many cycles: the first control that counts, and their weights.
struct LagPlace {
  int cycles, first;
  BsplineBasis<double> weights;
  LagPlace(double phase, int of_cycles) : cycles(of_cycles) {
    const double knots = phase * kControls / cycles, whole = std::floor(knots);
    first = static_cast<int>(whole - std::floor(whole / kControls) * kControls) % kControls;
    weights = BsplineBasis<double>::at(3, knots - whole);
  }
};

/// Clip time at a phase, with its derivatives by the phase.
TimeJet<double> time_at(const PhaseMap& map, double phase, const LagPlace& place) {
  const double knots = double(kControls) / map.cycles, mean = double(map.duration) / map.cycles;
  TimeJet<double> sum(0.0);
  for (int t = 0; t < 4; ++t) {
    const double control = map.lag[std::size_t((place.first + t) % kControls)];
    sum.value += place.weights.value[t] * control;
    sum.rate += place.weights.first[t] * control;
    sum.acceleration += place.weights.second[t] * control;
  }
  return {phase * mean + sum.value, mean + knots * sum.rate, knots * knots * sum.acceleration};
}

Status check_markers(std::span<const PhaseMarker> markers, double duration, int cycles) {
  if (!(duration > 0) || !std::isfinite(duration) || cycles < 1 || cycles > 4)
    return Status::error(Code::kOutOfRange, "duration is not above 0, or cycles are not within 1 and 4");
  if (markers.empty() || markers.size() > kMostMarkers)
    return Status::error(Code::kInvalidArgument, "markers are not 1 to 8");
  for (std::size_t i = 0; i < markers.size(); ++i) {
    const int index = static_cast<int>(i);
    if (!std::isfinite(markers[i].phase) || !std::isfinite(markers[i].time))
      return Status::error(Code::kNotFinite, "marker is not finite", index);
    if (i > 0 && !(markers[i].phase > markers[i - 1].phase && markers[i].time > markers[i - 1].time))
      return Status::error(Code::kInvalidArgument, "markers are not in order", index);
  }
  if (markers.back().phase - markers.front().phase >= cycles ||
      markers.back().time - markers.front().time >= duration)
    return Status::error(Code::kInvalidArgument, "markers reach over more than the clip",
                         static_cast<int>(markers.size()) - 1);
  return {};
}

/// What the members ask of the phase at an instant; `times`: theirs, and their derivatives by the phase.
TimeJet<double> pace(std::span<const PhaseMember> members, double phase, std::span<ClipTime> times) {
  double weight = 0, weight_rate = 0, cycle = 0, by_weight = 0, by_phase = 0;
  LagPlace place(phase, members[0].map->cycles);
  for (std::size_t i = 0; i < members.size(); ++i) {
    const PhaseMember& m = members[i];
    if (m.map->cycles != place.cycles) place = LagPlace(phase, m.map->cycles);
    const TimeJet<double> time = time_at(*m.map, phase, place);
    times[i] = time;
    weight += m.weight.value;
    weight_rate += m.weight.rate;
    cycle += m.weight.value * time.rate / m.speed;
    by_weight += m.weight.rate * time.rate / m.speed;
    by_phase += m.weight.value * time.acceleration / m.speed;
  }
  const double rate = weight / cycle;
  const double change = (by_weight + by_phase * rate) / weight - cycle * weight_rate / (weight * weight);
  return {phase, rate, -rate * rate * change};
}

/// A time and its derivatives by the phase → by time, of a phase that moves.
ClipTime moving_with(const TimeJet<double>& t, const TimeJet<double>& phase) {
  return {t.value, t.rate * phase.rate,
          t.acceleration * phase.rate * phase.rate + t.rate * phase.acceleration};
}

}  // namespace

TimeJet<double> PhaseMap::by_phase(double phase) const {
  return time_at(*this, phase, LagPlace(phase, cycles));
}

ClipTime PhaseMap::at(const TimeJet<double>& phase) const {
  return moving_with(by_phase(phase.value), phase);
}

Status fit_phase_map(std::span<const PhaseMarker> markers, double duration, int cycles, PhaseMap& out) {
  if (Status status = check_markers(markers, duration, cycles); !status) return status;
  constexpr int kMost = kControls + kMostMarkers;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;
  const int size = kControls + static_cast<int>(markers.size());
  // Least sum of squared second differences under the markers' conditions, by Lagrange's multipliers.
  Matrix system = Matrix::Zero(size, size);
  Vector right = Vector::Zero(size);
  constexpr double kStencil[] = {6, -4, 1};
  for (int k = 0; k < kControls; ++k)
    for (int d = -2; d <= 2; ++d) system(k, (k + d + kControls) % kControls) = kStencil[std::abs(d)];
  for (int i = kControls; i < size; ++i) {
    const PhaseMarker& m = markers[std::size_t(i - kControls)];
    const LagPlace place(m.phase, cycles);
    for (int t = 0; t < 4; ++t) {
      const int control = (place.first + t) % kControls;
      system(i, control) = system(control, i) = place.weights.value[t];
    }
    right[i] = m.time - m.phase * duration / cycles;
  }
  const Vector solution = system.fullPivLu().solve(right);
  PhaseMap map;
  map.duration = static_cast<float>(duration);
  map.cycles = cycles;
  for (int k = 0; k < kControls; ++k) {
    // The rate of time is a quadratic spline of these: it is nowhere below the least of them.
    const double rise = solution[(k + 1) % kControls] - solution[k];
    if (!(duration / kControls + rise > kSlowest * duration / kControls))
      return Status::error(Code::kOutOfRange, "markers make time nearly stand still");
    map.lag[std::size_t(k)] = static_cast<float>(solution[k]);
  }
  out = map;
  return {};
}

Status phase_markers(const Clip& clip, int left, int right, std::vector<PhaseMarker>& markers, int& cycles) {
  if (!clip.loops) return Status::error(Code::kInvalidArgument, "only a loop has a phase");
  struct Down {
    double time;
    bool left;
  };
  std::vector<Down> downs;
  for (const ContactWindow& window : clip.contacts)
    if (window.joint == left || window.joint == right)
      downs.push_back({double(window.begin), window.joint == left});
  std::sort(downs.begin(), downs.end(), [](const Down& a, const Down& b) { return a.time < b.time; });
  if (!downs.empty() && !downs.front().left) {  // the cycle begins with the left one
    downs.push_back({downs.front().time + clip.duration, false});
    downs.erase(downs.begin());
  }
  if (downs.empty() || downs.size() % 2 != 0)
    return Status::error(Code::kInvalidArgument, "the feet do not come down equally often");
  markers.clear();
  for (std::size_t i = 0; i < downs.size(); ++i) {
    if (downs[i].left != (i % 2 == 0))
      return Status::error(Code::kInvalidArgument, "the feet do not take turns", static_cast<int>(i));
    markers.push_back({0.5 * double(i), downs[i].time});
  }
  cycles = static_cast<int>(downs.size() / 2);
  return {};
}

Status PhaseJob::Validate() const {
  if (!phase) return Status::error(Code::kInvalidArgument, "no phase");
  if (times.size() < members.size()) return Status::error(Code::kInvalidArgument, "fewer times than members");
  if (!std::isfinite(phase->value) || !std::isfinite(phase->rate) || !std::isfinite(phase->acceleration) ||
      !std::isfinite(h))
    return Status::error(Code::kNotFinite, "phase or step is not finite");
  if (h < 0 || h > 1) return Status::error(Code::kOutOfRange, "step is not within 0 and 1 s");
  double sum = 0;
  for (std::size_t i = 0; i < members.size(); ++i) {
    const PhaseMember& m = members[i];
    const int index = static_cast<int>(i);
    if (!m.map || !(m.map->duration > 0))
      return Status::error(Code::kInvalidArgument, "member has no map", index);
    if (!std::isfinite(m.weight.value) || !std::isfinite(m.weight.rate))
      return Status::error(Code::kNotFinite, "weight is not finite", index);
    if (m.weight.value < 0 || !(m.speed > 0.01) || !(m.speed < 100))
      return Status::error(Code::kOutOfRange, "weight is negative or speed absurd", index);
    sum += m.weight.value;
  }
  if (!(sum > 0)) return Status::error(Code::kInvalidArgument, "no member has a weight");
  return {};
}

Status PhaseJob::Run() const {
  if (Status status = Validate(); !status) return status;
  const TimeJet<double> before = *phase;
  double end = before.value + h * before.rate + h * h / 2 * before.acceleration;
  for (int n = 0; n < 2 && h > 0; ++n) {  // the rates at the end depend on where it is
    const TimeJet<double> there = pace(members, end, times);
    end = before.value + h / 2 * (before.rate + there.rate) +
          h * h / 12 * (before.acceleration - there.acceleration);
  }
  *phase = pace(members, end, times);
  for (std::size_t i = 0; i < members.size(); ++i) times[i] = moving_with(times[i], *phase);
  return {};
}

}  // namespace sinew
