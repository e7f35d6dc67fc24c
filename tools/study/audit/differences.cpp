#include "study/audit/differences.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sinew::audit {
namespace {

using Eigen::Vector3d;

constexpr double kFurthest = 2.5;    ///< rad: logarithms of rotations are smooth up to π
constexpr double kUneven = 10;       ///< times a step
constexpr double kConverges = 0.15;  ///< of one order's correction by the next; of sin(ωt) about 0.2·(hω)²
constexpr double kCaution = 4;       ///< of what errors are taken for: jumps that hide in what swings
constexpr double kJumpCaution = 1.25;  ///< of half a jump

Vector3d turned(const Transform<double>& from, const Transform<double>& to) {
  const Eigen::AngleAxisd turn(from.rotation.conjugate() * to.rotation);
  return turn.angle() * turn.axis();
}

/// Differences of growing order of a vector about the node, where it is zero.
class Sequence {
 public:
  template <class At>
  Sequence(const Stencils& s, int aside, double rounding, At at)
      : aside_(aside), step_((s.steps[index(0)] + s.steps[index(1)]) / 2) {
    for (int k = 1; k <= aside; ++k) {
      const Weights& w = s.weights[static_cast<std::size_t>(k - 1)];
      Vector3d first = Vector3d::Zero(), second = first;
      double squares = 0;
      for (int i = -k; i <= k; ++i) {
        const int index = i + k;
        squares += w.first[index] * w.first[index];
        if (i == 0) continue;
        first += w.first[index] * at(i);
        second += w.second[index] * at(i);
      }
      velocity_[k] = first;
      bend_[k] = step_ * second;
      noise_ = rounding * std::sqrt(squares);
    }
    const auto mean = [&](int k) -> Vector3d { return (at(k) - at(k - 1)) / s.steps[index(k)]; };
    for (int k = 1 - aside; k < aside; ++k) {
      const double half = 0.5 * (mean(k + 1) - mean(k)).norm();
      if (std::abs(k) <= 1) jump_ = std::max(jump_, half);
      widest_ = std::max(widest_, half);
    }
  }

  Estimate best() const {
    const int k = converged();
    if (k == 0) return {velocity_[1], kJumpCaution * jump_ + noise_, kJumpCaution * widest_ + noise_};
    const double error = kCaution * correction(k - 1) + noise_;
    return {velocity_[k], error, error};
  }
  /// Points on either side of the highest order up to which differences converge; 0: none.
  int converged() const {
    int k = aside_;
    while (k >= 3 && !converges(k)) --k;
    return k >= 3 ? k : 0;
  }

 private:
  static std::size_t index(int k) { return static_cast<std::size_t>(k + Stencils::kMostAside - 1); }
  /// m/s or rad/s, by what the order of 2k changes what that of 2k − 2 had.
  double correction(int k) const {
    return std::max((velocity_[k] - velocity_[k - 1]).norm(), (bend_[k] - bend_[k - 1]).norm());
  }
  bool converges(int upto) const {
    for (int k = 3; k <= upto; ++k) {
      const auto falls = [&](const std::array<Vector3d, 5>& d) {
        return (d[k] - d[k - 1]).norm() <= kConverges * (d[k - 1] - d[k - 2]).norm() + 4 * noise_;
      };
      if (!falls(velocity_) || !falls(bend_)) return false;
    }
    return true;
  }

  int aside_;
  double step_, noise_ = 0;
  double jump_ = 0, widest_ = 0;             ///< half of one beside the node, and of any
  std::array<Vector3d, 5> velocity_, bend_;  ///< [points on either side]
};

}  // namespace

Weights::Weights(std::span<const double> times, double at) {
  const int count = static_cast<int>(times.size());
  std::array<double, 9> value{};
  value[0] = 1;
  double product = 1, offset = times[0] - at;
  for (int i = 1; i < count; ++i) {
    double next_product = 1;
    const double old_offset = offset;
    offset = times[i] - at;
    for (int k = 0; k < i; ++k) {
      const double between = times[i] - times[k];
      next_product *= between;
      if (k == i - 1) {
        second[i] = product * (2 * first[i - 1] - old_offset * second[i - 1]) / next_product;
        first[i] = product * (value[i - 1] - old_offset * first[i - 1]) / next_product;
        value[i] = -product * old_offset * value[i - 1] / next_product;
      }
      second[k] = (offset * second[k] - 2 * first[k]) / between;
      first[k] = (offset * first[k] - value[k]) / between;
      value[k] = offset * value[k] / between;
    }
    product = next_product;
  }
}

