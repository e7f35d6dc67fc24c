// The clips of one batch of characters at their instants: one lane per character, one source, compiled for
// every instruction set, under the terms of effects/kernels/check.h. Lanes may play different clips, with
// other joints moving on other knots.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sinew/effects/kernels/check.h"

namespace sinew::crowd_kernels {

using check_kernels::kJetNumbers, check_kernels::kMaxLanes;
constexpr int kMaxGroups = 8;  ///< of one clip; a batch that plays one with more is sampled lane by lane

/// One group of tracks of one lane's clip at its instant.
struct TrackGroup {
  const float* rows[6] = {};    ///< [term] controls of all tracks, [track][component]
  const int* joints = nullptr;  ///< [track]
  int tracks = 0;
  int degree = 3;  ///< or 5
  int lane = 0;
  std::uint32_t lanes = 0;  ///< bits of all that play this clip, in the first of them; 0 in the others
  bool rotation = true;
};

/// What the lanes of a batch play at this instant.
struct Instant {
  static constexpr int kGroups = kMaxLanes * kMaxGroups;
  int group_count = 0;
  TrackGroup group[kGroups];  ///< of all lanes, in the order of their clips
  float u[kGroups];           ///< parameter of the group's span, 0 … 1
  float scale[kGroups];       ///< playback rate / knot interval, 1/s
  float bend[kGroups];        ///< how that rate changes / knot interval, 1/s²
  /// [lane] the lane whose clip it shows: itself, or another where it does not take part.
  int shows[kMaxLanes];
  const kernels::PoseLayout<float>* constants[kMaxLanes];  ///< [lane] → [joint]
  float shift[3][kMaxLanes];                               ///< added to the root's translation (m), and
  float drift[3][kMaxLanes];                               ///< to its velocity (m/s)
  float push[3][kMaxLanes];                                ///< and acceleration (m/s²); −0 changes no bit
  float turn[4][kMaxLanes];                                ///< clip → world, x y z w
  float place[3][kMaxLanes];                               ///< m
};

/// Where the jets of a batch go.
struct JetRows {
  float* rows = nullptr;    ///< [joint][kJetNumbers][lane] local, the root's in the world; aligned to 64
  int joints = 0;           ///< of the rig
  int bodies = 0;           ///< joints from here on get rotation and translation only, and
  int posed = 0;            ///< from here on nothing
  void* scratch = nullptr;  ///< sample_scratch_bytes(), aligned to 64
};

constexpr std::size_t row_bytes(int joints) {
  return std::size_t(joints) * kJetNumbers * kMaxLanes * sizeof(float);
}

/// Control points summed up, of one track.
struct TrackSum {
  float value[4], rate[4], acceleration[4];
};

/// Weights of the groups, and for every joint which lanes' clips move it, and their sums.
constexpr std::size_t sample_scratch_bytes(int joints) {
  return 3 * 6 * Instant::kGroups * sizeof(float) +
         std::size_t(joints) * (2 * sizeof(std::uint32_t) + 2 * kMaxLanes * sizeof(TrackSum));
}

#define SINEW_SAMPLE_KERNELS                                \
  void sample8(const Instant& instant, const JetRows& out); \
  void sample16(const Instant& instant, const JetRows& out);
namespace baseline {
SINEW_SAMPLE_KERNELS
}
namespace avx2 {
SINEW_SAMPLE_KERNELS
}
namespace avx512 {
SINEW_SAMPLE_KERNELS
}

}  // namespace sinew::crowd_kernels
