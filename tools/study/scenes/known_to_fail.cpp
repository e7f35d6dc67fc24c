// The one list of situations that fail today. The study prints them, the test asserts that they still do.
#include <string>

#include "study/scenes/situation.h"

namespace sinew::study {

const char* known_to_fail(const std::string& situation) {
  struct Known {
    const char *name, *why;
  };
  static constexpr Known kKnown[] = {
      {"corner",
       "a hand reaches 10.9 m/s after the first second, 8 wanted, 7.9 to 13 as the last digits are"},
      {"pit", "a hand reaches 15.1 m/s, 30 with all seeds, 15 wanted; in steps of 1/240 s 37, of 1/960 s 55"},
      {"crowd_pushed",
       "one of twenty is caught by another's legs and does not come back, 0.8 m off; and a hand whirls at "
       "28 m/s, as one alone does in fine steps (17 to 49 m/s)"},
      {"back_from_ragdoll",
       "a second later a foot is 66 mm from its place, 1 wanted, 0.3 s later there: the legs swing back "
       "about "
       "the waist no faster than it can stop them (40 mm where it may use twice as much of its strength), "
       "and "
       "the return alone takes 0.92 s from a metre to a millimetre"},
      {"weak_arm", "20 % of the hand's way at 120 Hz, 5 % at 60 and 1 % at 30: a hand of 1 N m is flung"},
      {"walk_on_boards",
       "at 30 Hz a foot dips between two boards on its straight way from frame to frame and is caught by "
       "one: "
       "0.23 m off at the end"},
      {"toned_tap",
       "at 30 Hz the arms swing 18 mm beside the clip: muscles pull with the mean of what the step's ends "
       "ask for"},
  };
  for (const Known& known : kKnown)
    if (situation == known.name) return known.why;
  return nullptr;
}

}  // namespace sinew::study
