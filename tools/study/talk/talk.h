// The scenes of the seed talk, "Character Physics and Animation in Full Auto", each judged from recorded
// poses: what the talk says of it holds. assets/scenes/talk/README.md follows the talk through them.
#pragma once

#include <vector>

#include "study/scenes/situation.h"

namespace sinew::study {

/// In the order of the talk.
std::vector<Situation> talk_scenes();

}  // namespace sinew::study
