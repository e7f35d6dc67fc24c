#include "sinew/animation/sampling_job.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/bspline.h"
#include "sinew/animation/clip_place.h"
#include "sinew/animation/kernels/layout.h"

namespace sinew {
namespace {

using kernels::SplineSpan;

static_assert(sizeof(Clip::Track) == sizeof(int), "kernels read tracks as joint indices");

/// Weights of the control points within reach of a place, differentiated by the chain rule.
template <class T>
SplineSpan<T> weights_at(const Clip::Group& group, const KnotPlace& place, const ClipPlace& at) {
  const BsplineBasis<T> w = BsplineBasis<T>::at(group.degree, T(place.u));
  const T scale = T(at.rate / group.knot_interval), bend = T(at.acceleration / group.knot_interval);
  SplineSpan<T> span;
  span.terms = group.degree + 1;
  for (int t = 0; t <= BsplineBasis<T>::kMaxDegree; ++t) {  // all of them: a loop of known length
    span.value[t] = w.value[t];
    span.first[t] = scale * w.first[t];
    span.second[t] = scale * scale * w.second[t] + bend * w.first[t];
  }
  return span;
}

/// Samples all groups at a place. Groups of like knots that follow each other share their weights.
template <class T, class Out>
void sample(const Clip& clip, const ClipPlace& at, std::span<Out> out) {
  const auto* still = kernels::layout(clip.constants.data());
  SINEW_DISPATCH(constants(still, static_cast<int>(out.size()), out.data()));
  const Clip::Group* last = nullptr;
  KnotPlace place;
  SplineSpan<T> span;
  for (const Clip::Group& group : clip.groups) {
    if (group.tracks.empty()) continue;
    if (!last || !same_knots(*last, group)) {
      place = KnotPlace(clip, group, at.time);
      span = weights_at<T>(group, place, at);
      last = &group;
    }
    span.joint_end = static_cast<int>(out.size());
    control_rows(group, place.first, span.rows);
    span.joints = &group.tracks.data()->joint;
    span.tracks = static_cast<int>(group.tracks.size());
    if (group.rotation)
      SINEW_DISPATCH(rotations(span, out.data()));
    else
      SINEW_DISPATCH(translations(span, out.data()));
  }
}

}  // namespace

template <class T>
Status SamplingJob<T>::Validate() const {
  if (!clip) return Status::error(Code::kInvalidArgument, "no clip");
  if (!std::isfinite(time.value) || !std::isfinite(time.rate) || !std::isfinite(time.acceleration))
    return Status::error(Code::kNotFinite, "time or its rates are not finite");
  if (std::abs(time.value) > 1e9 || std::abs(time.rate) > 1e4 || std::abs(time.acceleration) > 1e7)
    return Status::error(Code::kOutOfRange, "time or its rates are absurd");
  return {};
}

template <class T>
Status SamplingJob<T>::Run() const {
  if (Status status = Validate(); !status) return status;
  const std::span<JointJet<T>> moving = jets.first(std::min(jets.size(), std::size_t(clip->joint_count)));
  const std::span<Transform<T>> still = poses.first(std::min(poses.size(), std::size_t(clip->joint_count)));
  const ClipPlace place(*clip, time);
  if (!moving.empty()) sample<T>(*clip, place, std::span(kernels::layout(moving.data()), moving.size()));
  if (!still.empty()) sample<T>(*clip, place, std::span(kernels::layout(still.data()), still.size()));
  if (clip->loops && clip->duration > 0) {
    const Vec3<T> shift = place.shift(*clip).template cast<T>();
    if (!still.empty()) still[0].translation += shift;
    if (!moving.empty()) {
      moving[0].translation += shift;
      moving[0].velocity += place.drift(*clip, place.rate).template cast<T>();
      moving[0].acceleration += place.drift(*clip, place.acceleration).template cast<T>();
    }
  }
  return {};
}

template struct SamplingJob<float>;
template struct SamplingJob<double>;

}  // namespace sinew
