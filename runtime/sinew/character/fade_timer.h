// Transitions as long as a character's muscles need.
//
//     sinew::FadeTimer<float> timer(world, hero);                           // set-up
//     job.muscles = {sinew::FadeTimer<float>::answer, &timer};              // GraphStepJob
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sinew/animation/fade_question.h"
#include "sinew/character/world.h"

namespace sinew {

/// Answers FadeQuestion for one character of a world. What its muscles can spare is their limits of this
/// moment (strength applied) less what the motion gone *to* asks of them: a residual pass, with the world's
/// level floor bearing what stands on it. The duration that follows from that and from what hangs on each
/// joint (inertial_duration()) counts each joint alone; so the motion is made for the two instants at which
/// an offset's acceleration is greatest, and asked of all muscles together. Where one gives more than its
/// budget there, and more than at the change itself, which no duration alters, the transition becomes longer
/// by 1.3, until it is confirmed or as long as it may be. Muscles that the motion gone to overloads by itself
/// are not asked.
template <class T>
class FadeTimer {
 public:
  /// Set-up: allocates. World and character must outlive it; one that there is not answers `most`.
  FadeTimer(World<T>& world, int character);

  /// s. Allocates nothing; not by two threads at once. Cost: a residual pass, and for each of at most nine
  /// durations that are tried two more.
  T duration(const FadeQuestion<T>& question);
  /// Of the last question: durations that were tried, 1 where the first was confirmed.
  int tried() const { return tried_; }

  /// For GraphMuscles::duration; `host`: a FadeTimer<T>.
  static T answer(void* host, const FadeQuestion<T>& question) {
    return static_cast<FadeTimer*>(host)->duration(question);
  }

 private:
  void ask(std::span<const JointJet<T>> jets, std::span<T> left);
  bool confirms(const FadeQuestion<T>& question, T duration);
  void show(const FadeQuestion<T>& question, T elapsed, T duration);

  World<T>& world_;
  Character<T> character_;
  int tried_ = 0;
  std::vector<std::byte> memory_;        ///< of the residual pass
  std::vector<JointJet<T>> jets_;        ///< [joint] of an instant of the transition
  std::vector<T> torque_;                ///< [dof] N·m
  std::vector<T> left_, begun_, there_;  ///< [dof] N·m, of the motion gone to, of the change, of an instant
  std::vector<T> inertia_, spare_;       ///< [joint] kg·m², rad/s²
};

extern template class FadeTimer<float>;
extern template class FadeTimer<double>;

}  // namespace sinew