Stencils::Stencils(std::span<const double> times, int at)
    : node(at), aside(std::min({at, static_cast<int>(times.size()) - 1 - at, kMostAside})) {
  for (int k = 1; k <= aside; ++k)
    weights[static_cast<std::size_t>(k - 1)] = Weights(
        times.subspan(static_cast<std::size_t>(at - k), static_cast<std::size_t>(2 * k + 1)), times[at]);
  for (int k = 1 - aside; k <= aside; ++k)
    steps[static_cast<std::size_t>(k + kMostAside - 1)] = times[at + k] - times[at + k - 1];
  for (int k = 1; k <= aside; ++k) {
    const auto first = steps.begin() + (kMostAside - k), last = steps.begin() + (kMostAside + k);
    if (*std::max_element(first, last) > kUneven * *std::min_element(first, last)) break;
    even = k;
  }
}

Velocity velocity_at(const Body& body, std::span<const Transform<double>> poses, const Stencils& s,
                     double precision) {
  const Transform<double>& here = poses[s.node];
  const Vector3d center = here * body.center;
  const double size = center.cwiseAbs().maxCoeff() + body.center.norm();
  Velocity v;
  const Sequence places(s, std::max(s.even, std::min(s.aside, 1)), precision * size,
                        [&](int k) -> Vector3d { return poses[s.node + k] * body.center - center; });
  v.linear = places.best();
  int followed = 0;  // instants on both sides to which the rotation can be followed
  std::array<Vector3d, 2 * Stencils::kMostAside + 1> turns;
  turns.fill(Vector3d::Zero());
  const auto turn = [&](int k) -> Vector3d& { return turns[k + Stencils::kMostAside]; };
  for (int k = 1; k <= std::max(s.even, std::min(s.aside, 1)); ++k) {
    bool follows = true;
    for (const int side : {-1, 1}) {
      turn(side * k) = turned(here, poses[s.node + side * k]);
      // What goes further than π comes back as less than before: it would have by as much again as before.
      const double now = turn(side * k).norm(), last = turn(side * (k - 1)).norm();
      follows = follows && now < kFurthest && (k == 1 || last * k / (k - 1) < kFurthest);
    }
    if (!follows) break;
    followed = k;
  }
  if (s.aside > 0) v.turn = std::max(turn(-1).norm(), turn(1).norm());
  if (followed == 0) {
    v.angular.error = v.angular.longer = std::numeric_limits<double>::infinity();
    return v;
  }
  const Sequence turnings(s, followed, precision, turn);
  v.angular = turnings.best();
  v.smooth = places.converged() > 0 && turnings.converged() > 0;
  return v;
}

Velocity chord(const Body& body, const Transform<double>& before, const Transform<double>& after, double h,
               double precision) {
  Velocity v;
  const Vector3d to = after * body.center;
  v.linear.value = (to - before * body.center) / h;
  v.linear.error = v.linear.longer = 2 * precision * (to.cwiseAbs().maxCoeff() + body.center.norm()) / h;
  const Vector3d turn = turned(before, after);
  v.angular.value = turn / h;
  v.angular.error = v.angular.longer = turn.squaredNorm() / 12 * v.angular.value.norm() + 2 * precision / h;
  return v;
}

Estimate arriving_velocity(const Vector3d& point, std::span<const Transform<double>> poses,
                           std::span<const double> times) {
  const std::size_t count = poses.size();
  Estimate best;
  best.error = std::numeric_limits<double>::infinity();
  Vector3d lower = Vector3d::Zero();
  const Vector3d here = poses[count - 1] * point;
  for (std::size_t n = 2; n <= std::min<std::size_t>(count, 6); ++n) {
    const std::array<double, 9> weights = Weights(times.last(n), times[count - 1]).first;
    Vector3d value = Vector3d::Zero();
    for (std::size_t k = 0; k < n; ++k) value += weights[k] * (poses[count - n + k] * point - here);
    const double error = n == 2 ? value.norm() : (value - lower).norm();
    if (error < best.error) best = {value, error, error};
    lower = value;
  }
  return best;
}

}  // namespace sinew::audit
