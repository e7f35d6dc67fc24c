// The one list of cases that fail today. The study prints them as failed, the test asserts that they still
// fail: whoever mends one must take it out here.
#include <algorithm>
#include <initializer_list>

#include "study/hard_case.h"

namespace sinew::study {
namespace {

struct KnownFailure {
  const char* name;
  const char* why;
};

constexpr std::initializer_list<KnownFailure> kKnownFailures = {
    {"tennis_racket",
     "in float: 8e-4 of the angular momentum lost in 20 s at 1/60 s, 2e-4 at 1/30 s, 1e-4 wanted: it goes "
     "with "
     "the number of steps, so by roundings; double keeps it"},
    {"symmetric_top",
     "bdf1, which is there to be compared with: its order is 0.18 off at 1/60 s, 0.1 wanted; a quarter of "
     "the "
     "step has it"},
    {"n_four_bar",
     "N = 40 in float: 0.8 % of the steps at 1/60 s unconverged, 0.1 % wanted, closures of 0.61 mm at 1/240 "
     "s, "
     "0.5 wanted: a float's digits do not reach along 81 bars"},
    {"bounce_half",
     "at 1/30 s a rise of 6 mJ of 9.8 J, 1 mJ wanted, when bounces follow each other within two steps: poses "
     "do "
     "not show them; books of an exact bouncing ball find up to 4 mJ there as well"},
    {"tumbling_box",
     "a rise of 1.1 mJ, 1 mJ wanted, between impacts that follow each other within a few steps; not known "
     "whether it is there or is what poses do not show (see bounce_half)"},
    {"crowd_of_200",
     "close together, in a world with room for 100 degrees of freedom: 0.7 (float) and 1.3 % (double) of the "
     "steps unconverged, 0.1 wanted; nobody falls through the floor and it is reported"},
    {"residual_of_a_step_in_flight",
     "steps end 2.6 % (float) and 4.5e-6 (double) of their way off the exact solution, 1e-4 and 1e-8 wanted: "
     "passes stop at 3e-5 m, in double too"},
    {"residual_of_a_step_on_the_floor",
     "steps end 17 % (float) and 0.14 % (double) of their way off the exact solution in the worst step, 1e-4 "
     "and "
     "1e-8 wanted: passes stop at 3e-5 m, in double too, and where limbs strike less than that decides"},
    {"limp_fall_counts",
     "2.7 passes and 5.8 factorisations a step, 2 and 3.7 wanted: steps in which limbs whip are cut in "
     "four"},
    {"ragdoll_hit_in_the_same_frame",
     "one step needs more passes than its budget: the hand leaves at 170 m/s and turns 20 rad in it"},
    {"baked_limbs",
     "limp hands whirl after blows that act at once, and no two runs stay together: with a blow that differs "
     "by 1e-4 unbaked ones are 36 degrees apart after two seconds, and baked ones 45 to 50 from unbaked "
     "ones; weak "
     "hands are within 0.1, but solved for in 0.92 of the steps"},
    {"root_turned_by_pi",
     "in float: 1.05 mrad apart from the figure that is not turned, 1 wanted: roundings ring longer with a "
     "spectral radius of 0.92 than with 0.8"},
};

}  // namespace

const char* known_failure(const std::string& name) {
  const auto known = std::find_if(kKnownFailures.begin(), kKnownFailures.end(),
                                  [&](const KnownFailure& k) { return name == k.name; });
  return known == kKnownFailures.end() ? nullptr : known->why;
}

}  // namespace sinew::study
