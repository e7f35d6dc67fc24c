// What of a force is smooth in time, so that the next step may begin with what it does (bossak.h): all, while
// nothing has begun or ceased to bear; else as far as it has lasted. The rest was an impulse.
#pragma once

#include <algorithm>

#include "sinew/skeleton/vector.h"

namespace sinew {

/// A force that has just come acts on a body by κh² of its acceleration in the step, not by ½h² as one that
/// was there: it is as much larger. What it would be if it lasted; `share` = 2κ (bossak.h), `carried` what of
/// it the accelerations held when the step began.
template <class T>
T lasting(T force, T carried, T share) {
  return share * force + (1 - share) * carried;
}

/// The lesser of what is and twice what was in each of two steps, where all have its sign: a limiter, as of
/// slopes in finite volumes. What it takes away has just come, or goes.
template <class T>
T limited(T now, T last, T before) {
  if (now < T(0)) return -limited(-now, -last, -before);
  return std::clamp(2 * std::min(last, before), T(0), now);
}

/// The most that a force which lasts may be; what of it leaps beyond is an impulse. What is driven may begin
/// to move from one step to the next, and strikes what rests on it: carried on, such a force threw a box off
/// a lift at three times the lift's speed. Twice what it was: of a stack on such a lift the fastest has 1.13
/// of its speed, with thrice 1.25; with the lesser of the two steps, crossed planks come to rest more slowly.
template <class T>
T most_of_lasting(T last, T before) {
  return 2 * std::max(last, before);
}

/// A force in space, with what of it is carried from step to step; N, world axes.
template <class T>
struct CarriedForce {
  Vec3<T> smooth = Vec3<T>::Zero();  ///< at the end of the last step
  Vec3<T> last = Vec3<T>::Zero(),
          before = Vec3<T>::Zero();  ///< lasting(), of the last step and the one before

  /// After a step that leaves the force `now`: by its parts along it. `lasts`: all of it is smooth.
  void advance(const Vec3<T>& now, bool lasts, T share) {
    const Vec3<T> lasting_now = share * now + (1 - share) * smooth;
    const T size = now.norm();
    smooth = now;
    if (!lasts && size > T(0)) {
      const Vec3<T> along = now / size;
      const T most = limited(along.dot(lasting_now), along.dot(last), along.dot(before));
      smooth = std::clamp(most, T(0), size) * along;
    }
    before = last;
    last = lasting_now;
  }
  /// It has been `force` since long.
  void begin(const Vec3<T>& force) { smooth = last = before = force; }
};

}  // namespace sinew
