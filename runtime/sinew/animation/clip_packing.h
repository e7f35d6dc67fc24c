// Controls as whole numbers, and those in few bits: how asset files hold curves.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sinew/animation/clip.h"

namespace sinew {

/// What packed numbers may be multiples of: four steps per octave from 1 down, so that a byte names one.
inline constexpr int kPackingSteps = 97;
constexpr double packing_step(int index) {
  constexpr double kOctave[4] = {1, 0.8408964152537145, 0.7071067811865476, 0.5946035575013605};
  return kOctave[index % 4] / double(1 << (index / 4));
}
inline constexpr int kPackingBits = 27;  ///< of a number beside its sign, at most

/// The control that whole numbers mean, [component]. Who reads a file plays exactly the curves that its
/// writer measured.
///
///     v[c] = number[c] · step
///
/// Translations are v, rotations of four components v = (x, y, z, w). Rotations of three components are
/// reference ⊗ (v, 1): the length of a control means nothing, so three numbers are enough for a track that
/// stays within less than half a turn of its reference.
void unpack_control(const Clip::Packing& packing, bool rotation, const std::int32_t (&numbers)[4],
                    float* control);

/// The inverse. False where no numbers give these very bits.
bool pack_control(const Clip::Packing& packing, bool rotation, const float* control,
                  std::int32_t (&numbers)[4]);

/// Bits that the numbers of one component take, from knot to knot.
///
/// They are written as differences of the first, second or third order, whichever is shortest, in a
/// Golomb–Rice code that adapts to their mean (Weinberger, Seroussi & Sapiro, "The LOCO-I lossless image
/// compression algorithm", 2000): curves are smooth, so that most of a number follows from those before it.
std::size_t packed_bits(std::span<const std::int32_t> numbers);

/// A group's tracks with their packings, and its controls, as bytes. False and nothing where the controls
/// are not what their packings can say. Allocates.
bool pack_group(const Clip::Group& group, std::vector<std::uint8_t>& bytes);

/// The inverse, into a group whose other members are set. An error where the bytes end early or say what
/// cannot be: any bytes may be given. Allocates at most 256 times as much as it is given.
Status unpack_group(std::span<const std::uint8_t> bytes, Clip::Group& group);

}  // namespace sinew
