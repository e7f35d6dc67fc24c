// A body in the air, and how it lands: its feet hang below where it will come down, its legs give in to what
// it fell and come up again as a critically damped spring does, so slowly that nothing throws it up.
#include <algorithm>
#include <cmath>
#include <utility>

#include "sinew/behaviour/behaviour.h"

namespace sinew {
namespace {

// Of a human.
constexpr double kFlies = 0.05;     ///< s that nothing bears it, from which it flies
constexpr double kHops = 0.1;       ///< s, likewise of who steps: some steps are leaps
constexpr double kFree = 0.25;      ///< of what a step of free fall adds to its speed
constexpr double kTucked = 0.05;    ///< m, that legs are shorter than its animation's: knees that may bend
constexpr double kAhead = 0.3;      ///< m, that feet are ahead of it at most
constexpr double kObserved = 0.05;  ///< s, in which a plan's height comes to that of its body

}  // namespace

/// Whether the last step was free fall: who hangs on something does not fly.
template <class T>
void Behaviour<T>::see_flight(double h) {
  const double before = std::exchange(rises_, last_step_.momentum.z() / body_.total_mass);
  const bool falls = rises_ - before < -kFree * h * settings_.gravity;
  const bool alone = last_step_.root_unknown && !(last_step_.ground.force > 0);
  airborne_ = alone && falls ? airborne_ + h : 0;
}

/// Who walks comes down in his next step.
template <class T>
bool Behaviour<T>::flies() const {
  const double hops = report_.state == BehaviourState::kStep ? kHops : kFlies;
  return airborne_ > hops * std::sqrt(unit_) && !clip_walks();
}

/// Nothing that it does moves its centre of mass.
template <class T>
void Behaviour<T>::fly(const MeasuredBody& is, std::span<const JointJet<T>> jets, double h) {
  if (landing_ != Landing::kInAir) {
    begin_plan(is, jets);
    walks_ = false;
    landing_ = Landing::kInAir;
  }
  plan_ = {from_above(is.mass.place) + h * from_above(is.mass.velocity), from_above(is.mass.velocity)};
  const double g = settings_.gravity, falls = is.mass.velocity.z();
  height_ = {is.root.translation.z() - double(jets[0].translation.z()) + h * falls - h * h / 2 * g,
             falls - h * g, -g};
  move_trunk(h);
}

/// Feet as its animation has them, below where its capture point will be when they bear it.
template <class T>
void Behaviour<T>::write_flight(std::span<JointJet<T>> jets) {
  Stance stance = planned();
  stance.height = height_;
  Vec2 ahead = plan_.velocity / frequency_;
  if (const double far = ahead.norm(); far > kAhead * unit_) ahead *= kAhead * unit_ / far;
  for (std::size_t side = 0; side < 2; ++side) {
    const Vec2 place = plan_.place + clip_foot_[side] + ahead;
    for (int a = 0; a < 2; ++a) stance.ankle[side][a] = {place[a], plan_.velocity[a], 0.0};
    stance.ankle[side][2] = TimeJet<double>(clip_ankle_[side].translation.z() + kTucked * unit_) + height_;
    stance.foot[side] = clip_ankle_[side].rotation;
  }
  take_stance<T>(body_, stance, jets, model_);
}

/// Something bears it again: the plan goes on from what it does.
template <class T>
void Behaviour<T>::land(const MeasuredBody& is, std::span<const JointJet<T>> jets) {
  begin_plan(is, jets);
  height_.rate = is.mass.velocity.z();
  landing_ = Landing::kLands;
}

/// Legs that can't do what the plan asks for give in further: it goes on from there.
template <class T>
void Behaviour<T>::give_in(const MeasuredBody& is, const JointJet<T>& root) {
  const double height = is.root.translation.z() - double(root.translation.z());
  const double off = height - height_.value, faster = is.mass.velocity.z() - height_.rate,
               time = kObserved * std::sqrt(unit_);
  yields_ = last_step_.root_unknown ? off / (time * time) + 2 * faster / time : 0;
}

#define SINEW_LAND_INSTANCES(T)                                                               \
  template void Behaviour<T>::see_flight(double);                                             \
  template bool Behaviour<T>::flies() const;                                                  \
  template void Behaviour<T>::fly(const MeasuredBody&, std::span<const JointJet<T>>, double); \
  template void Behaviour<T>::write_flight(std::span<JointJet<T>>);                           \
  template void Behaviour<T>::land(const MeasuredBody&, std::span<const JointJet<T>>);        \
  template void Behaviour<T>::give_in(const MeasuredBody&, const JointJet<T>&);
SINEW_LAND_INSTANCES(float)
SINEW_LAND_INSTANCES(double)

}  // namespace sinew
