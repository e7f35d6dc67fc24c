#include "sinew/crowd/instant.h"

#include "sinew/animation/clip_place.h"
#include "sinew/animation/kernels/layout.h"

namespace sinew {
namespace {

using crowd_kernels::Instant;
using crowd_kernels::TrackGroup;

/// Knots and controls of one lane's groups.
void add_groups(const Clip& clip, const ClipPlace& at, int lane, Instant& instant) {
  for (const Clip::Group& group : clip.groups) {
    if (group.tracks.empty()) continue;
    const KnotPlace knots(clip, group, at.time);
    instant.u[instant.group_count] = float(knots.u);
    instant.scale[instant.group_count] = float(at.speed / group.knot_interval);
    TrackGroup& out = instant.group[instant.group_count++];
    control_rows(group, knots.first, out.rows);
    out.joints = &group.tracks.data()->joint;
    out.tracks = int(group.tracks.size());
    out.degree = group.degree;
    out.lane = lane;
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
  for (int lane = 0; lane < int(lanes.size()); ++lane) {
    if (takes_part[lane]) shown = lane;
    const CrowdTrack& track = lanes[shown];
    const Clip& clip = *track.clip;
    const ClipPlace at(clip, track.time, track.rate);
    if (shown == lane) add_groups(clip, at, lane, instant);
    instant.shows[lane] = shown;
    instant.constants[lane] = kernels::layout(clip.constants.data());
    const bool moves_on = clip.loops && clip.duration > 0;
    const Vec3<float> none = Vec3<float>::Constant(-0.f);
    const Vec3<float> shift = moves_on ? at.shift(clip).cast<float>().eval() : none;
    const Vec3<float> drift = moves_on ? at.drift(clip).cast<float>().eval() : none;
    for (int a = 0; a < 3; ++a) {
      instant.shift[a][lane] = shift[a];
      instant.drift[a][lane] = drift[a];
      instant.place[a][lane] = track.place.translation[a];
    }
    for (int a = 0; a < 4; ++a) instant.turn[a][lane] = track.place.rotation.coeffs()[a];
  }
}

}  // namespace sinew
