#include "study/audit/books.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew::audit {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kKept = 9;  ///< instants: four on either side of the one that is judged
constexpr std::size_t kMiddle = 4;
constexpr std::size_t kRiseWithin = 12;  ///< steps: an impact spoils four on either side
constexpr double kWellSeen = 1e-3;       ///< of the largest kinetic energy: what hard cases ask for
constexpr double kSeenAnyway = 1e-6;     ///< J
constexpr double kJudged = 1.5;          ///< rad per step: poses that turn faster show no motion

/// Of a length of `size` that may be so much shorter or longer.
Bounds squares(double size, double shorter, double longer) {
  const double low = std::max(0.0, size - shorter), high = size + longer;
  return {low * low, high * high};
}

}  // namespace

Bounds kinetic_energy(const Body& body, const Velocity& v) {
  const Bounds linear = squares(v.linear.value.norm(), v.linear.error, v.linear.longer);
  // In the metric of the inertia, whose norm is no less than its largest moment.
  const double spin = std::sqrt(std::max(0.0, v.angular.value.dot(body.inertia * v.angular.value)));
  if (!std::isfinite(v.angular.longer))
    return {0.5 * body.mass * linear.low, std::numeric_limits<double>::infinity()};
  const double unit = std::sqrt(body.inertia.norm());
  const Bounds angular = squares(spin, unit * v.angular.error, unit * v.angular.longer);
  return {0.5 * (body.mass * linear.low + angular.low), 0.5 * (body.mass * linear.high + angular.high)};
}

double potential_energy(const Body& body, const Transform<double>& pose, const Vector3d& gravity) {
  return -body.mass * gravity.dot(pose * body.center);
}

double least_energy(const Body& body, const Transform<double>& before, const Transform<double>& after,
                    double h, const Vector3d& gravity, double precision) {
  const Vector3d from = before * body.center, to = after * body.center;
  const double rounding = 2 * precision * (to.cwiseAbs().maxCoeff() + body.center.norm());
  const double way = std::max(0.0, (to - from).norm() - rounding);
  const double turn =
      std::max(0.0, Eigen::AngleAxisd(before.rotation.conjugate() * after.rotation).angle() - 2 * precision);
  const double most_mobile = body.inertia.inverse().norm();  // no less than its largest eigenvalue
  const double inertia = std::isfinite(most_mobile) ? 1 / most_mobile : 0;
  const double height =
                   0.5 * (potential_energy(body, before, gravity) + potential_energy(body, after, gravity)),
               unsure = body.mass * gravity.norm() * rounding;
  // Of all ways from one place to the other that of ÿ = +g, a parabola below the chord, takes least.
  const double below_chord = body.mass * gravity.squaredNorm() * h * h / 24;
  return 0.5 * (body.mass * way * way + inertia * turn * turn) / (h * h) + height - below_chord - unsure;
}

Momentum momentum_of(const Body& body, const Transform<double>& pose, const Velocity& v) {
  Momentum m;
  m.linear = body.mass * v.linear.value;
  m.linear_error = body.mass * v.linear.error;
  const Vector3d center = pose * body.center;
  m.angular = center.cross(m.linear) + pose.rotation * (body.inertia * v.angular.value);
  m.angular_error = center.norm() * m.linear_error + body.inertia.norm() * v.angular.error;
  return m;
}

int Books::add(const Member& member, Poses before, Poses now, Poses after, double span) {
  if (instants_.empty()) instants_.emplace_back();
  first_.push_back(bodies_.size());
  members_.push_back(member);
  based_ = true;
  for (std::size_t b = 0; b < member.bodies.size(); ++b) {
    const Body& body = member.bodies[b];
    const Velocity v = chord(body, before[b], after[b], 2 * span, 0);
    const Bounds kinetic = kinetic_energy(body, v);
    fastest_ = std::max(fastest_, v.angular.value.norm());
    kinetic_ += 0.5 * (kinetic.low + kinetic.high);
    base_ += kinetic.high + potential_energy(body, now[b], gravity_);
    bodies_.push_back(body);
    instants_.front().poses.push_back(now[b]);
    before_start_.push_back(before[b]);
  }
  before_start_span_ = span;
  balance_.kinetic_start = balance_.kinetic_most = kinetic_;
  return static_cast<int>(members_.size()) - 1;
}

void Books::forget() {
  instants_.clear();
  before_start_.clear();
  highs_.clear();
  based_ = false;
}

void Books::record(double h, const std::vector<Transform<double>>& poses, double work, double unsure) {
  Instant next;
  next.time = (instants_.empty() ? 0 : instants_.back().time) + h;
  next.work = balance_.work += work;
  next.unsure = (instants_.empty() ? 0 : instants_.back().unsure) + unsure;
  next.poses = poses;
  instants_.push_back(std::move(next));
  if (instants_.size() > kKept) {
    instants_.pop_front();
    before_start_.clear();
  }
  if (instants_.size() > 1) look_at_step();
  if (instants_.size() == kKept) judge_instant(fastest_ * h);
}

Poses Books::poses(int member) const {
  const auto m = static_cast<std::size_t>(member);
  return Poses(instants_.back().poses).subspan(first_[m], members_[m].bodies.size());
}

std::vector<double> Books::times() const {
  std::vector<double> all;
  for (const Instant& i : instants_) all.push_back(i.time);
  return all;
}

std::vector<Transform<double>> Books::history(std::size_t body) const {
  std::vector<Transform<double>> poses;
  for (const Instant& i : instants_) poses.push_back(i.poses[body]);
  return poses;
}

