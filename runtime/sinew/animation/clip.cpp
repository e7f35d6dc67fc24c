#include "sinew/animation/clip.h"

#include <cmath>

namespace sinew {
namespace {

/// Samplers take constants as they are, so they must be unit to float's rounding.
bool is_unit(const Quat<float>& q) {
  return std::abs(q.norm() - 1.f) < 1e-6f;
}

Status check_group(const Clip& clip, const Clip::Group& group, int index) {
  const std::size_t components = group.rotation ? 4 : 3;
  if (group.degree != 3 && group.degree != 5)
    return Status::error(Code::kInvalidArgument, "degree is neither 3 nor 5", index);
  if (!std::isfinite(group.knot_interval) || group.knot_interval <= 0)
    return Status::error(Code::kInvalidArgument, "knot interval is not positive", index);
  if (group.control_count < (clip.loops ? 1 : group.degree + 1))
    return Status::error(Code::kInvalidArgument, "too few control points", index);
  const double covered = group.knot_interval * double(group.control_count - (clip.loops ? 0 : group.degree));
  if (covered < clip.duration * (1 - 1e-4))
    return Status::error(Code::kInvalidArgument, "knots end before the clip", index);
  if (group.controls.size() != components * group.tracks.size() * std::size_t(group.control_count))
    return Status::error(Code::kInvalidArgument, "number of controls does not match tracks and knots", index);
  if (!group.packings.empty() && group.packings.size() != group.tracks.size())
    return Status::error(Code::kInvalidArgument, "number of packings does not match tracks", index);
  for (const Clip::Track& track : group.tracks)
    if (track.joint < 0 || track.joint >= clip.joint_count)
      return Status::error(Code::kInvalidArgument, "track of a joint that does not exist", index);
  for (const float value : group.controls)
    if (!std::isfinite(value)) return Status::error(Code::kNotFinite, "control point is not finite", index);
  return {};
}

Status check_curve(const Clip& clip, const FloatCurve& curve, int slot_before, int index) {
  if (curve.slot <= slot_before)
    return Status::error(Code::kInvalidArgument, "curves do not go by rising slots", index);
  if (!std::isfinite(curve.knot_interval) || curve.knot_interval <= 0)
    return Status::error(Code::kInvalidArgument, "knot interval of a curve is not positive", index);
  const std::size_t beyond = clip.loops ? 0 : 3;
  if (curve.controls.size() < beyond + 1)
    return Status::error(Code::kInvalidArgument, "curve has too few control points", index);
  if (double(curve.knot_interval) * double(curve.controls.size() - beyond) <
      double(clip.duration) * (1 - 1e-4))
    return Status::error(Code::kInvalidArgument, "curve ends before the clip", index);
  for (const float value : curve.controls)
    if (!std::isfinite(value)) return Status::error(Code::kNotFinite, "curve is not finite", index);
  return {};
}

/// Curves, events and markers.
Status check_data(const Clip& clip) {
  int slot = -1;
  for (std::size_t k = 0; k < clip.curves.size(); ++k) {
    if (Status status = check_curve(clip, clip.curves[k], slot, static_cast<int>(k)); !status) return status;
    slot = clip.curves[k].slot;
  }
  float begin = 0;
  for (std::size_t k = 0; k < clip.events.size(); ++k) {
    const ClipEvent& event = clip.events[k];
    if (!(event.begin >= begin && event.begin <= event.end && event.end <= clip.duration))
      return Status::error(Code::kOutOfRange, "event is not within the clip, or not in its order",
                           static_cast<int>(k));
    begin = event.begin;
  }
  if (clip.cycles < 1) return Status::error(Code::kOutOfRange, "number of cycles is not positive");
  for (std::size_t k = 0; k < clip.markers.size(); ++k) {
    const PhaseMarker& m = clip.markers[k];
    const double latest = (clip.loops ? 2 : 1) * double(clip.duration);  // the cycle begins within the loop
    if (!(m.time >= 0 && m.time <= latest) || !(m.phase >= 0 && m.phase <= clip.cycles))
      return Status::error(Code::kOutOfRange, "marker is not within the clip", static_cast<int>(k));
  }
  return {};
}

}  // namespace

Status validate(const Clip& clip) {
  if (!std::isfinite(clip.duration) || clip.duration < 0)
    return Status::error(Code::kInvalidArgument, "duration is not a time");
  if (clip.joint_count < 0 || clip.constants.size() != std::size_t(clip.joint_count))
    return Status::error(Code::kInvalidArgument, "one constant transform per joint is needed");
  for (const Transform<float>& constant : clip.constants) {
    if (!constant.rotation.coeffs().allFinite() || !constant.translation.allFinite())
      return Status::error(Code::kNotFinite, "constant transform is not finite");
    if (!is_unit(constant.rotation))
      return Status::error(Code::kInvalidArgument, "constant rotation is not a unit quaternion");
  }
  if (!clip.root_step.allFinite()) return Status::error(Code::kNotFinite, "root step is not finite");
  for (const ContactWindow& window : clip.contacts)
    if (window.joint < 0 || window.joint >= clip.joint_count || !(window.begin <= window.end))
      return Status::error(Code::kInvalidArgument, "contact window has no joint or no length");
  for (std::size_t g = 0; g < clip.groups.size(); ++g)
    if (Status status = check_group(clip, clip.groups[g], static_cast<int>(g)); !status) return status;
  return check_data(clip);
}

}  // namespace sinew
