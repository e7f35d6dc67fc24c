#include "sinew/graph/graph_keep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>

namespace sinew {
namespace {

constexpr int kLanes = 16;  ///< joints side by side in an InertialState
constexpr int kNumbers = 9;
constexpr double kMost = 32767;

template <class T>
using Kept = std::conditional_t<sizeof(T) == sizeof(double), double, std::int16_t>;

/// Of turns or shifts: a greatest number for values, rates and accelerations, and the numbers of each joint.
template <class T>
struct Part {
  T* greatest;  ///< [3]
  Kept<T>* numbers;
};
template <class T>
Part<T> part_of(std::byte* memory, int joints, int which) {
  T* scales = reinterpret_cast<T*>(memory);
  Kept<T>* numbers = reinterpret_cast<Kept<T>*>(scales + 6);
  return {scales + 3 * which, numbers + std::size_t(which) * kNumbers * std::size_t(joints)};
}

template <class T>
using Nine = std::array<T, kNumbers>;

/// `at(joint)` gives the nine numbers of a joint, three of each kind.
template <class T, class At>
void keep(Part<T> part, int joints, const At& at) {
  Kept<T>* number = part.numbers;
  if constexpr (std::is_same_v<Kept<T>, double>) {
    for (int j = 0; j < joints; ++j, number += kNumbers) {
      const Nine<T> nine = at(j);
      std::copy(nine.begin(), nine.end(), number);
    }
  } else {
    T most[3] = {};
    for (int j = 0; j < joints; ++j) {
      const Nine<T> nine = at(j);
      for (std::size_t k = 0; k < kNumbers; ++k) most[k / 3] = std::max(most[k / 3], std::abs(nine[k]));
    }
    std::copy(most, most + 3, part.greatest);
    T shares[3];
    for (int kind = 0; kind < 3; ++kind) shares[kind] = most[kind] > T(0) ? T(kMost) / most[kind] : T(0);
    for (int j = 0; j < joints; ++j) {
      const Nine<T> nine = at(j);
      for (std::size_t k = 0; k < kNumbers; ++k)
        *number++ =
            static_cast<std::int16_t>(std::lrint(std::clamp(nine[k] * shares[k / 3], T(-kMost), T(kMost))));
    }
  }
}
template <class T>
T recalled(const Part<T>& part, int joint, int k) {
  const Kept<T> number = part.numbers[joint * kNumbers + k];
  if constexpr (std::is_same_v<Kept<T>, double>)
    return number;
  else
    return T(number) * (part.greatest[k / 3] * T(1 / kMost));
}

template <class T>
T* lane(const InertialState<T>& offset, int which, int joint) {
  T* begin = offset.offsets.data() + (which == 0 ? 0 : inertial_numbers(offset.joints, 0));
  return begin + joint / kLanes * (kNumbers * kLanes) + joint % kLanes;
}

/// A joint's turn from rest as modified Rodrigues parameters, its spin and the change of that.
template <class T>
Nine<T> turn_of(const JointJet<T>& jet, const Transform<T>& rest) {
  const Quat<T> q = rest.rotation.conjugate() * jet.rotation;
  const T scale = (q.w() < T(0) ? T(-1) : T(1)) / (T(1) + std::abs(q.w()));
  Nine<T> out = {scale * q.x(), scale * q.y(), scale * q.z()};
  for (std::size_t k = 0; k < 3; ++k) {
    out[3 + k] = jet.omega[int(k)];
    out[6 + k] = jet.alpha[int(k)];
  }
  return out;
}
template <class T>
Nine<T> shift_of(const JointJet<T>& jet, const Transform<T>& rest) {
  Nine<T> out;
  for (std::size_t k = 0; k < 3; ++k) {
    out[k] = jet.translation[int(k)] - rest.translation[int(k)];
    out[3 + k] = jet.velocity[int(k)];
    out[6 + k] = jet.acceleration[int(k)];
  }
  return out;
}
template <class T>
Quat<T> rotation_of(const Vec3<T>& x) {
  const T square = x.squaredNorm(), scale = T(1) / (T(1) + square);
  return {(T(1) - square) * scale, 2 * scale * x.x(), 2 * scale * x.y(), 2 * scale * x.z()};
}

std::byte* writable(std::span<const std::byte> memory) {
  return const_cast<std::byte*>(memory.data());  // which nobody writes
}

}  // namespace

template <class T>
std::size_t kept_bytes(int joints, int translated) {
  return 6 * sizeof(T) + std::size_t(kNumbers) * std::size_t(joints + translated) * sizeof(Kept<T>);
}

template <class T>
void keep_offset(const InertialState<T>& offset, std::span<std::byte> memory) {
  for (const int which : {0, 1})
    keep(part_of<T>(memory.data(), offset.joints, which), which == 0 ? offset.joints : offset.translated,
         [&](int j) {
           Nine<T> out;
           for (int k = 0; k < kNumbers; ++k) out[std::size_t(k)] = lane(offset, which, j)[k * kLanes];
           return out;
         });
}

template <class T>
void recall_offset(std::span<const std::byte> memory, InertialState<T>& offset) {
  for (const int which : {0, 1}) {
    const Part<T> part = part_of<T>(writable(memory), offset.joints, which);
    const int count = which == 0 ? offset.joints : offset.translated;
    for (int j = 0; j < count; ++j) {
      T* at = lane(offset, which, j);
      for (int k = 0; k < kNumbers; ++k) at[k * kLanes] = recalled(part, j, k);
    }
    // The joints beside them in a register have none.
    for (int j = count; j % kLanes != 0; ++j)
      for (int k = 0; k < kNumbers; ++k) lane(offset, which, j)[k * kLanes] = T(0);
  }
}

template <class T>
void keep_pose(std::span<const JointJet<T>> pose, std::span<const Transform<T>> rest, int translated,
               std::span<std::byte> memory) {
  const int joints = static_cast<int>(pose.size());
  keep(part_of<T>(memory.data(), joints, 0), joints,
       [&](int j) { return turn_of(pose[std::size_t(j)], rest[std::size_t(j)]); });
  keep(part_of<T>(memory.data(), joints, 1), translated,
       [&](int j) { return shift_of(pose[std::size_t(j)], rest[std::size_t(j)]); });
}

template <class T>
void recall_pose(std::span<const std::byte> memory, std::span<const Transform<T>> rest, int translated,
                 std::span<JointJet<T>> pose) {
  const int joints = static_cast<int>(rest.size());
  const Part<T> turns = part_of<T>(writable(memory), joints, 0),
                shifts = part_of<T>(writable(memory), joints, 1);
  for (int j = 0; j < static_cast<int>(pose.size()); ++j) {
    JointJet<T>& jet = pose[std::size_t(j)];
    const auto three = [j](const Part<T>& part, int k) {
      return Vec3<T>(recalled(part, j, k), recalled(part, j, k + 1), recalled(part, j, k + 2));
    };
    jet.rotation = rest[std::size_t(j)].rotation * rotation_of<T>(three(turns, 0));
    jet.omega = three(turns, 3);
    jet.alpha = three(turns, 6);
    jet.translation = rest[std::size_t(j)].translation;
    jet.velocity = jet.acceleration = Vec3<T>::Zero();
    if (j >= translated) continue;
    jet.translation += three(shifts, 0);
    jet.velocity = three(shifts, 3);
    jet.acceleration = three(shifts, 6);
  }
}

SINEW_GRAPH_KEEP_INSTANCES(, float)
SINEW_GRAPH_KEEP_INSTANCES(, double)

}  // namespace sinew
