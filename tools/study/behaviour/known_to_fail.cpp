// The one list of behaviours' scenes that fail today. The study prints them, the test asserts that they still
// do.
#include "study/behaviour/behaviour_study.h"

namespace sinew::study {

const char* behaviour_known_to_fail(const std::string& scene) {
  struct Known {
    const char *name, *why;
  };
  static constexpr const char* kStand =
      "until it reacts it is as stiff as a statue, whose soles press at once, so it steps later than people; "
      "sideways it falls from less; while one foot stands it slides; help keeps the trunk up, of who does "
      "not "
      "step too; some are not back 5 s later";
  static constexpr const char* kHelped =
      "hands and feet stand a little elsewhere than the clip's, and nothing moves the body over them before "
      "it "
      "balances: it takes up to 120 N m of help about each axis; some try several clips, limp in between";
  static constexpr Known kKnown[] = {
      {"get_up_flat", kHelped},
      {"get_up_interrupted", kHelped},
      {"get_up_slope_10_deg", "clips and the balance plan know a level floor"},
      {"push_stand_chest_60_Hz", kStand},
      {"push_stand_pelvis_60_Hz", kStand},
      {"push_stand_chest_30_Hz", kStand},
      {"push_stand_chest_120_Hz", kStand},
      {"push_while_walking", "the plan is for who stands: who walks goes on as the clip does"},
      {"rates",
       "what a step catches depends on the rate: where it falls differs by a fifth, backward by half"},
  };
  for (const Known& known : kKnown)
    if (scene == known.name) return known.why;
  return nullptr;
}

}  // namespace sinew::study
