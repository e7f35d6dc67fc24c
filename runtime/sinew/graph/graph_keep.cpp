#include "sinew/graph/graph_keep.h"

#include <algorithm>
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
  T* greatest;       ///< [3]
  Kept<T>* numbers;  ///< [9][count]
  int count;
};
template <class T>
Part<T> part_of(std::byte* memory, int joints, int which, int count) {
  T* scales = reinterpret_cast<T*>(memory);
  Kept<T>* numbers = reinterpret_cast<Kept<T>*>(scales + 6);
  return {scales + 3 * which, numbers + std::size_t(which) * kNumbers * std::size_t(joints), count};
}

/// `at(joint, k)` gives the nine numbers of a joint, three of each kind.
template <class T, class At>
void keep(const Part<T>& part, const At& at) {
  for (int k = 0; k < kNumbers; ++k) {
    Kept<T>* number = part.numbers + k * part.count;
    if constexpr (std::is_same_v<Kept<T>, double>) {
      for (int j = 0; j < part.count; ++j) number[j] = at(j, k);
    } else {
      T& most = part.greatest[k / 3];
      if (k % 3 == 0) {
        most = 0;
        for (int i = k; i < k + 3; ++i)
          for (int j = 0; j < part.count; ++j) most = std::max(most, std::abs(at(j, i)));
      }
      const T scale = most > T(0) ? T(kMost) / most : T(0);
      for (int j = 0; j < part.count; ++j) {
        const T share = at(j, k) * scale;  // |share| ≤ kMost, but for its rounding
        number[j] = static_cast<std::int16_t>(share + (share < T(0) ? T(-0.5) : T(0.5)));
      }
    }
  }
}
/// What a unit of the numbers k of all joints stands for.
template <class T>
T unit_of(const Part<T>& part, int k) {
  return std::is_same_v<Kept<T>, double> ? T(1) : part.greatest[k / 3] * T(1 / kMost);
}
template <class T>
T recalled(const Part<T>& part, int joint, int k) {
  return T(part.numbers[k * part.count + joint]) * unit_of(part, k);
}

template <class T>
T* lane(const InertialState<T>& offset, int which, int joint) {
  T* begin = offset.offsets.data() + (which == 0 ? 0 : inertial_numbers(offset.joints, 0));
  return begin + joint / kLanes * (kNumbers * kLanes) + joint % kLanes;
}

/// Of a joint's turn from rest: modified Rodrigues parameters, spin and the change of that.
template <class T>
T turn_of(const JointJet<T>& jet, const Transform<T>& rest, int k) {
  if (k >= 3) return k < 6 ? jet.omega[k - 3] : jet.alpha[k - 6];
  const Quat<T> q = rest.rotation.conjugate() * jet.rotation;
  return (q.w() < T(0) ? T(-1) : T(1)) / (T(1) + std::abs(q.w())) * q.coeffs()[k];
}
template <class T>
T shift_of(const JointJet<T>& jet, const Transform<T>& rest, int k) {
  if (k < 3) return jet.translation[k] - rest.translation[k];
  return k < 6 ? jet.velocity[k - 3] : jet.acceleration[k - 6];
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
    keep(part_of<T>(memory.data(), offset.joints, which, which == 0 ? offset.joints : offset.translated),
         [begin = lane(offset, which, 0)](int j, int k) {
           const unsigned joint = unsigned(j), block = joint / kLanes;
           return begin[block * (kNumbers * kLanes) + joint % kLanes + unsigned(k) * kLanes];
         });
}

template <class T>
void recall_offset(std::span<const std::byte> memory, InertialState<T>& offset) {
  for (const int which : {0, 1}) {
    const int count = which == 0 ? offset.joints : offset.translated;
    const Part<T> part = part_of<T>(writable(memory), offset.joints, which, count);
    for (int k = 0; k < kNumbers; ++k) {
      const Kept<T>* from = part.numbers + k * count;
      const T unit = unit_of(part, k);
      int first = 0;
      for (; first + kLanes <= count; first += kLanes) {
        T* at = lane(offset, which, first) + k * kLanes;
#pragma GCC unroll 1  // unrolled, GCC 12 converts half of them one by one
        for (int j = 0; j < kLanes; ++j) at[j] = T(from[first + j]) * unit;
      }
      const int left = count - first;
      if (left == 0) continue;
      T* at = lane(offset, which, first) + k * kLanes;
      for (int j = 0; j < left; ++j) at[j] = T(from[first + j]) * unit;
      std::fill(at + left, at + kLanes, T(0));  // the joints beside them in a register have none
    }
  }
}

template <class T>
void keep_pose(std::span<const JointJet<T>> pose, std::span<const Transform<T>> rest, int translated,
               std::span<std::byte> memory) {
  const int joints = static_cast<int>(pose.size());
  keep(part_of<T>(memory.data(), joints, 0, joints),
       [&](int j, int k) { return turn_of(pose[std::size_t(j)], rest[std::size_t(j)], k); });
  keep(part_of<T>(memory.data(), joints, 1, translated),
       [&](int j, int k) { return shift_of(pose[std::size_t(j)], rest[std::size_t(j)], k); });
}

template <class T>
void recall_pose(std::span<const std::byte> memory, std::span<const Transform<T>> rest, int translated,
                 std::span<JointJet<T>> pose) {
  const int joints = static_cast<int>(rest.size());
  const Part<T> turns = part_of<T>(writable(memory), joints, 0, joints),
                shifts = part_of<T>(writable(memory), joints, 1, translated);
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
