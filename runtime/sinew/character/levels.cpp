#include "sinew/character/levels.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sinew {
namespace {

constexpr double kSmoothing = 0.2;     ///< s, of a character's cost
constexpr int kOverSteps = 2;          ///< above the limit before somebody is capped
constexpr int kUnderSteps = 30;        ///< well below it before a cap is taken off
constexpr double kWellBelow = 0.75;    ///< of the limit
constexpr double kAim = 0.85;          ///< of the limit, that capping and raising keep to
constexpr float kPartialShare = 0.6f;  ///< of a full solve's cost, that one with baked limbs takes
/// rad (or m) and rad/s off the animation, from which the return leads without asking the muscles: within a
/// step they would make less than 0.5° of difference
constexpr double kCalmOffset = 0.15, kCalmRate = 1.5;
constexpr int kShare = 10;  ///< at most one in so many characters is capped in one step

}  // namespace

Status validate(const CharacterDetail& detail) {
  if (!std::isfinite(detail.significance))
    return Status::error(Code::kNotFinite, "significance is not finite");
  if (detail.check_every < 1 || detail.check_every > 1000)
    return Status::error(Code::kOutOfRange, "check_every is not within 1 and 1000 steps");
  return {};
}

template <class T>
Level allowed_level(const CharacterState<T>& s) {
  const Level cap = std::min(s.detail.most, s.levels.cap);
  // What holds no joint of its own can be on no clip; nor what is tied to something or thrown about.
  const double time = double(s.tree.scale.time);
  const auto far = [time](const Deviation<T>& d) {
    const auto above = [](double most) { return [most](T x) { return std::abs(double(x)) > most; }; };
    return std::any_of(d.offset.begin(), d.offset.end(), above(kCalmOffset)) ||
           std::any_of(d.rate.begin(), d.rate.end(), above(kCalmRate / time));
  };
  const bool thrown = cap < Level::kPartial && std::any_of(s.deviation.begin(), s.deviation.end(), far);
  return std::max(cap, s.driven && !s.tied && !thrown ? Level::kPlayback : Level::kPartial);
}

template <class T>
Level level_of(const CharacterState<T>& s) {
  const CharacterReport& r = s.report;
  if (r.unknown_dofs == 0) return Level::kChecked;
  if (r.substeps > 1) return Level::kSubsteps;
  const int root = s.root_is_kinematic() && s.tree.type[0] == JointType::kFree ? s.tree.dof_count(0) : 0;
  return r.unknown_dofs + root < r.dofs ? Level::kPartial : Level::kFull;
}

template <class T>
void choose_level(CharacterState<T>& s, Level needed, T h, double dwell) {
  LevelState& l = s.levels;
  ++l.steps;
  l.cap_age = std::min(l.cap_age + static_cast<float>(h), 1e6f);
  if (needed >= l.level || needed == Level::kAsleep) {
    l.level = needed;
    l.lower = Level::kAsleep;
    l.unneeded = l.lower_unneeded = 0;
  } else {
    l.unneeded += static_cast<float>(h);
    l.lower_unneeded = needed < l.lower ? l.lower_unneeded + static_cast<float>(h) : 0;
    l.lower = std::max(l.lower, needed);
    if (double(l.unneeded) >= dwell) {
      l.level = std::exchange(l.lower, needed);
      l.unneeded = std::exchange(l.lower_unneeded, 0.f);
    }
  }
  l.level = std::min(l.level, std::max(l.allowed, needed));
}

template <class T>
double work_of(const CharacterState<T>& s, Level did) {
  const auto joints = double(s.local.size());
  const double played = 20 * joints;
  if (did == Level::kAsleep) return 0;
  if (did == Level::kPlayback) return played;
  const double checked = played + 60 * s.tree.bodies;
  if (s.report.substeps == 0) return checked;
  const CharacterReport& r = s.report;
  return checked + 120.0 * r.substeps * s.tree.bodies + 150.0 * r.outer_passes * s.tree.bodies +
         (30.0 * r.unknown_dofs + 100.0 * r.contacts) * r.factorisations;
}

template <class T>
void BudgetController<T>::reserve(int states) {
  order_.reserve(states);
}

