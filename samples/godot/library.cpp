// What Godot calls of this library.
#include "gdnative.h"
#include "godot.h"
#include "sinew_character.h"
#include "sinew_world.h"

#if defined(_WIN32)
#define SINEW_GODOT_EXPORT extern "C" __declspec(dllexport)
#else
#define SINEW_GODOT_EXPORT extern "C" __attribute__((visibility("default")))
#endif

namespace {
const gdnative::CoreTable* core = nullptr;  // null: refused
}

SINEW_GODOT_EXPORT void godot_gdnative_init(gdnative::InitOptions* options) {
  const char* const reason = gdnative::why_not(options->core);
  if (reason) {
    options->report_loading_error(options->library, reason);
  } else {
    core = options->core;
  }
}

SINEW_GODOT_EXPORT void godot_nativescript_init(void* library) {
  if (!core) return;
  godot::use(*core, library);
  SinewWorld::register_with_godot();
  SinewCharacter::register_with_godot();
}

SINEW_GODOT_EXPORT void godot_gdnative_terminate(void*) {
  core = nullptr;
}
