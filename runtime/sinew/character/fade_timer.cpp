#include "sinew/character/fade_timer.h"

#include <algorithm>
#include <cmath>

#include "sinew/character/spare_acceleration.h"
#include "sinew/character/world_impl.h"

namespace sinew {
namespace {

constexpr double kLonger = 1.3;     ///< of one duration to the next that is tried
constexpr double kUnlimited = 1e6;  ///< rad/s²
constexpr double kRounding = 1e-3;  ///< of a limit: less is no reason to take longer
/// Parts of the duration at which the fading of a resting offset accelerates most: (3 ∓ √3)/6.
constexpr double kPeaks[] = {0.21132486540518713, 0.78867513459481287};

}  // namespace

template <class T>
FadeTimer<T>::FadeTimer(World<T>& world, int character)
    : world_(world), character_(world.character(character)) {
  const CharacterState<T>* s = state_of(character_);
  if (!s) return;
  const int points = static_cast<int>(s->rig->support.points.size());
  memory_.resize(CheckScratch<T>::bytes(s->tree.bodies, s->tree.bodies, points));
  jets_.resize(s->local.size());
  for (std::vector<T>* dofs : {&torque_, &left_, &begun_, &there_}) dofs->resize(std::size_t(s->tree.dofs));
  for (std::vector<T>* joints : {&inertia_, &spare_}) joints->resize(s->local.size());
}

/// What each muscle has left of its limit, N·m; below 0 where it is asked for more. None: infinite.
template <class T>
void FadeTimer<T>::ask(std::span<const JointJet<T>> jets, std::span<T> left) {
  const CharacterState<T>& s = *state_of(character_);
  const auto& impl = WorldInternals<T>::of(world_);
  const WorldSettings& world = impl.settings;
  const CheckScratch<T> scratch(memory_.data(), s.tree.bodies, s.tree.bodies,
                                static_cast<int>(s.rig->support.points.size()));
  const Standing<T> standing{stands<T>(s, world, impl.plan, nullptr) ? impl.plan.support : nullptr,
                             s.rig->support, T(world.ground_height), T(world.ground_friction),
                             s.grounded() ? T(s.total_mass * world.gravity.norm()) : T(0)};
  check_motion<T>(s.tree, jets.first(std::size_t(s.tree.bodies)), world.gravity.template cast<T>(), standing,
                  scratch, std::span<T>(torque_));
  const JointLaw<T>& law = s.problem.law;
  for (int dof = 0; dof < s.tree.dofs; ++dof) {
    const int body = s.tree.dof_body[dof];
    const T most = law.limit(dof, torque_[dof]);
    const bool limited = s.tree.type[body] != JointType::kFree && most > T(0) && std::isfinite(most);
    left[dof] = limited ? most * (T(1) - law.load(s.tree, body, dof, torque_)) : T(kUnlimited);
  }
}

/// The motion at an instant of the transition, as if the one gone to stood still in what it does.
template <class T>
void FadeTimer<T>::show(const FadeQuestion<T>& question, T elapsed, T duration) {
  InertialState<T> state = *question.offset;
  state.elapsed = elapsed;
  state.duration = duration;
  (void)InertializeJob<T>{question.destination, &state, {}, jets_}.Run();
}

template <class T>
bool FadeTimer<T>::confirms(const FadeQuestion<T>& question, T duration) {
  const JointLaw<T>& law = state_of(character_)->problem.law;
  show(question, T(0), duration);
  ask(jets_, begun_);
  for (const double peak : kPeaks) {
    show(question, T(peak) * duration, duration);
    ask(jets_, there_);
    for (std::size_t dof = 0; dof < left_.size(); ++dof) {
      if (!(left_[dof] > T(0)) || left_[dof] == T(kUnlimited)) continue;
      const T begins = std::max(T(0), left_[dof] - begun_[dof]);
      const T rounding = T(kRounding) * law.limit(static_cast<int>(dof), torque_[dof]);
      if (left_[dof] - there_[dof] > question.budget * left_[dof] + begins + rounding) return false;
    }
  }
  return true;
}

template <class T>
T FadeTimer<T>::duration(const FadeQuestion<T>& question) {
  tried_ = 0;
  const CharacterState<T>* s = state_of(character_);
  if (!s || !question.offset || question.destination.size() < jets_.size() ||
      std::size_t(question.offset->joints) < jets_.size())
    return question.most;
  ask(question.destination, left_);
  carried_inertia<T>(character_, inertia_);
  for (std::size_t j = 0; j < spare_.size(); ++j) {
    T least = T(kUnlimited);
    for (int dof = 0; dof < s->tree.dofs; ++dof)
      if (std::size_t(s->tree.dof_body[dof]) == j) least = std::min(least, left_[dof]);
    const bool limited = least < T(kUnlimited) && inertia_[j] > T(0);
    spare_[j] = limited ? std::max(T(1e-3), question.budget * least / inertia_[j]) : T(kUnlimited);
  }
  T duration = inertial_duration<T>(*question.offset, spare_, question.least, question.most);
  for (tried_ = 1; duration < question.most && !confirms(question, duration); ++tried_)
    duration = std::min(question.most, T(kLonger) * duration);
  return duration;
}

template class FadeTimer<float>;
template class FadeTimer<double>;

}  // namespace sinew
