// What a transition remembers of a motion, in few bytes. Internal to this layer.
#pragma once

#include <cstddef>
#include <span>

#include "sinew/animation/inertialize_job.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew {

/// Nine numbers a joint that turns, nine more where it shifts. In single precision each is a 16-bit share of
/// the greatest of its kind (values, rates and accelerations of turns and of shifts), so that what a
/// transition begins with is off by at most 1/65534 of the greatest offset; in double precision they are as
/// they are.
template <class T>
std::size_t kept_bytes(int joints, int translated);

/// `memory`: kept_bytes() at a multiple of alignof(T).
template <class T>
void keep_offset(const InertialState<T>& offset, std::span<std::byte> memory);
/// Times of `offset` stay.
template <class T>
void recall_offset(std::span<const std::byte> memory, InertialState<T>& offset);

/// A whole motion: what of it differs from rest. Joints from `translated` on come back where they rest.
template <class T>
void keep_pose(std::span<const JointJet<T>> pose, std::span<const Transform<T>> rest, int translated,
               std::span<std::byte> memory);
template <class T>
void recall_pose(std::span<const std::byte> memory, std::span<const Transform<T>> rest, int translated,
                 std::span<JointJet<T>> pose);

#define SINEW_GRAPH_KEEP_INSTANCES(prefix, T)                                                         \
  prefix template std::size_t kept_bytes<T>(int, int);                                                \
  prefix template void keep_offset<T>(const InertialState<T>&, std::span<std::byte>);                 \
  prefix template void recall_offset<T>(std::span<const std::byte>, InertialState<T>&);               \
  prefix template void keep_pose<T>(std::span<const JointJet<T>>, std::span<const Transform<T>>, int, \
                                    std::span<std::byte>);                                            \
  prefix template void recall_pose<T>(std::span<const std::byte>, std::span<const Transform<T>>, int, \
                                      std::span<JointJet<T>>);
SINEW_GRAPH_KEEP_INSTANCES(extern, float)
SINEW_GRAPH_KEEP_INSTANCES(extern, double)

}  // namespace sinew
