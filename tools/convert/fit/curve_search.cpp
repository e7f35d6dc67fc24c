#include "convert/fit/curve_search.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "sinew/animation/clip_packing.h"

namespace sinew::convert {
namespace {

constexpr double kStill = 0.1;  ///< of the error budget: what a constant may be off by
/// Of the error budget: what one step of rounding may at first shift the farthest skin point by. Steps that
/// turn out to be too coarse are refined; halving or doubling this changes sizes by 1 %.
constexpr double kFirstStep = 0.5;
constexpr double kCoarsest = 0.5;  ///< s between knots: a slower movement than a body's
/// s between knots of the curves whose accelerations are to be kept: of motion capture with noise, quintic
/// curves with a knot every fifteenth of a second have the most accurate ones.
constexpr double kReference = 1 / 14.9;
constexpr int kRegister = 8;  ///< tracks that AVX2 samples together
constexpr int kFewest =
    12;  ///< tracks that are worth weights of their own: those take two thirds of a register
constexpr int kHalfOctave = 2;  ///< steps of packing_step() that divide it by √2

/// Numbers of spans from coarsest to finest, by twos: tracks whose knots agree are sampled together,
/// and steps of 1.26 saved 3 % of the bytes only.
std::vector<int> ladder(int finest, double duration) {
  std::vector<int> spans;
  for (double n = finest;; n /= 2) {
    spans.push_back(std::max(1, static_cast<int>(std::lround(n))));
    if (spans.back() == 1 || duration / n > kCoarsest) break;
  }
  std::reverse(spans.begin(), spans.end());
  return spans;
}

double rms(const Eigen::MatrixXd& rows) {
  return std::sqrt(rows.squaredNorm() / double(rows.rows()));
}

double angle_between(const Quat<double>& a, const Quat<double>& b) {
  return 2 * (a.conjugate() * b).vec().norm();
}

}  // namespace

CurveSearch::CurveSearch(const std::vector<std::vector<Transform<double>>>& samples,
                         std::vector<double> instants, int finest, const std::vector<int>& parents,
                         const std::vector<Transform<float>>& rest, double duration, bool loops,
                         const CurveBudget& budget)
    : budget_(budget),
      duration_(duration),
      loops_(loops),
      chain_(samples, parents, budget.skin_distance),
      instants_(std::move(instants)),
      spans_(ladder(finest, duration)),
      allowed_(spans_.size(), 1),
      channels_of_(samples.front().size()),
      local_(samples.front().size()) {
  instants_.resize(samples.size());
  for (std::size_t j = 0; j < local_.size(); ++j) {
    const int joint = static_cast<int>(j);
    JointMotion motion;
    for (const auto& frame : samples) motion.push_back(frame[j]);
    add_channels(joint, motion, rest.empty() ? nullptr : &rest[j]);
    local_[j].assign(samples.size(), constants_[j].cast<double>());
    chain_.set(joint, local_[j]);
  }
  chain_.update();
  for (Channel& channel : channels_) fit(channel);
}

/// m to the farthest skin point that a joint carries.
double CurveSearch::reach(int joint) const {
  double reach = 0;
  for (int other = joint; other < chain_.joints(); ++other) {
    if (!chain_.is_above(joint, other)) continue;
    for (int f = 0; f < chain_.frames(); ++f)
      reach =
          std::max(reach, (chain_.model(other, f).translation - chain_.model(joint, f).translation).norm());
  }
  return reach + budget_.skin_distance;
}

/// What moves gets a channel, what does not a constant, rest if it is that.
void CurveSearch::add_channels(int joint, const JointMotion& motion, const Transform<float>* rest) {
  const double lever = reach(joint), still = kStill * budget_.error;
  const Transform<double>& first = motion.front();
  const bool turns = largest_turn(motion) * lever > still;
  const bool shifts = largest_shift(motion) > still;
  Transform<float> constant = first.cast<float>();
  if (rest && (turns || angle_between(rest->rotation.cast<double>(), first.rotation) * lever < still))
    constant.rotation = rest->rotation;
  if (rest && (shifts || (rest->translation.cast<double>() - first.translation).norm() < still))
    constant.translation = rest->translation;
  constants_.push_back(constant);
  if (turns) add_channel(joint, true, 2 * lever, motion);  // numbers are tan(angle / 2)
  if (shifts) add_channel(joint, false, 1, motion);
}

/// `lever`: what the numbers' unit shifts the farthest point by.
void CurveSearch::add_channel(int joint, bool rotation, double lever, const JointMotion& motion) {
  int step = 0;
  while (step + 1 < kPackingSteps && packing_step(step) * lever > kFirstStep * budget_.error) ++step;
  FittedTrack track(joint, rotation, motion);
  const int coarsest = coarsest_level(track);
  channels_of_[joint].push_back(static_cast<int>(channels_.size()));
  channels_.push_back({std::move(track), coarsest, coarsest, step, 0});
}

const KnotGrid& CurveSearch::grid(int level) {
  auto& made = grids_[level];
  if (!made) made = std::make_unique<KnotGrid>(instants_, spans_[level], budget_.degree, loops_);
  return *made;
}

double CurveSearch::acceleration_budget(bool rotation, double own) const {
  return std::max(rotation ? budget_.angular : budget_.linear, budget_.share * own);
}

int CurveSearch::reference_level() const {
  int level = static_cast<int>(spans_.size()) - 1;
  while (level > 0 && interval(level - 1) <= kReference) --level;
  return level;
}

int CurveSearch::coarsest_level(const FittedTrack& track) {
  const int reference = reference_level();
  const Eigen::MatrixXd truth = track.accelerations(grid(reference), interval(reference));
  const double allowed = acceleration_budget(track.rotation(), rms(truth));
  int level = reference;
  while (level > 0 && rms(track.accelerations(grid(level - 1), interval(level - 1)) - truth) <= allowed)
    --level;
  return level;
}

/// The step that a channel asks for, or the coarsest that shakes its acceleration no more than allowed.
int CurveSearch::step_of(const Channel& channel) const {
  const double h = interval(channel.level);
  const double per_step = (channel.track.rotation() ? 2 : 1) * std::sqrt(3.0) / (h * h);
  const double noise = second_derivative_noise(budget_.degree) * per_step;
  const double allowed = acceleration_budget(channel.track.rotation(), channel.acceleration);
  int step = channel.step;
  while (step + 1 < kPackingSteps && packing_step(step) * noise > allowed) ++step;
  return std::min(step, channel.track.finest_step());
}

void CurveSearch::fit(Channel& channel) {
  const KnotGrid& knots = grid(channel.level);
  channel.track.fit(knots);
  channel.acceleration = rms(channel.track.accelerations(knots, interval(channel.level)));
  channel.track.round(knots, step_of(channel));
  play(channel);
}

void CurveSearch::play(const Channel& channel) {
  const int joint = channel.track.joint();
  for (int f = 0; f < chain_.frames(); ++f) channel.track.play(f, local_[joint][f]);
  chain_.set(joint, local_[joint]);
  chain_.update(joint);
}

/// How much of a joint's error at a frame a channel could take away per bit, and by what.
double CurveSearch::gain(const Channel& channel, int joint, int frame, Move& move) const {
  const FittedTrack& track = channel.track;
  const Transform<double>& truth = chain_.truth(track.joint(), frame);
  const double lever =
      budget_.skin_distance +
      (chain_.model(joint, frame).translation - chain_.model(track.joint(), frame).translation).norm();
  const auto apart = [&](const Transform<double>& a, const Transform<double>& b) {
    return track.rotation() ? lever * angle_between(a.rotation, b.rotation)
                            : (a.translation - b.translation).norm();
  };
  Transform<double> smooth = truth, rounded = truth;
  track.play_unrounded(frame, smooth);
  track.play(frame, rounded);
  double best = 0;
  if (const int finer = next_level(channel.level); finer >= 0) {
    const double bits_per_control = track.bits() / track.controls();
    best = apart(truth, smooth) / ((spans_[finer] - spans_[channel.level]) * bits_per_control);
    move = Move::kMoreKnots;
  }
  if (step_of(channel) + kHalfOctave <= track.finest_step()) {
    constexpr double kLess = 1 - 0.7071, kBits = 1.5;  // half a bit of three numbers takes 1 − 1/√2 away
    const double gain = kLess * apart(smooth, rounded) / (track.controls() * kBits);
    if (gain > best) move = Move::kFinerStep;
    best = std::max(best, gain);
  }
  return best;
}

/// Improves what takes most away of a joint's worst error for the bits that it costs, unless something on its
/// chain was `touched` already. False where nothing can be improved.
bool CurveSearch::refine(int joint, std::vector<std::uint8_t>& touched) {
  const int frame = chain_.worst_frame(joint);
  Channel* best = nullptr;
  Move best_move = Move::kNone;
  double most = 0;
  for (int above = joint; above >= 0; above = chain_.parent(above)) {
    if (touched[above]) return false;
    for (const int index : channels_of_[above]) {
      Move move = Move::kNone;
      const double taken = gain(channels_[index], joint, frame, move);
      if (taken <= most) continue;
      most = taken;
      best = &channels_[index];
      best_move = move;
    }
  }
  if (!best) return false;
  if (best_move == Move::kMoreKnots)
    best->level = next_level(best->level);
  else
    best->step = step_of(*best) + kHalfOctave;
  touched[best->track.joint()] = 1;
  fit(*best);
  return true;
}

/// The worst joints first; chains are independent of each other within a round.
void CurveSearch::refine_all() {
  for (bool more = true; more;) {
    std::vector<std::pair<double, int>> worst;
    for (int j = 0; j < chain_.joints(); ++j) {
      const double error = chain_.error(j, chain_.worst_frame(j));
      if (error > budget_.error) worst.emplace_back(-error, j);
    }
    std::sort(worst.begin(), worst.end());
    std::vector<std::uint8_t> touched(channels_of_.size(), 0);
    more = false;
    for (const auto& [error, joint] : worst) more |= refine(joint, touched);
  }
}

/// Takes a change back unless it saves bits within the budget.
bool CurveSearch::try_change(Channel& channel, int level, int step) {
  const Channel before = channel;
  channel.level = level;
  channel.step = step;
  fit(channel);
  if (chain_.largest() <= budget_.error && channel.track.bits() < before.track.bits()) return true;
  channel = before;
  play(channel);
  return false;
}

/// `knots`: those too, not the rounding alone.
void CurveSearch::coarsen(bool knots) {
  std::vector<int> order(channels_.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return channels_[a].track.bits() > channels_[b].track.bits(); });
  for (const int index : order) {
    Channel& channel = channels_[index];
    while (knots && channel.level > channel.coarsest &&
           try_change(channel, channel.level - 1, channel.step)) {
    }
    while (step_of(channel) >= kHalfOctave &&
           try_change(channel, channel.level, step_of(channel) - kHalfOctave)) {
    }
  }
}

