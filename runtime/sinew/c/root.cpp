// Where poses stand, of the C interface: roots, and frames that are fixed to joints.
#include <cmath>
#include <cstring>

#include "sinew/animation/crossfade.h"
#include "sinew/animation/root_motion.h"
#include "sinew/animation/socket.h"
#include "sinew/c/pose_call.h"

namespace sinew::c {
namespace {

bool is_unit(double square) {
  return square > 0.98 && square < 1.02;
}

bool is_finite(const JointJet<float>& jet) {
  return jet.rotation.coeffs().allFinite() && jet.omega.allFinite() && jet.alpha.allFinite() &&
         jet.translation.allFinite() && jet.velocity.allFinite() && jet.acceleration.allFinite();
}

/// One that lies anywhere.
JointJet<float> read_jet(const sinew_jet* from) {
  JointJet<float> to;
  std::memcpy(static_cast<void*>(&to), from, sizeof to);
  return to;
}
void write_jet(const JointJet<float>& from, sinew_jet* to) {
  std::memcpy(to, static_cast<const void*>(&from), sizeof from);
}

/// Null: where the joint is.
sinew_status read_offset(const sinew_transform* from, Transform<float>& to) {
  if (!from) return SINEW_OK;
  std::memcpy(static_cast<void*>(&to), from, sizeof to);
  if (!to.rotation.coeffs().allFinite() || !to.translation.allFinite())
    return fail(SINEW_NOT_FINITE, "the offset is not finite");
  return is_unit(double(to.rotation.squaredNorm()))
             ? sinew_status(SINEW_OK)
             : fail(SINEW_INVALID_ARGUMENT, "the offset's rotation must be a unit quaternion");
}

}  // namespace
}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_place_jets(const sinew_pose* place, sinew_jet* jets, int32_t count) {
  if (!place || !jets) return fail(SINEW_INVALID_ARGUMENT, kNull);
  if (!aligned(jets)) return fail(SINEW_INVALID_ARGUMENT, kMisaligned);
  if (count < 1) return fail(SINEW_INVALID_ARGUMENT, "no jet to place", count);
  Transform<double> to;
  FromC read;
  read("a place's rotation must be a unit quaternion, it must be within 1e6 m", *place, to);
  if (read.status == SINEW_OK) place_root(to.cast<float>(), jets_of(jets, count)[0]);
  return read.status;
}

sinew_status sinew_split_root(const sinew_jet* root, sinew_jet* travel, sinew_jet* body) {
  if (!root || !travel || !body) return fail(SINEW_INVALID_ARGUMENT, kNull);
  constexpr float kUpsideDown = 1e-6f;  // its squared cosine of half the lean
  const JointJet<float> whole = read_jet(root);
  if (!is_finite(whole)) return fail(SINEW_NOT_FINITE, "the root is not finite");
  if (!is_unit(double(whole.rotation.squaredNorm())))
    return fail(SINEW_INVALID_ARGUMENT, "the root's rotation must be a unit quaternion");
  const float z = whole.rotation.z(), w = whole.rotation.w();
  if (z * z + w * w < kUpsideDown) return fail(SINEW_OUT_OF_RANGE, "the root is upside down");
  const RootMotion<float> split = split_root(whole);
  write_jet(split.travel, travel);
  write_jet(split.body, body);
  return SINEW_OK;
}

sinew_status sinew_asset_get_socket(sinew_asset asset, const sinew_jet* jets, int32_t jet_count,
                                    int32_t joint, const sinew_transform* offset, sinew_jet* out) {
  return with_owned_asset(asset, [&](const OwnedAsset& owned) {
    if (const sinew_status s = check_jets(owned, jets, jet_count); s != SINEW_OK) return s;
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (joint < 0 || joint >= jet_count) return fail(SINEW_INVALID_ARGUMENT, "no such joint", joint);
    Socket<float> socket{joint};
    if (const sinew_status s = read_offset(offset, socket.offset); s != SINEW_OK) return s;
    const JointJet<float> motion =
        joint_jet(socket_motion<float>(socket, jets_of(jets, jet_count), owned.parents));
    if (!is_finite(motion)) return fail(SINEW_NOT_FINITE, "a jet above the joint is not finite", joint);
    write_jet(motion, out);
    return sinew_status(SINEW_OK);
  });
}
