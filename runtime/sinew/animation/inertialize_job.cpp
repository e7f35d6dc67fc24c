#include "sinew/animation/inertialize_job.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/dying_rate.h"
#include "sinew/animation/kernels/layout.h"
#include "sinew/animation/quintic_offset.h"

namespace sinew {
namespace {

using kernels::kOffsetBlock;

constexpr std::size_t kBlockNumbers = 9 * kOffsetBlock;
static_assert(inertial_numbers(1, 0) == kBlockNumbers && inertial_numbers(17, 1) == 3 * kBlockNumbers);

template <class T>
Status check(const InertialState<T>& state) {
  if (state.joints < 0 || state.translated < 0 || state.translated > state.joints)
    return Status::error(Code::kInvalidArgument, "offsets of so many joints cannot be meant");
  if (state.offsets.size() < inertial_numbers(state.joints, state.translated))
    return Status::error(Code::kInvalidArgument, "fewer numbers than the joints' offsets need");
  return {};
}

template <class T>
kernels::OffsetNumbers<T> numbers_of(const InertialState<T>& state) {
  T* const rotations = state.offsets.data();
  return {rotations, rotations + inertial_numbers(state.joints, 0), state.translated};
}

template <class T>
Status check_time(T elapsed, T duration) {
  if (!std::isfinite(elapsed) || !std::isfinite(duration))
    return Status::error(Code::kNotFinite, "time is not finite");
  if (elapsed < T(0) || duration < T(0) || duration > T(1000))
    return Status::error(Code::kOutOfRange, "time is negative, or a duration absurd");
  return {};
}

}  // namespace

template <class T>
Status begin_inertial(std::span<const JointJet<T>> now, std::span<const JointJet<T>> next, T duration,
                      InertialState<T>& state) {
  if (Status status = check(state); !status) return status;
  if (Status status = check_time(T(0), duration); !status) return status;
  if (now.size() < std::size_t(state.joints) || next.size() < std::size_t(state.joints))
    return Status::error(Code::kInvalidArgument, "a motion has fewer joints than the offsets");
  SINEW_DISPATCH(start_offsets(kernels::layout(now.data()), kernels::layout(next.data()), state.joints,
                               numbers_of(state)));
  state.elapsed = 0;
  state.duration = duration;
  return {};
}

template <class T>
T inertial_duration(const InertialState<T>& state, std::span<const T> acceleration, T least, T most) {
  T longest = least;
  const std::size_t joints = std::min(acceleration.size(), std::size_t(state.joints));
  for (std::size_t j = 0; j < joints; ++j) {
    const T* at = state.offsets.data() + j / kOffsetBlock * kBlockNumbers + j % kOffsetBlock;
    const auto length = [&](int first) {  // 4σ is the angle, to second order
      const T x = at[first * kOffsetBlock], y = at[(first + 1) * kOffsetBlock],
              z = at[(first + 2) * kOffsetBlock];
      return 4 * std::sqrt(x * x + y * y + z * z);
    };
    longest = std::max(longest, shortest_fade(length(0), length(3), acceleration[j]));
  }
  return std::min(longest, most);
}

template <class T>
Status InertializeJob<T>::Validate() const {
  if (!state) return Status::error(Code::kInvalidArgument, "no state");
  if (Status status = check(*state); !status) return status;
  if (Status status = check_time(state->elapsed, state->duration); !status) return status;
  if (out.size() > std::size_t(state->joints) || destination.size() < out.size())
    return Status::error(Code::kInvalidArgument,
                         "more joints in the output than in the motion or the offsets");
  if (!profile.empty() && profile.size() < out.size())
    return Status::error(Code::kInvalidArgument, "profile has fewer joints than the output");
  bool in_range = true;
  for (std::size_t j = 0; j < out.size() && !profile.empty(); ++j)
    in_range &= profile[j] > T(0) && profile[j] <= T(1);
  if (!in_range) return Status::error(Code::kOutOfRange, "profile is not within 0 and 1");
  return {};
}

template <class T>
Status InertializeJob<T>::Run() const {
  if (Status status = Validate(); !status) return status;
  if (out.empty()) return {};
  if (!state->running()) {
    if (out.data() != destination.data())
      std::copy_n(kernels::layout(destination.data()), out.size(), kernels::layout(out.data()));
    return {};
  }
  kernels::OffsetFade<T> fade{numbers_of(*state), state->elapsed, state->duration};
  if (!profile.empty()) fade.profile = profile.data();
  SINEW_DISPATCH(add_offsets(kernels::layout(destination.data()), fade, static_cast<int>(out.size()),
                             kernels::layout(out.data())));
  return {};
}

template <class T>
Status ExtrapolateJob<T>::Validate() const {
  if (!std::isfinite(elapsed) || !std::isfinite(slowing) || !std::isfinite(loss))
    return Status::error(Code::kNotFinite, "time or a decay is not finite");
  if (elapsed < T(0) || !(slowing > T(0)) || !(loss > slowing))
    return Status::error(Code::kOutOfRange, "time is negative, or loss is not above slowing above 0");
  if (from.size() < out.size())
    return Status::error(Code::kInvalidArgument, "more joints in the output than in the motion");
  return {};
}

template <class T>
Status ExtrapolateJob<T>::Run() const {
  if (Status status = Validate(); !status) return status;
  if (out.empty()) return {};
  const DyingRate<T> left = DyingRate<T>::at(elapsed, slowing, loss);
  kernels::Extrapolation<T> data;
  std::copy_n(left.of_rate, 3, data.of_rate);
  std::copy_n(left.of_acceleration, 3, data.of_acceleration);
  SINEW_DISPATCH(extrapolate(kernels::layout(from.data()), data, static_cast<int>(out.size()),
                             kernels::layout(out.data())));
  return {};
}

SINEW_INERTIAL_INSTANCES(, float)
SINEW_INERTIAL_INSTANCES(, double)

}  // namespace sinew