int CurveSearch::turning(int level) const {
  return static_cast<int>(std::count_if(channels_.begin(), channels_.end(), [&](const Channel& channel) {
    return channel.level == level && channel.track.rotation();
  }));
}

/// The next finer level that tracks may have, or −1.
int CurveSearch::next_level(int level) const {
  for (std::size_t finer = level + 1; finer < spans_.size(); ++finer)
    if (allowed_[finer]) return static_cast<int>(finer);
  return -1;
}

/// Sampling takes rotations of like knots by registers, and weighs the knots of each level anew: tracks move
/// to the next finer level where that saves a register, or where they are few.
void CurveSearch::merge_small_levels() {
  const auto registers = [](int tracks) { return (tracks + kRegister - 1) / kRegister; };
  for (std::size_t l = 0; l < spans_.size(); ++l) allowed_[l] = turning(static_cast<int>(l)) > 0;
  for (std::size_t l = 0; l < spans_.size(); ++l) {
    const int level = static_cast<int>(l), finer = next_level(level), here = turning(level);
    if (finer < 0) break;
    const int there = turning(finer);
    if (here >= kFewest && registers(here) + registers(there) == registers(here + there)) continue;
    allowed_[l] = 0;
    for (Channel& channel : channels_) {
      if (channel.level != level) continue;
      channel.level = finer;
      fit(channel);
    }
  }
}

void CurveSearch::run() {
  refine_all();
  coarsen(true);
  merge_small_levels();
  refine_all();
  coarsen(false);
}

}  // namespace sinew::convert
