// Situations of things that nobody animates but what leads or hits them: wheels, tops, lifts, bats, and doors
// and crates that somebody walks into.
#pragma once

#include <vector>

#include "study/scenes/situation.h"

namespace sinew::study {

std::vector<Situation> situations_of_things();

}  // namespace sinew::study
