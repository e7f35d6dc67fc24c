// Blending of poses for the C interface.
#include <array>
#include <cmath>
#include <span>

#include "sinew/animation/blending_job.h"
#include "sinew/animation/crossfade.h"
#include "sinew/animation/mesh_additive_job.h"
#include "sinew/c/pose_call.h"

namespace sinew::c {
namespace {

constexpr const char* kOtherReference = "the reference has another number of joints";

static_assert(int(BlendMode::kMix) == SINEW_BLEND_MIX && int(BlendMode::kOverride) == SINEW_BLEND_OVERRIDE &&
              int(BlendMode::kAdditive) == SINEW_BLEND_ADDITIVE);

sinew_status read_layer(const OwnedAsset& owned, const sinew_blend_layer& from, int n, int count,
                        BlendLayer<float>& to) {
  if (const sinew_status s = check_jets(owned, from.jets, count); s != SINEW_OK) return failed_at(s, n);
  if (from.mode < SINEW_BLEND_MIX || from.mode > SINEW_BLEND_ADDITIVE)
    return fail(SINEW_INVALID_ARGUMENT, "no such mode of blending", n);
  to.jets = jets_of(from.jets, count);
  to.weight = {from.weight, from.weight_rate, from.weight_acceleration};
  if (from.mask) to.mask = {from.mask, std::size_t(count)};
  to.mode = BlendMode(from.mode);
  return SINEW_OK;
}

/// How joints are turned in model space, of a motion and of what it is compared with.
using Turns = std::span<MovingRotation<float>>;
static_assert(sizeof(MovingRotation<float>) <= sizeof(sinew_jet) &&
              alignof(MovingRotation<float>) <= alignof(sinew_jet));

/// Two for each of `joints`, in the caller's memory.
sinew_status read_scratch(sinew_jet* from, int count, int joints, Turns& to) noexcept {
  if (!from) return fail(SINEW_INVALID_ARGUMENT, kNull);
  if (!aligned(from)) return fail(SINEW_INVALID_ARGUMENT, kMisaligned);
  if (count < 2 * joints) return fail(SINEW_TOO_SMALL, "scratch has to hold two jets for each joint");
  to = {reinterpret_cast<MovingRotation<float>*>(from), 2 * std::size_t(joints)};
  return SINEW_OK;
}

}  // namespace
}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_ease(float elapsed, float duration, float* out) {
  if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
  if (!std::isfinite(elapsed) || !std::isfinite(duration))
    return fail(SINEW_NOT_FINITE, "elapsed and duration must be finite");
  const EaseWeight<float> weight = EaseWeight<float>::at(elapsed, duration);
  out[0] = weight.value;
  out[1] = weight.rate;
  out[2] = weight.acceleration;
  return SINEW_OK;
}

sinew_status sinew_asset_blend(sinew_asset asset, const sinew_blend_layer* layers, int32_t layer_count,
                               sinew_jet* jets, int32_t count) {
  return with_owned_asset(asset, [&](const OwnedAsset& owned) {
    std::array<BlendLayer<float>, BlendingJob<float>::kMaxLayers> read;
    if (!layers && layer_count != 0) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (layer_count < 0 || std::size_t(layer_count) > read.size())
      return fail(SINEW_INVALID_ARGUMENT, "there may be 0 to 16 layers", layer_count);
    if (const sinew_status s = check_jets(owned, jets, count); s != SINEW_OK) return s;
    for (int n = 0; n < layer_count; ++n)
      if (const sinew_status s = read_layer(owned, layers[n], n, count, read[std::size_t(n)]); s != SINEW_OK)
        return s;
    return answer(
        BlendingJob<float>{std::span(read).first(std::size_t(layer_count)), owned.rest, jets_of(jets, count)}
            .Run());
  });
}

sinew_status sinew_asset_subtract(sinew_asset asset, const sinew_jet* reference, int32_t reference_count,
                                  sinew_jet* jets, int32_t count) {
  return with_owned_asset(asset, [&](const OwnedAsset& owned) {
    if (const sinew_status s = check_jets(owned, jets, count); s != SINEW_OK) return s;
    if (reference_count != 0) {
      if (const sinew_status s = check_jets(owned, reference, reference_count); s != SINEW_OK) return s;
      if (reference_count != count) return fail(SINEW_INVALID_ARGUMENT, kOtherReference, reference_count);
    }
    const std::span<JointJet<float>> out = jets_of(jets, count);
    const std::span<const JointJet<float>> from = jets_of(reference, reference_count);
    for (std::size_t j = 0; j < out.size(); ++j) {
      const Transform<float> at =
          from.empty() ? owned.rest[j] : Transform<float>{from[j].rotation, from[j].translation};
      subtract_reference<float>({&at, 1}, {&out[j], 1}, {&out[j], 1});
    }
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_asset_subtract_in_model(sinew_asset asset, const sinew_jet* reference,
                                           int32_t reference_count, sinew_jet* jets, int32_t count,
                                           sinew_jet* scratch, int32_t scratch_count) {
  return with_owned_asset(asset, [&](const OwnedAsset& owned) {
    if (const sinew_status s = check_jets(owned, jets, count); s != SINEW_OK) return s;
    if (const sinew_status s = check_jets(owned, reference, reference_count); s != SINEW_OK) return s;
    if (reference_count != count) return fail(SINEW_INVALID_ARGUMENT, kOtherReference, reference_count);
    Turns turns;
    if (const sinew_status s = read_scratch(scratch, scratch_count, count, turns); s != SINEW_OK) return s;
    const std::span<JointJet<float>> out = jets_of(jets, count);
    subtract_in_model<float>(owned.parents, jets_of(reference, count), out, turns, out);
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_asset_add_in_model(sinew_asset asset, const sinew_blend_layer* layer, sinew_jet* jets,
                                      int32_t count, sinew_jet* scratch, int32_t scratch_count) {
  return with_owned_asset(asset, [&](const OwnedAsset& owned) {
    if (!layer) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (const sinew_status s = check_jets(owned, jets, count); s != SINEW_OK) return s;
    BlendLayer<float> read;
    if (const sinew_status s = read_layer(owned, *layer, -1, count, read); s != SINEW_OK) return s;
    if (read.mode != BlendMode::kAdditive)
      return fail(SINEW_INVALID_ARGUMENT, "a layer in model space is additive");
    Turns turns;
    if (const sinew_status s = read_scratch(scratch, scratch_count, count, turns); s != SINEW_OK) return s;
    return answer(
        MeshAdditiveJob<float>{owned.parents, jets_of(jets, count), read.jets, read.weight, read.mask, turns}
            .Run());
  });
}
