// assets/accuracy_presets.json, built into the program.
#pragma once

namespace sinew::scene {

extern const char* const kPresetsData;

}  // namespace sinew::scene
