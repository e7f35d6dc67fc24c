// What the program may know of its processor: as if it were an older one.
#pragma once

#include <string_view>

#include "sinew/animation/instruction_set.h"

namespace sinew::portability {

#ifdef __x86_64__
/// What __builtin_cpu_supports reads, in libgcc and in compiler-rt; bits as in GCC's cpuinfo.h.
struct ProcessorModel {
  unsigned vendor, type, subtype, features;
};
extern "C" ProcessorModel __cpu_model;  // NOLINT: the compilers' own name
constexpr unsigned kFeatureAvx2 = 1u << 10, kFeatureAvx512f = 1u << 15;
#endif

struct NamedSet {
  const char* name;
  InstructionSet set;
};
constexpr NamedSet kSets[] = {{"baseline", InstructionSet::kBaseline},
                              {"avx2", InstructionSet::kAvx2},
                              {"avx512", InstructionSet::kAvx512}};

/// From now on kernels are chosen as on a processor with this and nothing above. False where this one has not
/// got it, or does not let itself be told (shared layers have a copy each of what they know).
inline bool pretend(InstructionSet most) {
  if (!available(most)) return false;
#ifdef __x86_64__
  if (most < InstructionSet::kAvx512) __cpu_model.features &= ~kFeatureAvx512f;
  if (most < InstructionSet::kAvx2) __cpu_model.features &= ~kFeatureAvx2;
#endif
  return best_instruction_set() == most;
}

}  // namespace sinew::portability