Estimate Books::arriving(int member, int body, const Vector3d& point) const {
  if (!begun()) return {Vector3d::Zero(), std::numeric_limits<double>::infinity()};
  const std::size_t index = first_[static_cast<std::size_t>(member)] + static_cast<std::size_t>(body);
  std::vector<double> when = times();
  std::vector<Transform<double>> poses = history(index);
  if (!before_start_.empty()) {
    when.insert(when.begin(), when.front() - before_start_span_);
    poses.insert(poses.begin(), before_start_[index]);
  }
  return arriving_velocity(point, poses, when);
}

Momentum Books::momentum(int member) const {
  Momentum sum;
  if (instants_.size() < 2) return sum;
  const Instant &from = instants_[instants_.size() - 2], &to = instants_.back();
  const auto m = static_cast<std::size_t>(member);
  for (std::size_t b = first_[m]; b < first_[m] + members_[m].bodies.size(); ++b) {
    const Momentum one =
        momentum_of(bodies_[b], to.poses[b],
                    chord(bodies_[b], from.poses[b], to.poses[b], to.time - from.time, precision_));
    sum.linear += one.linear;
    sum.angular += one.angular;
    sum.linear_error += one.linear_error;
    sum.angular_error += one.angular_error;
  }
  return sum;
}

void Books::look_at_step() {
  const Instant &from = instants_[instants_.size() - 2], &to = instants_.back();
  kinetic_ = 0;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Bounds one = kinetic_energy(
        bodies_[b], chord(bodies_[b], from.poses[b], to.poses[b], to.time - from.time, precision_));
    kinetic_ += 0.5 * (one.low + one.high);
  }
  const double leap = leap_of_step();
  balance_.leap = std::max(balance_.leap, leap);
  balance_.kinetic_end = kinetic_;
  balance_.kinetic_most = std::max(balance_.kinetic_most, kinetic_ - leap);
}

/// J, by which the last step's way must have needed more than there was; 0 where that is not known.
double Books::leap_of_step() const {
  if (!based_) return 0;
  const Instant &from = instants_[instants_.size() - 2], &to = instants_.back();
  double needed = 0;
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    needed += least_energy(bodies_[b], from.poses[b], to.poses[b], to.time - from.time, gravity_, precision_);
  return std::max(0.0, needed - base_ - std::max(from.work, to.work) - to.unsure);
}

/// J, that a body may have in bounces that the two steps beside an instant hide, of h seconds at most.
/// Between two impacts it flies for 2 h at most, so it leaves them at g h at most; as much again for what
/// turns. And it shows some of it: eight steps do not all happen to be as long as whole bounces.
double Books::hidden(const Body& body, const Velocity& v, double h) const {
  if (v.smooth) return 0;
  constexpr double kShown = 8;  // times what mean velocities differ by; exact balls need 3
  const double shown = body.mass * v.linear.longer * v.linear.longer +
                       body.inertia.trace() * v.angular.longer * v.angular.longer;
  return std::min(body.mass * gravity_.squaredNorm() * h * h, kShown * kShown * shown);
}

void Books::judge_instant(double turn_at_start) {
  const Instant& now = instants_[kMiddle];
  const Stencils stencils(times(), kMiddle);
  const double longest =
      std::max(now.time - instants_[kMiddle - 1].time, instants_[kMiddle + 1].time - now.time);
  Bounds energy;
  double kinetic = 0, potential = 0;
  bool followed = turn_at_start < 2 * kJudged;
  momentum_ = {};
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Velocity v = velocity_at(bodies_[b], history(b), stencils, precision_);
    const Bounds one = kinetic_energy(bodies_[b], v);
    const double height = potential_energy(bodies_[b], now.poses[b], gravity_),
                 rounding = bodies_[b].mass * gravity_.norm() * precision_ * now.poses[b].translation.norm();
    energy.low += one.low + height - rounding;
    energy.high += one.high + height + rounding + hidden(bodies_[b], v, longest);
    kinetic += one.low, potential += height;
    followed = followed && v.turn < kJudged;
    const Momentum m = momentum_of(bodies_[b], now.poses[b], v);
    momentum_.linear += m.linear;
    momentum_.angular += m.angular;
    momentum_.linear_error += m.linear_error;
    momentum_.angular_error += m.angular_error;
  }
  if (based_) kinetic = std::min(kinetic, base_ + now.work + now.unsure - potential);
  balance_.kinetic_most = std::max(balance_.kinetic_most, kinetic);
  ++balance_.instants;
  if (followed) {
    enter(energy, now);
  } else {
    ++balance_.blind;
    highs_.clear();
  }
}

/// What stands in the books at an instant.
void Books::enter(const Bounds& energy, const Instant& at) {
  if (!based_) base_ = energy.high - at.work, based_ = true;
  const double low = energy.low - at.work - at.unsure, high = energy.high - at.work - at.unsure;
  balance_.gain = std::max(balance_.gain, low - base_);
  const double unsure = 0.5 * (energy.high - energy.low);
  const bool seen = unsure <= kWellSeen * balance_.kinetic_most + kSeenAnyway;
  // From an instant that was seen: within impacts nothing tells how much there was at most.
  for (const double before : highs_)
    if (seen) balance_.rise = std::max(balance_.rise, low - before);
  highs_.push_back(seen ? high : std::numeric_limits<double>::infinity());
  if (highs_.size() > kRiseWithin) highs_.pop_front();
  if (!seen) return;
  ++balance_.seen;
  balance_.unsure = std::max(balance_.unsure, unsure);
}

}  // namespace sinew::audit
