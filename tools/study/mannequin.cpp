#include "study/mannequin.h"

#include <cstdlib>
#include <memory>

namespace sinew::study {

const Asset* mannequin() {
  static const std::unique_ptr<Asset> asset = [] {
    auto made = std::make_unique<Asset>();
    nlohmann::json report;
    const char* ready = std::getenv("SINEW_MANNEQUIN");  // see accuracy_instructions.cpp
    const std::string file = ready ? ready : SINEW_ASSETS_DIR "/character/mannequin.glb";
    if (convert::open_any(file, nlohmann::json::object(), *made, report)) made.reset();
    return made;
  }();
  return asset.get();
}

}  // namespace sinew::study
