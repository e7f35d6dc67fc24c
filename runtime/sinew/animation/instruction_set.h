// Which of a kernel's builds this processor runs.
#pragma once

#include <cstdint>

namespace sinew {

/// Of x86-64, by rising width; other processors have the first alone.
enum class InstructionSet : std::uint8_t {
  kBaseline,  ///< what every processor has that the program was compiled for
  kAvx2,      ///< 8 floats at a time
  kAvx512     ///< 16 floats at a time: AVX-512 F, VL and DQ
};

/// Whether this processor runs it.
bool available(InstructionSet set);
/// The widest that it runs.
InstructionSet best_instruction_set();

}  // namespace sinew
