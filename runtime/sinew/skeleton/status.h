// What a call at the library's border answers. Nothing in the runtime throws.
#pragma once

#include <cstdint>

namespace sinew {

/// Why a call was refused, or that it was not.
enum class Code : std::uint8_t {
  kOk,               ///< done
  kInvalidArgument,  ///< a size, index or setting that can't be meant
  kNotFinite,        ///< NaN or infinity in an input
  kOutOfRange,       ///< finite, but absurd (|x| above what the step can carry)
  kBadFile,          ///< not a Sinew asset, truncated, or semantically broken
  kBadVersion,       ///< written by a newer major version
  kIo,               ///< the file could not be read or written
  kUnsupported,      ///< the runtime was built without it
  kNotFound,         ///< nothing has that name
};

/// Error code plus the culprit: which joint (or other element) and a static text that says why. Trivially
/// copyable; `reason` points to a string literal and never needs to be freed.
struct [[nodiscard]] Status {
  Code code = Code::kOk;    ///< what kind of error
  int index = -1;           ///< joint, effect, track, … the reason talks about; -1 if none
  const char* reason = "";  ///< one clause, e.g. "inertia breaks the triangle inequality"

  /// Whether the call did what it should.
  constexpr bool ok() const { return code == Code::kOk; }
  /// The same.
  constexpr explicit operator bool() const { return ok(); }
  /// An error; `reason` is a string literal.
  static constexpr Status error(Code code, const char* reason, int index = -1) {
    return {code, index, reason};
  }
};

}  // namespace sinew
