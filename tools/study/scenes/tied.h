// Situations of what loops tie together: seesaws, bridges, ropes, leashes, people hand in hand.
#pragma once

#include <vector>

#include "study/scenes/situation.h"

namespace sinew::study {

std::vector<Situation> situations_of_what_is_tied();

}  // namespace sinew::study
