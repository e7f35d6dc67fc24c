#include "sinew/animation/instruction_set.h"

#include <initializer_list>

namespace sinew {

bool available(InstructionSet set) {
#ifdef __x86_64__
  if (set == InstructionSet::kAvx512)
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq");
  if (set == InstructionSet::kAvx2) return __builtin_cpu_supports("avx2");
#endif
  return set == InstructionSet::kBaseline;
}

InstructionSet best_instruction_set() {
  for (const InstructionSet set : {InstructionSet::kAvx512, InstructionSet::kAvx2})
    if (available(set)) return set;
  return InstructionSet::kBaseline;
}

}  // namespace sinew
