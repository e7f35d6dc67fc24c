#include "sinew/animation/blending_job.h"

#include <cmath>

#include "sinew/animation/kernels/layout.h"

namespace sinew {
namespace {

template <class T>
Status check(const BlendLayer<T>& layer, std::size_t joints, int index) {
  if (layer.jets.size() < joints)
    return Status::error(Code::kInvalidArgument, "layer has fewer joints than the output", index);
  if (!layer.mask.empty() && layer.mask.size() < joints)
    return Status::error(Code::kInvalidArgument, "mask has fewer joints than the output", index);
  if (!layer.reference.empty() && layer.reference.size() < joints)
    return Status::error(Code::kInvalidArgument, "reference has fewer joints than the output", index);
  const TimeJet<T>& w = layer.weight;
  if (!std::isfinite(w.value) || !std::isfinite(w.rate) || !std::isfinite(w.acceleration))
    return Status::error(Code::kNotFinite, "weight is not finite", index);
  if (w.value < T(0)) return Status::error(Code::kOutOfRange, "weight is negative", index);
  bool in_range = true;
  for (std::size_t i = 0; i < joints && !layer.mask.empty(); ++i)
    in_range &= layer.mask[i] >= T(0) && layer.mask[i] <= T(1);
  if (!in_range) return Status::error(Code::kOutOfRange, "mask is not within 0 and 1", index);
  return {};
}

}  // namespace

template <class T>
Status BlendingJob<T>::Validate() const {
  if (layers.size() > kMaxLayers) return Status::error(Code::kInvalidArgument, "more than 16 layers");
  if (!rest.empty() && rest.size() < out.size())
    return Status::error(Code::kInvalidArgument, "rest pose has fewer joints than the output");
  for (std::size_t n = 0; n < layers.size(); ++n)
    if (Status status = check(layers[n], out.size(), static_cast<int>(n)); !status) return status;
  return {};
}

template <class T>
Status BlendingJob<T>::Run() const {
  using Data = kernels::BlendLayerData<T>;
  if (Status status = Validate(); !status) return status;
  Data data[kMaxLayers];
  int count = 0;
  for (const BlendLayer<T>& layer : layers) {
    const TimeJet<T>& w = layer.weight;
    if (w.value == T(0) && w.rate == T(0) && w.acceleration == T(0)) continue;
    data[count++] = {kernels::layout(layer.jets.data()),
                     layer.mask.empty() ? nullptr : layer.mask.data(),
                     {w.value, w.rate, w.acceleration},
                     static_cast<typename Data::Mode>(layer.mode),
                     layer.reference.empty() ? nullptr : kernels::layout(layer.reference.data())};
  }
  const kernels::BlendData<T> blend{data, count, rest.empty() ? nullptr : kernels::layout(rest.data())};
  SINEW_DISPATCH(blend(blend, static_cast<int>(out.size()), kernels::layout(out.data())));
  return {};
}

template struct BlendingJob<float>;
template struct BlendingJob<double>;

}  // namespace sinew
