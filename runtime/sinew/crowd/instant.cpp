#include "sinew/crowd/instant.h"

#include <algorithm>

#include "sinew/animation/clip_place.h"
#include "sinew/animation/kernels/layout.h"

namespace sinew {
namespace {

using crowd_kernels::Instant;
using crowd_kernels::TrackGroup;

/// Knots and controls of one lane's groups. `alike`: the first of those that an earlier lane has of the same
/// clip, or null.
void add_groups(const Clip& clip, const ClipPlace& at, int lane, TrackGroup* alike, Instant& instant) {
  const Clip::Group* last = nullptr;
  KnotPlace knots;
  float scale = 0, bend = 0;
  for (const Clip::Group& group : clip.groups) {
    if (group.tracks.empty()) continue;
    if (!last || !same_knots(*last, group)) {
      knots = KnotPlace(clip, group, at.time);
      scale = float(at.rate / group.knot_interval);
      bend = float(at.acceleration / group.knot_interval);
      last = &group;
    }
    instant.u[instant.group_count] = float(knots.u);
    instant.scale[instant.group_count] = scale;
    instant.bend[instant.group_count] = bend;
    TrackGroup& out = instant.group[instant.group_count++];
    control_rows(group, knots.first, out.rows);
    out.joints = &group.tracks.data()->joint;
    out.tracks = int(group.tracks.size());
    out.degree = group.degree;
    out.lane = lane;
    out.lanes = 0;
    (alike ? *alike++ : out).lanes |= 1u << lane;
    out.rotation = group.rotation;
  }
}

}  // namespace

bool sampled_in_batches(const CrowdTrack& track) {
  return track.clip && track.clip->groups.size() <= crowd_kernels::kMaxGroups;
}

void set_instant(std::span<const CrowdTrack> lanes, std::span<const std::uint8_t> takes_part,
                 Instant& instant) {
  int shown = 0;
  while (!takes_part[shown]) ++shown;
  instant.group_count = 0;
  const Clip* clips[crowd_kernels::kMaxLanes];  // met so far, and the first lane's groups of each
  TrackGroup* groups[crowd_kernels::kMaxLanes];
  int clip_count = 0;
  for (int lane = 0; lane < int(lanes.size()); ++lane) {
    if (takes_part[lane]) shown = lane;
    const CrowdTrack& track = lanes[shown];
    const Clip& clip = *track.clip;
    const ClipPlace at(clip, track.time);
    if (shown == lane) {
      const int known = int(std::find(clips, clips + clip_count, &clip) - clips);
      if (known == clip_count) {
        clips[clip_count] = &clip;
        groups[clip_count++] = nullptr;
      }
      TrackGroup* const begin = instant.group + instant.group_count;
      add_groups(clip, at, lane, groups[known], instant);
      if (!groups[known]) groups[known] = begin;
    }
    instant.shows[lane] = shown;
    instant.constants[lane] = kernels::layout(clip.constants.data());
    const bool moves_on = clip.loops && clip.duration > 0;
    const Vec3<float> none = Vec3<float>::Constant(-0.f);
    const Vec3<float> shift = moves_on ? at.shift(clip).cast<float>().eval() : none;
    const Vec3<float> drift = moves_on ? at.drift(clip, at.rate).cast<float>().eval() : none;
    const Vec3<float> push = moves_on ? at.drift(clip, at.acceleration).cast<float>().eval() : none;
    for (int a = 0; a < 3; ++a) {
      instant.shift[a][lane] = shift[a];
      instant.drift[a][lane] = drift[a];
      instant.push[a][lane] = push[a];
      instant.place[a][lane] = track.place.translation[a];
    }
    for (int a = 0; a < 4; ++a) instant.turn[a][lane] = track.place.rotation.coeffs()[a];
  }
}

}  // namespace sinew
