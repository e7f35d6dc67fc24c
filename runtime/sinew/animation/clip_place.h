// Where an instant falls among a clip's knots. Internal to samplers.
#pragma once

#include <algorithm>
#include <cmath>

#include "sinew/animation/clip.h"
#include "sinew/animation/clip_time.h"

namespace sinew {

/// A time within the clip, how many whole loops came before it, and how it passes there: not at all where a
/// pose is held before the beginning or after the end.
struct ClipPlace {
  double time = 0;          ///< s, 0 … duration
  double loops = 0;         ///< whole ones
  double rate = 0;          ///< of playback
  double acceleration = 0;  ///< 1/s

  ClipPlace(const Clip& clip, const ClipTime& when) : rate(when.rate), acceleration(when.acceleration) {
    const double at = when.value;
    if (clip.loops && clip.duration > 0) {
      loops = std::floor(at / clip.duration);
      time = std::clamp(at - loops * clip.duration, 0.0, double(clip.duration));
    } else if (!clip.loops) {
      time = std::clamp(at, 0.0, double(clip.duration));
      if (at < 0 || at > clip.duration) rate = acceleration = 0;
    }
  }

  /// What whole and broken loops have added to the root's translation (m), and what they add to its velocity
  /// (m/s) by the rate of time and to its acceleration (m/s²) by that rate's. Only of clips that loop and
  /// last.
  Vec3<double> shift(const Clip& clip) const {
    return clip.root_step.cast<double>() * (loops + time / clip.duration);
  }
  Vec3<double> drift(const Clip& clip, double by) const {
    return clip.root_step.cast<double>() * (by / clip.duration);
  }
};

/// Whether a place falls on the same span of both groups, at the same parameter.
inline bool same_knots(const Clip::Group& a, const Clip::Group& b) {
  return a.knot_interval == b.knot_interval && a.control_count == b.control_count && a.degree == b.degree;
}

/// The knot span of one group around a time: its first control and the parameter within it, 0 … 1.
struct KnotPlace {
  int first = 0;
  double u = 0;

  KnotPlace() = default;
  KnotPlace(const Clip& clip, const Clip::Group& group, double time) {
    const double knots = time / group.knot_interval;
    const int spans = clip.loops ? group.control_count : group.control_count - group.degree;
    first = std::clamp(static_cast<int>(knots), 0, spans - 1);
    u = std::clamp(knots - first, 0.0, 1.0);
  }
};

/// Puts the addresses of the degree + 1 rows of controls that a span needs into `rows`; a row holds the
/// controls of all tracks.
inline void control_rows(const Clip::Group& group, int first, const float** rows) {
  const std::size_t stride = (group.rotation ? 4 : 3) * group.tracks.size();
  for (int t = 0, row = first; t <= group.degree; ++t, ++row) {
    while (row >= group.control_count) row -= group.control_count;
    rows[t] = group.controls.data() + stride * std::size_t(row);
  }
}

}  // namespace sinew
