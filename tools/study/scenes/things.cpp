#include "study/scenes/things.h"

#include <cmath>
#include <numbers>

#include "study/scenes/at_rates.h"

namespace sinew::study {
namespace {

using scene::Scene;

/// Members are characters, then props.
int member_of(const Scene& scene, std::size_t prop) {
  return static_cast<int>(scene.characters.size() + prop);
}

void lift_starts(const Scene& scene, bool, Findings& found) {
  constexpr double kPace = 2;  // m/s, of the lift
  at_rates(scene, kRates, 1, 5e-3, found, [&](const Played&, const Judge& judge) {
    const int end = judge.frames() - 1;
    for (std::size_t p = 0; p < scene.props.size(); ++p)
      found.at_most("fastest that stands on it, of its speed",
                    fastest_of(judge, 1, end, member_of(scene, p)) / kPace, 1.2);
    for (std::size_t p = 0; p < scene.props.size(); ++p)
      found.at_most(
          "moved along the lift (m)",
          (judge.center_of_mass(end, member_of(scene, p)) - judge.center_of_mass(0, member_of(scene, p)))
              .head<2>()
              .norm(),
          0.05);
  });
}

/// Once a ball rolls, 5/7 of its speed and 2/7 of its spin's are left, whatever friction there was.
void bowling(const Scene& scene, bool, Findings& found) {
  at_rates(scene, kRates, 1, 5e-3, found, [&](const Played&, const Judge& judge) {
    const int end = judge.frames() - 1;
    for (std::size_t p = 0; p < scene.props.size(); ++p) {
      const PropSettings& ball = scene.props[p].settings;
      const double begins = ball.velocity.x(), spins = ball.size.x() * ball.angular_velocity.y();
      const double rolls = (5 * begins + 2 * spins) / 7;
      found.at_most("off the speed of what rolls, of that and the spin's",
                    std::abs(judge.velocity(end, member_of(scene, p)).x() - rolls) /
                        (std::abs(begins) + std::abs(spins)),
                    0.02);
    }
  });
}

/// It precesses at m g a/(I ω), and stays as high.
void gyroscope(const Scene& scene, bool, Findings& found) {
  at_rates(scene, kRates, 1, 5e-3, found, [&](const Played&, const Judge& judge) {
    const PropSettings& top = scene.props[0].settings;
    const double radius = top.size.x(), arm = top.pose.translation.x(), spin = top.angular_velocity.x();
    const double wanted = 9.81 * arm / (0.4 * radius * radius * spin);
    const int end = judge.frames() - 1;
    double turned = 0, sinks = 0;
    for (int f = 1; f <= end; ++f) {
      const Eigen::Vector3d before = judge.center_of_mass(f - 1, 0), now = judge.center_of_mass(f, 0);
      turned += std::remainder(std::atan2(now.y(), now.x()) - std::atan2(before.y(), before.x()),
                               2 * std::numbers::pi);
      sinks = std::max(sinks, judge.center_of_mass(0, 0).z() - now.z());
    }
    found.at_most("off its precession, share", std::abs(turned / (end * judge.step()) / wanted - 1), 0.03);
    found.at_most("sinks (m)", sinks, 5e-3);
  });
}

void trolley(const Scene& scene, bool, Findings& found) {
  at_rates(scene, kRates, 1, 5e-3, found, [&](const Played&, const Judge& judge) {
    const double begins = scene.props[0].settings.velocity.x();
    found.at_most("lost of its speed, share", 1 - judge.velocity(judge.frames() - 1, 0).x() / begins, 0.02);
  });
}

/// Of what spins, the last but the frame: its spin, from poses a quarter of a second apart at most.
void flywheels(const Scene& scene, bool, Findings& found) {
  at_rates(scene, kRates, 1, 5e-3, found, [&](const Played& played, const Judge& judge) {
    const int end = judge.frames() - 1;
    for (int m = 0; m < judge.members(); ++m) {
      const double spin = scene.props[static_cast<std::size_t>(m)].settings.angular_velocity.z();
      if (spin == 0) continue;
      const auto turned = [&](int frame) {
        const auto rotation = [&](int f) {
          return played.recording.frames[static_cast<std::size_t>(f)]
              .props[static_cast<std::size_t>(m)]
              .world.rotation.cast<double>();
        };
        return rotation(frame - 1).angularDistance(rotation(frame)) / judge.step();
      };
      found.at_most("lost of a spin, share", 1 - turned(end) / turned(2), 0.01);
    }
  });
}

/// Newton's: the ball leaves the bat at e times the speed at which it came.
void bat(const Scene& scene, bool, Findings& found) {
  constexpr double kPace = 5;  // m/s, of the bat
  at_rates(scene, kRates, 1, 5e-3, found, [&](const Played&, const Judge& judge) {
    const double leaves = kPace * (1 + scene.props[0].settings.restitution);
    found.at_most("off the speed of a bounce, share",
                  std::abs(judge.velocity(judge.frames() - 1, member_of(scene, 0)).x() / leaves - 1), 0.02);
  });
}

/// m: the mannequin's own walk takes its toes so far into the floor, and a little more.
constexpr double kToesOfItsWalk = 0.015;

/// Nobody is deeper in another than `most` m.
void walk_into_each_other(const Scene& scene, double most, Findings& found) {
  at_rates(scene, kRates, 1, kToesOfItsWalk, found, [&](const Played&, const Judge& judge) {
    found.at_most("in each other (m)",
                  judge.worst(1, judge.frames() - 1, [&](int f) { return judge.depth_between(f); }), most);
  });
}

void door(const Scene& scene, bool, Findings& found) {
  walk_into_each_other(scene, 5e-3, found);
}

void crossing(const Scene& scene, bool, Findings& found) {
  walk_into_each_other(scene, 0.015, found);
}

}  // namespace

std::vector<Situation> situations_of_things() {
  return {
      {"lift_starts", "what stands on a lift goes along with it", lift_starts},
      {"bowling", "balls that slide and spin roll at last as they must", bowling},
      {"gyroscope", "a top goes round instead of falling", gyroscope},
      {"trolley", "nothing brakes a trolley", trolley},
      {"flywheels", "wheels on hinges spin on", flywheels},
      {"door", "who walks against a door kicks it open", door},
      {"crossing", "who stumble over each other tread on the floor, not in it", crossing},
      {"bat", "a bat gives a ball its own speed, too", bat},
  };
}

}  // namespace sinew::study