/// What a level below the present one would cost.
template <class T>
float BudgetController<T>::cost_at(const CharacterState<T>& s, Level level) const {
  const float played = state_.scale * static_cast<float>(work_of(s, Level::kPlayback));
  return std::min(s.levels.cost, level == Level::kPlayback ? played : kPartialShare * s.levels.cost);
}

template <class T>
void BudgetController<T>::lower(std::span<const std::unique_ptr<CharacterState<T>>> states, double limit) {
  int left = 1 + static_cast<int>(order_.size()) / kShare;
  for (const int n : order_) {
    if (state_.forecast <= kAim * limit || left == 0) return;
    CharacterState<T>& s = *states[n];
    LevelState& l = s.levels;
    const Level now = std::min(l.level, l.allowed);
    const Level to = now > Level::kPartial ? Level::kPartial : Level::kPlayback;
    if (now <= Level::kPlayback || (to < Level::kPartial && (!s.driven || s.tied))) continue;
    const float cost = cost_at(s, to);
    l.spared += l.cost - cost;
    state_.forecast -= double(l.cost - cost);
    l.cost = cost;
    l.cap = to;
    l.cap_age = 0;
    --left;
  }
}

template <class T>
void BudgetController<T>::raise(std::span<const std::unique_ptr<CharacterState<T>>> states, double limit,
                                double dwell) {
  int left = 1 + static_cast<int>(order_.size()) / kShare;
  for (auto n = order_.rbegin(); n != order_.rend() && left > 0; ++n) {
    LevelState& l = states[*n]->levels;
    if (l.cap == Level::kSubsteps || double(l.cap_age) < dwell) continue;
    if (state_.forecast + double(l.spared) > kAim * limit) return;
    state_.forecast += double(l.spared);
    l.spared = 0;
    l.cap = Level::kSubsteps;
    l.cap_age = 0;
    --left;
  }
}

template <class T>
void BudgetController<T>::update(std::span<const std::unique_ptr<CharacterState<T>>> states,
                                 const LevelOfDetail& detail, T h, WorldReport& report) {
  const auto share = static_cast<float>(std::min(1.0, double(h) / kSmoothing));
  report = {};
  double work = 0;
  state_.forecast = 0;
  for (const auto& s : states) {
    LevelState& l = s->levels;
    if (s->parked) continue;
    report.cost += l.spent;
    work += l.work;
    l.cost =
        l.cost > 0 ? l.cost + share * (static_cast<float>(l.spent) - l.cost) : static_cast<float>(l.spent);
    state_.forecast += double(l.cost);
    if (s->is_prop) continue;
    ++report.characters[static_cast<std::size_t>(l.level)];
    if (l.cap == Level::kSubsteps) continue;
    ++report.capped;
    // Back on its clip, it would only be checked again.
    if (s->undisturbed())
      l.spared = std::min(l.spared, state_.scale * static_cast<float>(work_of(*s, Level::kChecked)) - l.cost);
  }
  report.forecast = state_.forecast;
  if (work > 0) state_.scale += share * (static_cast<float>(report.cost / work) - state_.scale);
  const double limit = detail.budget.limit;
  if (limit <= 0) return;
  state_.over = state_.forecast > limit ? state_.over + 1 : 0;
  state_.under = state_.forecast < kWellBelow * limit ? state_.under + 1 : 0;
  const bool lowers = state_.over >= kOverSteps, raises = state_.under >= kUnderSteps && report.capped > 0;
  if (!lowers && !raises) return;
  order_.clear();
  for (std::size_t n = 0; n < states.size(); ++n)
    if (!states[n]->is_prop && !states[n]->parked) order_.push_back(static_cast<int>(n));
  std::sort(order_.begin(), order_.end(), [&](int a, int b) {
    const double one = states[a]->detail.significance, two = states[b]->detail.significance;
    return one != two ? one < two : a < b;
  });
  if (lowers)
    lower(states, limit);
  else
    raise(states, limit, detail.dwell);
}

SINEW_LEVEL_INSTANCES(template, float)
SINEW_LEVEL_INSTANCES(template, double)

}  // namespace sinew
