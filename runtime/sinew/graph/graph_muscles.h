// What a graph asks of the muscles of its character: how long transitions with a budget are to be.
#pragma once

#include "sinew/animation/fade_question.h"

namespace sinew {

/// The host's answer to that; FadeTimer (character/fade_timer.h) has one:
///
///     job.muscles = {sinew::FadeTimer<float>::answer, &timer};
template <class T>
struct GraphMuscles {
  /// s, within question.least and question.most; what is not is moved there. Null: question.most.
  T (*duration)(void* host, const FadeQuestion<T>& question) = nullptr;
  void* host = nullptr;  ///< what it gets
};

}  // namespace sinew
