#include "sinew/animation/curve_job.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/bspline.h"
#include "sinew/animation/clip_place.h"

namespace sinew {
namespace {

constexpr int kDegree = 3;

/// A curve at a place, by the time of the clip.
template <class T>
TimeJet<T> sample(const FloatCurve& curve, bool loops, double time) {
  const int count = static_cast<int>(curve.controls.size()), spans = loops ? count : count - kDegree;
  const double knots = time / double(curve.knot_interval);
  const int first = std::clamp(static_cast<int>(knots), 0, spans - 1);
  const auto basis = BsplineBasis<T>::at(kDegree, T(std::clamp(knots - first, 0.0, 1.0)));
  TimeJet<T> sum{T(0)};
  for (int k = 0; k <= kDegree; ++k) {
    const T control = T(curve.controls[static_cast<std::size_t>((first + k) % count)]);
    sum.value += basis.value[k] * control;
    sum.rate += basis.first[k] * control;
    sum.acceleration += basis.second[k] * control;
  }
  const T knots_per_s = 1 / T(curve.knot_interval);
  return {sum.value, sum.rate * knots_per_s, sum.acceleration * knots_per_s * knots_per_s};
}

template <class T>
bool is_finite(const TimeJet<T>& x) {
  return std::isfinite(x.value) && std::isfinite(x.rate) && std::isfinite(x.acceleration);
}

template <class T>
TimeJet<T> blended(std::span<const CurveLayer<T>> layers, std::size_t slot, T rest) {
  const auto weight = [&](const CurveLayer<T>& layer) {
    return layer.mask.empty() ? layer.weight : layer.mask[slot] * layer.weight;
  };
  TimeJet<T> sum{T(0)}, weights{T(0)}, only{rest};
  int mixed = 0;
  for (const CurveLayer<T>& layer : layers) {
    if (layer.mode != BlendMode::kMix || slot >= layer.values.size()) continue;
    const TimeJet<T> w = weight(layer);
    if (w.value == T(0) && w.rate == T(0) && w.acceleration == T(0)) continue;
    if (w.value > T(0)) only = layer.values[slot];
    sum += w * layer.values[slot];
    weights += w;
    ++mixed;
  }
  TimeJet<T> below = mixed > 1 && weights.value > T(0) ? sum / weights : only;  // one alone keeps its bits
  for (const CurveLayer<T>& layer : layers) {
    if (layer.mode == BlendMode::kMix || slot >= layer.values.size()) continue;
    const TimeJet<T> w = weight(layer);
    if (layer.mode == BlendMode::kAdditive)
      below += w * layer.values[slot];
    else
      below = (TimeJet<T>(T(1)) - w) * below + w * layer.values[slot];
  }
  return below;
}

}  // namespace

template <class T>
Status CurveJob<T>::Validate() const {
  if (!clip) return Status::error(Code::kInvalidArgument, "no clip");
  if (!is_finite<double>(time)) return Status::error(Code::kNotFinite, "time is not finite");
  return {};
}

template <class T>
Status CurveJob<T>::Run() const {
  if (Status status = Validate(); !status) return status;
  const std::size_t count = std::min(slots.size(), values.size());
  for (std::size_t i = 0; i < count; ++i) values[i] = TimeJet<T>(T(slots[i].rest));
  const ClipPlace place(*clip, time);
  const T rate = T(place.rate), change = T(place.acceleration);
  for (const FloatCurve& curve : clip->curves) {
    if (static_cast<std::size_t>(curve.slot) >= count) continue;
    const TimeJet<T> at = sample<T>(curve, clip->loops, place.time);
    values[static_cast<std::size_t>(curve.slot)] = {at.value, rate * at.rate,
                                                    rate * rate * at.acceleration + change * at.rate};
  }
  return {};
}

template <class T>
Status CurveBlendingJob<T>::Validate() const {
  for (std::size_t l = 0; l < layers.size(); ++l) {
    const int index = static_cast<int>(l);
    if (!is_finite(layers[l].weight)) return Status::error(Code::kNotFinite, "weight is not finite", index);
    if (layers[l].weight.value < T(0)) return Status::error(Code::kOutOfRange, "weight is negative", index);
    if (!layers[l].mask.empty() && layers[l].mask.size() < out.size())
      return Status::error(Code::kInvalidArgument, "mask is shorter than the output", index);
    const auto beyond = [](T m) { return !(m >= T(0) && m <= T(1)); };
    if (std::any_of(layers[l].mask.begin(), layers[l].mask.end(), beyond))
      return Status::error(Code::kOutOfRange, "mask is not within 0 and 1", index);
  }
  return {};
}

template <class T>
Status CurveBlendingJob<T>::Run() const {
  if (Status status = Validate(); !status) return status;
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = blended<T>(layers, i, i < slots.size() ? T(slots[i].rest) : T(0));
  return {};
}

template struct CurveJob<float>;
template struct CurveJob<double>;
template struct CurveBlendingJob<float>;
template struct CurveBlendingJob<double>;

}  // namespace sinew
