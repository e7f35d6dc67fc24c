#include "study/scenes/tied.h"

#include <algorithm>

#include "study/scenes/at_rates.h"

namespace sinew::study {
namespace {

using scene::Scene;

void jerked_loops(const Scene& scene, bool, Findings& found) {
  const auto joint = [&](const char* name) {
    return static_cast<std::size_t>(scene.characters[0].asset->skeleton.find(name));
  };
  const struct {
    std::size_t hand;
    Vec3<double> from;
  } ropes[] = {{joint("hand_l"), {0, 3.2, 3.42}}, {joint("hand_r"), {0, 2.8, 3.42}}};
  double least = 1e9, most = 0;
  at_rates(scene, {30.0, 60.0, 120.0}, 1, 5e-3, found, [&](const Played& played, const Judge& judge) {
    const Vec3<double> hinge(0, 0, 0.6);
    double rises = 0;
    for (int f = 1; f < judge.frames(); ++f) {
      const auto& now = played.recording.frames[static_cast<std::size_t>(f)];
      const auto at = [](const auto& place) {
        return Vec3<double>(place.translation.template cast<double>());
      };
      found.at_most("hinge apart (m)", (at(now.props[0].world) - hinge).norm(), 1e-3);
      for (const auto& rope : ropes)
        found.at_most("rope longer (m)", (at(now.characters[0].model[rope.hand]) - rope.from).norm() - 1.4,
                      1e-3);
      rises = std::max(rises, at(now.props[1].world).z());
    }
    least = std::min(least, rises);
    most = std::max(most, rises);
  });
  found.at_most("light crate's height, highest by lowest of 30, 60 and 120 Hz", most / least, 1.1);
}

void hanging_bridge(const Scene& scene, bool, Findings& found) {
  at_rates(scene, kRates, 1, 5e-3, found, [&](const Played& played, const Judge& judge) {
    const int end = judge.frames() - 1;
    found.at_most("in each other (m)", deepest_between(judge, 1, end), 5e-3);
    found.at_most("fastest at the end (m/s)", judge.fastest(end), 0.05);
    note_passes(played, found);
  });
}

void hand_in_hand(const Scene& scene, bool, Findings& found) {
  at_rates(scene, kRates, 1, 5e-3, found, [&](const Played& played, const Judge& judge) {
    const int end = judge.frames() - 1;
    for (int a = 0; a < judge.members(); ++a)
      for (int b = a + 2; b < judge.members(); ++b)  // who holds whose hand is in it
        found.at_most("in each other (m)",
                      judge.worst(1, end, [&](int f) { return judge.depth_between(f, a, b); }), 5e-3);
    found.at_most("fastest in the last half second (m/s)",
                  fastest_of(judge, end - static_cast<int>(0.5 / judge.step()), end), 0.1);
    note_passes(played, found);
    note_times(played, found);
  });
}

void leash_too_short(const Scene& scene, bool, Findings& found) {
  at_rates(scene, {30.0, 60.0, 120.0, 240.0}, 1, 0.1, found, [&](const Played&, const Judge& judge) {
    const int end = judge.frames() - 1;
    found.at_most("fastest body (m/s)", fastest_of(judge, 1, end), 3);
    found.at_most("fastest in the last second (m/s)", fastest_of(judge, end * 3 / 4, end), 0.2);
  });
}

}  // namespace

std::vector<Situation> situations_of_what_is_tied() {
  return {
      {"jerked_loops", "a seesaw's hinge and ropes that catch hands stay closed", jerked_loops},
      {"hanging_bridge", "who falls on a hanging bridge comes to rest there", hanging_bridge},
      {"hand_in_hand", "four who hold hands come off a ledge and to rest", hand_in_hand},
      {"leash_too_short", "a loop yields to a driven root", leash_too_short},
  };
}

}  // namespace sinew::study
