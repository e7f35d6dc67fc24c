// The effects that the counting program knows; bare programs are linked with an empty list instead.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sinew/effects/effect.h"

namespace sinew::study {

/// An effect of runtime/sinew/effects on the named joints, or null where the program has none of that name.
std::unique_ptr<Effect<float>> make_module(const std::string& name, const std::vector<std::string>& joints);

}  // namespace sinew::study
