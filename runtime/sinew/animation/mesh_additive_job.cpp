#include "sinew/animation/mesh_additive_job.h"

#include <cmath>

namespace sinew {
namespace {

template <class T>
MovingRotation<T> in_model(std::span<const int> parents, const JointJet<T>& jet, std::size_t joint,
                           std::span<const MovingRotation<T>> model) {
  const MovingRotation<T> local = moving_rotation(jet);
  return parents[joint] < 0 ? local : model[std::size_t(parents[joint])] * local;
}

/// (1 − w)·1 + w·δ, of ±δ the nearer to 1.
template <class T>
MovingRotation<T> part_of(const JointJet<T>& difference, const TimeJet<T>& w) {
  Quat<TimeJet<T>> q = moving_quaternion(moving_rotation(difference));
  const T sign = q.w().value < T(0) ? T(-1) : T(1);
  for (int i = 0; i < 4; ++i) q.coeffs()[i] = w * (sign * q.coeffs()[i]);
  q.w() += TimeJet<T>(T(1)) - w;
  return moving_rotation(q);
}

}  // namespace

template <class T>
void subtract_in_model(std::span<const int> parents, std::span<const JointJet<T>> reference,
                       std::span<const JointJet<T>> jets, std::span<MovingRotation<T>> scratch,
                       std::span<JointJet<T>> out) {
  const std::size_t joints = out.size();
  const std::span model = scratch.first(joints), from = scratch.subspan(joints, joints);
  for (std::size_t i = 0; i < joints; ++i) {
    model[i] = in_model<T>(parents, jets[i], i, model);
    from[i] = in_model<T>(parents, reference[i], i, from);
  }
  for (std::size_t i = 0; i < joints; ++i) {
    out[i] = {};
    set_rotation<T>(model[i] * from[i].conjugate(), out[i]);
  }
}

template <class T>
Status MeshAdditiveJob<T>::Validate() const {
  const std::size_t joints = jets.size();
  if (parents.size() < joints || difference.size() < joints || scratch.size() < 2 * joints ||
      (!mask.empty() && mask.size() < joints))
    return Status::error(Code::kInvalidArgument, "an input has fewer joints than the motion");
  if (!std::isfinite(weight.value) || !std::isfinite(weight.rate) || !std::isfinite(weight.acceleration))
    return Status::error(Code::kNotFinite, "weight is not finite");
  if (weight.value < T(0)) return Status::error(Code::kOutOfRange, "weight is negative");
  for (std::size_t i = 0; i < joints; ++i) {
    if (parents[i] >= static_cast<int>(i))
      return Status::error(Code::kInvalidArgument, "child before its parent", static_cast<int>(i));
    if (!mask.empty() && !(mask[i] >= T(0) && mask[i] <= T(1)))
      return Status::error(Code::kOutOfRange, "mask is not within 0 and 1", static_cast<int>(i));
  }
  return {};
}

template <class T>
Status MeshAdditiveJob<T>::Run() const {
  if (Status status = Validate(); !status) return status;
  if (weight.value == T(0) && weight.rate == T(0) && weight.acceleration == T(0)) return {};
  const std::size_t joints = jets.size();
  const std::span below = scratch.first(joints), turned = scratch.subspan(joints, joints);
  const auto touched = [&](int joint) {
    return joint >= 0 && (mask.empty() || mask[std::size_t(joint)] != T(0));
  };
  for (std::size_t i = 0; i < joints; ++i) {
    const int parent = parents[i];
    below[i] = in_model<T>(parents, jets[i], i, below);
    turned[i] = below[i];
    if (touched(static_cast<int>(i))) {
      const T share = mask.empty() ? T(1) : mask[i];
      turned[i] = part_of<T>(difference[i], share * weight) * below[i];
    } else if (!touched(parent)) {
      continue;
    }
    const MovingRotation<T> local =
        parent < 0 ? turned[i] : turned[std::size_t(parent)].conjugate() * turned[i];
    set_rotation<T>(local, jets[i]);
  }
  return {};
}

SINEW_MESH_ADDITIVE_INSTANCES(, float)
SINEW_MESH_ADDITIVE_INSTANCES(, double)

}  // namespace sinew
