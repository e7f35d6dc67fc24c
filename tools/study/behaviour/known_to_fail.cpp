// The one list of behaviours' scenes that fail today. The study prints them, the test asserts that they still
// do.
#include "study/behaviour/behaviour_study.h"

namespace sinew::study {

const char* behaviour_known_to_fail(const std::string& scene) {
  struct Known {
    const char *name, *why;
  };
  static constexpr Known kKnown[] = {
      {"push_while_walking", "the plan is for who stands: who walks goes on as the clip does"},
  };
  for (const Known& known : kKnown)
    if (scene == known.name) return known.why;
  return nullptr;
}

}  // namespace sinew::study
