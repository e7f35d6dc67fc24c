// Which of a kernel's builds this processor runs.
#pragma once

#include <cstdint>

namespace sinew {

enum class InstructionSet : std::uint8_t { kBaseline, kAvx2, kAvx512 };

/// Whether this processor runs it.
bool available(InstructionSet set);
/// The widest that it runs.
InstructionSet best_instruction_set();

}  // namespace sinew
