// What a step reads of the one before, as flat bytes. Internal to the character layer: see World::save().
//
// One list of fields (visit_state) serves all that is done with them: bounding, writing, reading, and naming
// the field that a byte belongs to. What follows from the rest is left out: deviations of joints on the
// animation; of what only falls all deviations and last targets, for nobody asks for them until muscles hold
// it. What nearly follows is written as its distance from what it would be (residual_coder.h): masses' places
// from the pose, velocities from the joints' speeds. Whoever reads must compute these alike, as whoever
// replays must.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "sinew/character/contact_finder.h"
#include "sinew/character/levels.h"
#include "sinew/effects/coupling.h"
#include "sinew/skeleton/byte_stream.h"

namespace sinew {

/// Everything of a character or prop that its next step depends on, but for what the host gives it.
template <class T>
void visit_state(CharacterState<T>& state, ByteStream& stream);

/// What the host gives a character for its next step: target and impulses.
template <class T>
void visit_inputs(CharacterState<T>& state, ByteStream& stream);

/// The parts of a world that move.
template <class T>
struct MovingParts {
  std::span<const std::unique_ptr<CharacterState<T>>> states;
  std::vector<LaggedForce<T>>& lagged;  ///< normal forces remembered for friction
  BudgetState& budget;
  std::span<const std::unique_ptr<Coupling<T>>> couplings;
  std::span<const std::span<std::byte>> games;  ///< bytes that the game wants kept with the state
};

enum class Content : std::uint32_t { kState = 0x324e5753, kInputs = 0x31495753 };  ///< SWN2, SWI1

constexpr std::size_t kHeaderBytes = 24;  ///< content, size, make-up of the world, digest of what follows

/// Bytes that `content` takes at most.
template <class T>
std::size_t bytes_at_most(const MovingParts<T>& world, Content content);
/// Writes a header and the content; bytes written, 0 where they do not fit.
template <class T>
std::size_t write_bytes(const MovingParts<T>& world, Content content, std::span<std::byte> out);
/// The inverse. Refuses bytes of another world, another content, or changed ones, with nothing moved.
template <class T>
Status read_bytes(const MovingParts<T>& world, Content content, std::span<const std::byte> in);
/// Which field of which state holds a byte of the snapshot that the world would give now.
template <class T>
SnapshotField field_at(const MovingParts<T>& world, std::size_t byte);

#define SINEW_SNAPSHOT_INSTANCES(prefix, T)                                                \
  prefix void visit_state<T>(CharacterState<T>&, ByteStream&);                             \
  prefix void visit_inputs<T>(CharacterState<T>&, ByteStream&);                            \
  prefix std::size_t bytes_at_most<T>(const MovingParts<T>&, Content);                     \
  prefix std::size_t write_bytes<T>(const MovingParts<T>&, Content, std::span<std::byte>); \
  prefix Status read_bytes<T>(const MovingParts<T>&, Content, std::span<const std::byte>); \
  prefix SnapshotField field_at<T>(const MovingParts<T>&, std::size_t);
SINEW_SNAPSHOT_INSTANCES(extern template, float)
SINEW_SNAPSHOT_INSTANCES(extern template, double)

}  // namespace sinew
