// The one list of cases that fail today, and of those whose steps cost more than they may. The study prints
// them, the test asserts that they still do: whoever mends one must take it out here.
#include <algorithm>
#include <initializer_list>

#include "study/hard_case.h"

namespace sinew::study {
namespace {

struct KnownFailure {
  const char* name;
  const char* why;
  bool at_length = false;  ///< passes in quick trials
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
     "N = 40 in float: closures of 0.59 mm at 1/60 s, 2.3 in twenty seconds, 0.5 wanted: sweeps along 81 "
     "bars do not find the velocities that all loops allow"},
    {"tumbling_box",
     "one of 40 throws at 1/30 s rises by 1.08 mJ in float (0.96 in double), 1 wanted: what contacts have "
     "stored and "
     "give back, by the runtime's own figures, which is in no pose",
     true},
    {"figure_on_stairs", "one of 12 falls at 1/60 s rises by 1.24 mJ in double, 1 wanted: as tumbling_box",
     true},
    {"rope_with_heavy_tip", "in float at 1/30 s two steps of 300 (0.67 %) unconverged, 0.1 % wanted", true},
    {"figures_in_a_pile",
     "of ten whose joints do not rub a hand still swings at 0.2 m/s after 15 s, 0.05 wanted, 4 % slower each "
     "second, "
     "and keeps the others awake",
     true},
    {"sixteen_piles_of_figures", "as figures_in_a_pile", true},
    {"limp_fall_bdf1",
     "bdf1, which is there to be compared with: at 1/15 s the way of a step needs 19 J more than there is, "
     "of 1200"},
    {"limp_fall_bdf2",
     "bdf2, which is there to be compared with: at 1/30 s the way of a step needs 14 J more than there is, "
     "of 1760",
     true},
    {"random_trees",
     "a few trees in a thousand leap, by some hundredths of their energy (seven to ten in a hundred, by any, "
     "before the way of a step was asked for its energy); of 20 000 one in float gains 649 J of 364 kJ"},
    {"soak_hour",
     "in double 0.10 % of two minutes' steps unconverged, 0.1 wanted (0.03 in float): people who fall over "
     "each other, by chance",
     true},
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
    {"ellipsoidal_limit",
     "in double the torque turns by 1.2 % in a step while the joint gives way, 1 wanted, by chance of a "
     "last digit: with loads that are 1e-6 to 2e-4 greater by 1 to 7 % in one precision or both, as its "
     "direction is that of a rate of next to nothing"},
    {"baked_limbs",
     "limp hands whirl after blows that act at once, and no two runs stay together: with a blow that differs "
     "by 1e-4 unbaked ones are 36 degrees apart after two seconds, and baked ones 45 to 50 from unbaked "
     "ones; weak "
     "hands are within 0.1, but solved for in 0.92 of the steps"},
    {"root_turned_by_pi",
     "in float: 1.05 mrad apart from the figure that is not turned, 1 wanted: roundings ring longer with a "
     "spectral radius of 0.92 than with 0.8"},
};

constexpr std::initializer_list<KnownFailure> kKnownExcesses = {
    {"rope_with_heavy_tip", "p99 of 17 to 23 at 1/60 s, 92 at 1/30: a light rope's stiff directions"},
    {"bullet", "11 in the step in which it strikes, of 15 in a run"},
    {"limp_fall_counts", "17 at most, in float at 1/30 s; p99 4", true},
    {"limp_fall_bdf1", "73 at most; p99 within 8", true},
    {"limp_fall_bdf2", "47 at most; p99 within 8"},
    {"adjacent_limb_overlap", "42 at most; p99 5", true},
    {"figure_on_stairs", "55 at most; p99 within 6", true},
    {"figures_in_a_pile", "29 at most; p99 4", true},
    {"sixteen_piles_of_figures", "29 at most; p99 4", true},
    {"crowd_of_200",
     "p99 of 78, 172 at most: where not all that touch are solved together, solves do not converge"},
    {"ragdoll_hit_in_the_same_frame", "23 in the step of the hit, of 30 that are solved"},
    {"piston", "p99 of 18, 34 at most: a body that is squeezed has no place to go to"},
    {"soak_hour", "51 at most, p99 within 9: people fall over each other"},
    {"random_trees", "p99 of 112, 161 at most: see why they leap"},
    {"momentum_scheme", "p99 of 9 to 11, 25 at most; it is there to be compared with"},
};

const char* why(std::initializer_list<KnownFailure> list, const std::string& name, bool quick) {
  const auto known = std::find_if(list.begin(), list.end(), [&](const KnownFailure& k) {
    return name == k.name && !(quick && k.at_length);
  });
  return known == list.end() ? nullptr : known->why;
}

}  // namespace

const char* known_failure(const std::string& name, bool quick) {
  return why(kKnownFailures, name, quick);
}

const char* known_excess(const std::string& name, bool quick) {
  return why(kKnownExcesses, name, quick);
}

}  // namespace sinew::study
