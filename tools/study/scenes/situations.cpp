// What is asked in each situation.
#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "study/scenes/at_rates.h"
#include "study/scenes/situation.h"
#include "study/scenes/things.h"
#include "study/scenes/tied.h"

namespace sinew::study {
namespace {

using scene::Scene;

int seeds(bool quick, int full, int shortened = 1) {
  return quick ? shortened : full;
}

Scene alone(Scene scene) {
  scene.characters.resize(1);
  scene.props.clear();
  std::erase_if(scene.pushes, [](const scene::Push& p) { return p.character != 0; });
  return scene;
}

double furthest_apart(const Played& a, const Played& b, int member = 0) {
  double most = 0;
  for (int f = 0; f < a.judge().frames(); ++f)
    most = std::max(most, apart(a.recording, member, b.recording, member, f));
  return most;
}

constexpr double kBeside = 0.1;  ///< m: nearer than that it is no bystander

void bystanders(const Scene& scene, bool quick, Findings& found) {
  for (int seed = 0; seed < seeds(quick, 8, 2); ++seed) {
    const Scene thrown = reseeded(scene, seed);
    const Played with(thrown), without(alone(thrown));
    found.sound(with, 5e-3);
    if (!found.refused().empty()) return;
    const Judge judge = with.judge();
    int last = 0;  // that it may be compared in
    while (last + 1 < judge.frames() && judge.distance_from_others(last + 1, 0) > kBeside) ++last;
    found.at_least("compared before anybody is near (s)", last * judge.step(), 0.7);
    double away = 0;
    for (int f = 0; f <= last; ++f) away = std::max(away, apart(with.recording, 0, without.recording, 0, f));
    found.at_most("away from where it is alone (m)", away, 0);
  }
}

void levels(const Scene& scene, bool, Findings& found) {
  Scene capped = scene;
  capped.characters[1].settings.detail.most = Level::kPlayback;
  const Played full(scene), cut(capped);
  found.sound(full, 5e-3);
  found.at_most("away from where it is otherwise (m)", furthest_apart(full, cut), 0);
}

void corner(const Scene& scene, bool quick, Findings& found) {
  at_rates(scene, {60.0, 30.0, 15.0}, seeds(quick, 4), 0.02, found, [&](const Played&, const Judge& judge) {
    found.at_most("in each other at the end (m)", judge.depth_between(judge.frames() - 1), 0.01);
    found.at_most("fastest body after the first second (m/s)",
                  fastest_of(judge, judge.frame_at(1), judge.frames() - 1), 8);
  });
}

void pit(const Scene& scene, bool quick, Findings& found) {
  Scene shortened = scene;
  if (quick) shortened.duration = 1;
  const Played played(shortened);
  found.sound(played, 0.02);
  const Judge judge = played.judge();
  found.at_most("in each other (m)", deepest_between(judge, 1, judge.frames() - 1), 0.03);
  found.at_most("fastest body (m/s)", fastest_of(judge, 1, judge.frames() - 1), 15);
  note_times(played, found);
}

void nosing(const Scene& scene, bool, Findings& found) {
  const Played played(scene);
  found.sound(played, 5e-3);
  const Judge judge = played.judge();
  const int end = judge.frames() - 1;
  found.at_most("sinks from where it stands (m)",
                judge.center_of_mass(0, 0).z() - judge.center_of_mass(end, 0).z(), 0.01);
  found.at_most("moves at the end (m/s)", judge.fastest(end), 0.01);
}

void narrow(const Scene& scene, bool, Findings& found) {
  at_rates(scene, {60.0, 30.0}, 1, 5e-3, found, [&](const Played&, const Judge& judge) {
    const int end = judge.frames() - 1;
    found.at_most("in each other (m)", deepest_between(judge, 1, end), 5e-3);
    static constexpr const char* kWho[] = {"crate", "plank", "plank across", "staff", "staff across", "slab"};
    for (int m = 0; m < judge.members(); ++m) {
      const double sank = judge.center_of_mass(0, m).z() - judge.center_of_mass(end, m).z();
      found.at_most((std::string(kWho[m]) + " falls (m)").c_str(), sank, 0.01);
    }
  });
}

void tumbling_crates(const Scene& scene, bool, Findings& found) {
  const Played played(scene);
  found.sound(played, 5e-3);
  const Judge judge = played.judge();
  found.at_most("in each other (m)", deepest_between(judge, 1, judge.frames() - 1), 5e-3);
  found.at_most("fastest at the end (m/s)", judge.fastest(judge.frames() - 1), 0.02);
}

void pile(const Scene& scene, bool quick, Findings& found) {
  for (int seed = 0; seed < seeds(quick, 3); ++seed) {
    const Played played(reseeded(scene, seed));
    found.sound(played, 5e-3);
    const Judge judge = played.judge();
    const int end = judge.frames() - 1;
    found.at_most("in each other (m)", deepest_between(judge, 1, end), 0.01);
    found.at_most("fastest body at the end (m/s)", judge.fastest(end), 0.1);
    note_times(played, found);
  }
}

void crowd_pushed(const Scene& scene, bool, Findings& found) {
  const Played played(scene);
  found.sound(played, 0.01);
  const Judge judge = played.judge();
  const int end = judge.frames() - 1;
  found.at_most("in each other (m)", deepest_between(judge, 1, end), 0.02);
  found.at_most("fastest body (m/s)", fastest_of(judge, 1, end), 15);
  double away = 0;
  for (int m = 0; m < judge.members(); ++m)
    away = std::max(away, (judge.center_of_mass(end, m) - judge.center_of_mass(0, m)).norm());
  found.at_most("away from its place at the end (m)", away, 0.01);
  note_times(played, found);
}

void back_from_ragdoll(const Scene& scene, bool, Findings& found) {
  const Played played(scene);
  found.sound(played, 5e-3);
  const Judge judge = played.judge();
  double lay = 1e9, away = 0;
  for (int f = judge.frame_at(2.5); f <= judge.frame_at(3); ++f)
    lay = std::min(lay, judge.center_of_mass(f, 0).z());
  found.at_most("height at which it lay (m)", lay, 0.35);
  for (int f = judge.frame_at(4); f < judge.frames(); ++f) {
    const auto& now = played.recording.frames[static_cast<std::size_t>(f)].characters[0].model;
    const auto& first = played.recording.frames[0].characters[0].model;
    for (std::size_t i = 0; i < now.size(); ++i)
      away = std::max(away, double((now[i].translation - first[i].translation).norm()));
  }
  found.at_most("away from its target a second later (m)", away, 1e-3);
}

void driven_through(const Scene& scene, bool, Findings& found) {
  const Played played(scene);
  found.sound(played, 0.02);
  const Judge judge = played.judge();
  const int end = judge.frames() - 1;
  double crates = 0;
  for (int m = 2; m < judge.members(); ++m) crates = std::max(crates, fastest_of(judge, 1, end, m));
  found.at_most("fastest crate (m/s)", crates, 4);
  found.at_most("fastest body of who lies (m/s)", fastest_of(judge, 1, end, 1), 6);
  found.at_most("in each other (m)", deepest_between(judge, 1, end), 0.03);
}

void in_one_another(const Scene& scene, bool, Findings& found) {
  const Played played(scene);
  found.sound(played, 1e-3);
  const Judge judge = played.judge();
  const int end = judge.frames() - 1;
  found.at_most("fastest body (m/s)", fastest_of(judge, 1, end), 2);
  found.at_most("in each other at the end (m)", judge.depth_between(end), 5e-3);
}

/// The same scene for a figure of `size` times the lengths and its cube times the masses.
Scene scaled(Scene scene, double size) {
  for (scene::SceneCharacter& c : scene.characters) {
    auto asset = std::make_shared<Asset>(*c.asset);
    Skeleton& s = asset->skeleton;
    for (Joint& joint : s.joints) {
      joint.rest.translation *= size;
      joint.center_of_mass *= size;
      joint.mass *= std::pow(size, 3);
      joint.inertia *= std::pow(size, 5);
      for (DofLimits& dof : joint.dofs) {
        dof.torque_minus *= std::pow(size, 4);
        dof.torque_plus *= std::pow(size, 4);
        dof.dry_friction *= std::pow(size, 4);
        dof.damping *= std::pow(size, 4.5);
      }
    }
    for (Collider& collider : s.colliders) {
      collider.local.translation *= size;
      collider.size *= size;
    }
    c.asset = asset;
    c.position *= size;
    c.speeds.random /= std::sqrt(size);
  }
  scene.duration *= std::sqrt(size);
  scene.frame_rate /= std::sqrt(size);
  return scene;
}

void collapse(const Scene& scene, bool, Findings& found) {
  const Played human(scene);
  found.sound(human, 2e-3);
  const Judge of_human = human.judge();
  for (const double size : {1.0 / 15, 0.2, 3.0, 10.0}) {
    const Played other(scaled(scene, size));
    if (!other.refused.empty()) return found.refuse(other.refused);
    const Judge judge = other.judge();
    double most = 0;
    for (int f = 0; f < std::min(judge.frames(), of_human.frames()); ++f)
      most = std::max(most, (judge.center_of_mass(f, 0) / size - of_human.center_of_mass(f, 0)).norm());
    found.at_most("centre of mass, from the human's (human's m)", most, 0.05);
    found.at_most(
        "deepest in the floor (human's m)",
        judge.worst(1, judge.frames() - 1, [&](int f) { return judge.depth_in_surroundings(f) / size; }),
        5e-3);
  }
}

Vec3<double> place_of(const Played& played, int member, int joint, double t) {
  const auto frame = static_cast<std::size_t>(played.judge().frame_at(t));
  const auto& model = played.recording.frames[frame].characters[static_cast<std::size_t>(member)].model;
  return model[static_cast<std::size_t>(joint)].translation.template cast<double>();
}

/// m, furthest that any joint of a character is from where it is in another recording, or in its first frame.
double off(const Played& played, int member, double t, const Played* other = nullptr) {
  const auto at = [&](const Played& of, int frame) -> const auto& {
    return of.recording.frames[static_cast<std::size_t>(frame)]
        .characters[static_cast<std::size_t>(member)]
        .model;
  };
  const int frame = played.judge().frame_at(t);
  const auto &now = at(played, frame), &wanted = other ? at(*other, frame) : at(played, 0);
  double most = 0;
  for (std::size_t i = 0; i < now.size(); ++i)
    most = std::max(most, double((now[i].translation - wanted[i].translation).norm()));
  return most;
}

constexpr double kFine = 1920;  ///< Hz, in double precision and solved to 1e-8 m: the truth

/// m, that a hit has moved a joint of whom it struck after a tenth of a second, at a rate of steps.
double way_of_hit(const Scene& scene, double hz, double share, int joint) {
  Scene at = scene;
  at.frame_rate = hz;
  if (hz == kFine) {
    at.double_precision = true;
    at.world.accuracy.tolerance = 1e-8;
  }
  at.pushes[0].impulse *= share;
  const Played struck(at);
  at.pushes.clear();
  const Played unhurt(at);
  const double t = scene.pushes[0].time + 0.1;
  return (place_of(struck, 0, joint, t) - place_of(unhurt, 0, joint, t)).norm();
}

void compare_ways(const Scene& scene, const char* name, double share, int joint, Findings& found) {
  const double truth = way_of_hit(scene, kFine, share, joint);
  for (const double hz : {120.0, 60.0, 30.0})
    found.at_most(name, std::abs(way_of_hit(scene, hz, share, joint) / truth - 1), 0.05);
}

void hit_on_the_hand(const Scene& scene, bool, Findings& found) {
  const int hand = scene.pushes[0].joint;
  compare_ways(scene, "hand's way after 0.1 s, from that at 1/1920 s", 1, hand, found);
  compare_ways(scene, "the same of a sixth of the hit", 1.0 / 6, hand, found);
}

void hit_in_a_walk(const Scene& scene, bool, Findings& found) {
  const int hand = scene.characters[0].asset->skeleton.find("hand_l");
  compare_ways(scene, "hand's way after 0.1 s, from that at 1/1920 s", 1, hand, found);
  Scene unhurt = scene;
  unhurt.pushes.clear();
  const Played struck(scene), walks(unhurt);
  found.sound(struck, 0.02);
  found.at_most("off its walk a second later (m)", off(struck, 0, scene.pushes[0].time + 1, &walks), 1e-3);
}

void weak_arm(const Scene& scene, bool, Findings& found) {
  const int hand = scene.characters[0].asset->skeleton.find("hand_l");
  compare_ways(scene, "elbow's way after 0.1 s, from that at 1/1920 s", 1, scene.pushes[0].joint, found);
  compare_ways(scene, "hand's", 1, hand, found);
}

void shoulder_to_shoulder(const Scene& scene, bool, Findings& found) {
  at_rates(scene, {60.0, 30.0}, 1, 5e-3, found, [&](const Played& played, const Judge& judge) {
    const int end = judge.frames() - 1;
    found.at_most("in each other (m)", deepest_between(judge, 1, end), 0.01);
    found.at_most("fastest body (m/s)", fastest_of(judge, 1, end), 12);
    for (int m = 0; m < judge.members(); ++m)
      found.at_most("off its place two seconds later (m)", off(played, m, scene.pushes[0].time + 2), 1e-3);
  });
}

void carried_crate(const Scene& scene, bool, Findings& found) {
  const auto gap = [&](const Played& played, int frame) {
    const auto& now = played.recording.frames[static_cast<std::size_t>(frame)];
    double most = 0;
    for (const char* hand : {"hand_l", "hand_r"}) {
      const auto joint = static_cast<std::size_t>(scene.characters[0].asset->skeleton.find(hand));
      const Vec3<double> held(0, hand[5] == 'l' ? 0.2 : -0.2, 0);
      const Vec3<double> on_crate = now.props[0].world.template cast<double>() * held;
      most = std::max(most,
                      (now.characters[0].model[joint].translation.template cast<double>() - on_crate).norm());
    }
    return most;
  };
  at_rates(scene, {60.0, 30.0}, 1, 5e-3, found, [&](const Played& played, const Judge& judge) {
    const int end = judge.frames() - 1, hit = judge.frame_at(scene.pushes[0].time);
    found.at_most("hands off the crate (m)", judge.worst(hit, end, [&](int f) { return gap(played, f); }),
                  2e-3);
    found.at_most("fastest body (m/s)", fastest_of(judge, hit, end), 12);
    found.at_most(
        "off where it was held a second later (m)",
        (judge.center_of_mass(judge.frame_at(scene.pushes[0].time + 1), 1) - judge.center_of_mass(hit, 1))
            .norm(),
        1e-3);
  });
}

void thrown_at_each_other(const Scene& scene, bool quick, Findings& found) {
  at_rates(scene, {60.0, 30.0}, seeds(quick, 6, 2), 5e-3, found, [&](const Played&, const Judge& judge) {
    found.at_most("in each other (m)", deepest_between(judge, 1, judge.frames() - 1), 0.01);
    double start = 0, most = 0;
    for (int m = 0; m < 2; ++m) start += judge.kinetic(1, m);
    for (int f = 1; f <= judge.frame_at(0.6); ++f)
      most = std::max(most, judge.kinetic(f, 0) + judge.kinetic(f, 1));
    found.at_most("kinetic energy, of what they began with", most / start, 1.15);
  });
}

void long_rest(const Scene& scene, bool quick, Findings& found) {
  Scene shortened = scene;
  if (quick) shortened.duration = 12;
  const Played played(shortened);
  found.sound(played, 5e-3);
  const Judge judge = played.judge();
  const int end = judge.frames() - 1, settled = judge.frame_at(8);
  double drift = 0;
  for (int m = 0; m < judge.members(); ++m)
    drift = std::max(drift, (judge.center_of_mass(end, m) - judge.center_of_mass(settled, m)).norm());
  found.at_most("creeps after 8 s (m)", drift, 0.01);
  found.at_most("in each other at the end (m)", judge.depth_between(end), 5e-3);
}

/// Nothing is deeper in anything than `depth` m, and in the last frame nothing moves faster than `rest` m/s.
void lies_still(const Scene& scene, double depth, double rest, Findings& found, int throws = 1) {
  at_rates(scene, kRates, throws, 5e-3, found, [&](const Played&, const Judge& judge) {
    const int end = judge.frames() - 1;
    found.at_most("in each other (m)", deepest_between(judge, 1, end), depth);
    found.at_most("fastest at the end (m/s)", judge.fastest(end), rest);
  });
}

void heap_of_boxes(const Scene& scene, bool, Findings& found) {
  lies_still(scene, 0.01, 0.02, found);
}

void rubble(const Scene& scene, bool quick, Findings& found) {
  lies_still(scene, 0.01, 0.1, found, seeds(quick, 6, 2));
}

void planks(const Scene& scene, bool, Findings& found) {
  lies_still(scene, 0.01, 0.05, found);
}

void heavy_on_light(const Scene& scene, bool, Findings& found) {
  lies_still(scene, 5e-3, 0.05, found);
}

void stairs(const Scene& scene, bool quick, Findings& found) {
  lies_still(scene, 5e-3, 0.1, found, seeds(quick, 6, 2));
}

void wall_of_bricks(const Scene& scene, bool, Findings& found) {
  at_rates(scene, kRates, 1, 5e-3, found, [&](const Played&, const Judge& judge) {
    const int end = judge.frames() - 1, ball = judge.members() - 1;
    found.at_most("in each other (m)", deepest_between(judge, 1, end), 0.01);
    double fastest = 0;
    for (int m = 0; m < ball; ++m) fastest = std::max(fastest, fastest_of(judge, 1, end, m));
    found.at_most("fastest brick (m/s)", fastest, 24);  // all of twice the ball's speed, at most
  });
}

void thin_wall(const Scene& scene, bool quick, Findings& found) {
  const double wall = scene.obstacles[0].local.translation.x();
  at_rates(scene, kRates, seeds(quick, 6, 2), 5e-3, found, [&](const Played&, const Judge& judge) {
    int through = 0;
    for (int m = 0; m < judge.members(); ++m)
      through += judge.center_of_mass(judge.frames() - 1, m).x() > wall;
    found.at_most("are behind the wall", through, 0);
  });
}

void round_obstacles(const Scene& scene, bool, Findings& found) {
  lies_still(scene, 5e-3, 1, found);  // what is round rolls on for a while
}

void past_a_platform(const Scene& scene, bool, Findings& found) {
  const auto way = [&](double hz, bool by_itself) {
    Scene at = scene;
    at.frame_rate = hz;
    if (by_itself) at.characters.clear();
    const Played played(at);
    const Judge judge = played.judge();
    const int box = judge.members() - 1;
    return judge.center_of_mass(judge.frames() - 1, box).x() - judge.center_of_mass(0, box).x();
  };
  const double truth = way(960, true);
  for (const double hz : kRates) {
    found.at_most("way, from that in steps of 1/960 s", std::abs(way(hz, true) / truth - 1), 0.03);
    found.at_most("away from where it stops alone (m)", std::abs(way(hz, false) - way(hz, true)), 0);
  }
}

void bouncing_ball(const Scene& scene, bool, Findings& found) {
  at_rates(scene, kRates, 1, 5e-3, found, [&](const Played&, const Judge& judge) {
    const Eigen::Vector3d before = judge.velocity(1, 0), after = judge.velocity(judge.frames() - 1, 0);
    found.at_most("speed along the floor, from 5/7 of what it had",
                  std::abs(after.x() / before.x() / (5.0 / 7) - 1), 0.03);
  });
}

/// What is left of each ball's speed along its flight, behind whom it is thrown at.
void balls_at_heads(const Scene& scene, bool, Findings& found) {
  constexpr double kAnyDepth = 1e9;  // m: balls that wait are far below
  at_rates(scene, kRates, 1, kAnyDepth, found, [&](const Played&, const Judge& judge) {
    const int people = static_cast<int>(scene.characters.size());
    double left = -1;
    for (int m = people; m < judge.members(); ++m) {
      const Eigen::Vector3d thrown = judge.velocity(judge.frame_at(0.15), m);
      left = std::max(left, judge.velocity(judge.frame_at(0.4), m).dot(thrown) / thrown.squaredNorm());
    }
    found.at_most("of a ball's speed is left", left, 0.7);
  });
}

/// Nothing flies through whom it is thrown at, nor into him. What lies in front of him at the end did not.
void thrown_at_who_stands(const Scene& scene, bool, Findings& found) {
  at_rates(scene, {15.0, 30.0, 60.0, 120.0}, 1, 0.02, found, [&](const Played&, const Judge& judge) {
    const int end = judge.frames() - 1, people = static_cast<int>(scene.characters.size());
    if (judge.step() < 0.04) found.at_most("in each other (m)", deepest_between(judge, 1, end), 0.02);
    for (int n = 0; n < people; ++n) {
      const PropSettings& thrown = scene.props[static_cast<std::size_t>(n)].settings;
      const double ahead =
          (judge.center_of_mass(end, people + n) - judge.center_of_mass(end, n)).dot(thrown.velocity);
      if (thrown.mass < 100) found.at_most("beyond him (m · m/s)", ahead, 0);
    }
  });
}

/// Nobody is pushed: who has only the ground does what he would do if his root were driven.
void own_blends(const Scene& scene, bool, Findings& found) {
  Scene driven = scene;
  for (scene::SceneCharacter& c : driven.characters) c.root = {{0, RootDrive::kKinematic}};
  constexpr double kAnyDepth = 1e9;  // m: blends take toes into the floor
  at_rates(scene, kRates, 1, kAnyDepth, found, [&](const Played&, const Judge& judge) {
    driven.frame_rate = 1 / judge.step();
    const Played led(driven);
    const Judge wanted = led.judge();
    const int end = judge.frames() - 1;
    int fallen = 0;
    double off = 0;
    for (int m = 0; m < judge.members(); ++m) {
      const auto height = [&](int f) { return judge.center_of_mass(f, m).z(); };
      fallen += judge.worst(0, end, [&](int f) { return 1 - height(f) / height(0); }) > 0.3;
      off = std::max(off, (judge.center_of_mass(end, m) - wanted.center_of_mass(end, m)).norm());
    }
    found.at_most("fall", fallen, 0);
    found.at_most("off where a driven root takes them (m)", off, 0.1);
  });
}

/// The same scene where nothing but a floor at `height` is beside it.
Scene on_the_floor(Scene scene) {
  scene.obstacles.clear();
  scene.props.clear();
  for (scene::SceneCharacter& c : scene.characters) c.position.z() = 0;
  return scene;
}

void run_on_a_platform(const Scene& scene, bool, Findings& found) {
  for (const double hz : {30.0, 60.0, 120.0}) {
    Scene at = scene;
    at.frame_rate = hz;
    const Played runs(at), on_floor(on_the_floor(at));
    if (!runs.refused.empty()) return found.refuse(runs.refused);
    const Eigen::Vector3d up(0, 0, scene.characters[0].position.z());
    double most = 0;
    for (std::size_t f = 0; f < runs.recording.frames.size(); ++f) {
      const auto &now = runs.recording.frames[f].characters[0].model,
                 &wanted = on_floor.recording.frames[f].characters[0].model;
      for (std::size_t i = 0; i < now.size(); ++i)
        most = std::max(most,
                        ((now[i].translation - wanted[i].translation).template cast<double>() - up).norm());
    }
    found.at_most("off what it runs on the floor (m)", most, 1e-4);
  }
}

/// Members by turns: what is ridden, and who rides it.
void moving_ground(const Scene& scene, bool, Findings& found) {
  at_rates(scene, {30.0, 60.0, 120.0}, 1, 0.03, found, [&](const Played& played, const Judge& judge) {
    const int end = judge.frames() - 1;
    const auto from_ground = [&](int frame, int m) {
      const auto& model = played.recording.frames[static_cast<std::size_t>(frame)].characters;
      const auto ground = static_cast<std::size_t>(m - 1);
      return Eigen::Vector3d(model[ground].model[0].rotation.conjugate().template cast<double>() *
                             (judge.center_of_mass(frame, m) - judge.center_of_mass(frame, m - 1)));
    };
    for (int m = 1; m < judge.members(); m += 2) {
      const Eigen::Vector3d first = from_ground(0, m), last = from_ground(end, m);
      double lowest = first.z();
      for (int f = 0; f <= end; ++f) lowest = std::min(lowest, from_ground(f, m).z());
      found.at_least("lowest centre of mass over its ground (m)", lowest, 0.8);
      found.at_most("from where it stood on its ground at the end (m)", (last - first).norm(), 0.6);
    }
  });
}

void level_below(const Scene& scene, bool, Findings& found) {
  at_rates(scene, {30.0, 60.0, 120.0}, 1, 0.03, found, [&](const Played&, const Judge& judge) {
    const int end = judge.frames() - 1;
    const double height = judge.center_of_mass(0, 0).z() - 1, now = judge.center_of_mass(end, 0).z();
    found.at_most("higher or lower at the end than it stands on the floor (m)", std::abs(now - height), 0.02);
    found.at_most("fastest body at the end (m/s)", judge.fastest(end, 0), 0.3);
  });
}

/// m, that whoever was pushed is off where it would be otherwise, `later` (s) than the push or after it.
double off_its_clip(const Scene& scene, double hz, double later, Findings& found) {
  Scene at = scene;
  at.frame_rate = hz;
  const Played struck(at);
  if (!struck.refused.empty()) found.refuse(struck.refused);
  at.pushes.clear();
  const Played unhurt(at);
  double most = 0;
  for (double t = scene.pushes[0].time + later; t < scene.duration; t += 1 / hz)
    most = std::max(most, off(struck, 0, t, &unhurt));
  return most;
}

void tap_in_a_run(const Scene& scene, bool, Findings& found) {
  for (const double hz : {24.0, 25.0, 30.0, 60.0, 120.0})
    found.at_most("off its clip 1.5 s later (m)", off_its_clip(scene, hz, 1.5, found), 1e-3);
}

void toned_tap(const Scene& scene, bool, Findings& found) {
  for (const double hz : kRates)
    found.at_most("off its clip 4 s later (m)", off_its_clip(scene, hz, 4, found), 1e-3);
}

void cape_in_a_run(const Scene& scene, bool, Findings& found) {
  for (const double hz : kRates) {
    Scene with = scene, without = scene;
    without.particles.clear();
    with.frame_rate = without.frame_rate = hz;
    const Played wears(with), runs(without);
    found.sound(wears, 0.02);
    double furthest = 0;
    for (double t = 0.5; t < scene.duration; t += 0.1) furthest = std::max(furthest, off(wears, 0, t, &runs));
    found.at_most("runner off his clip (m)", furthest, 0.02);
    note_times(wears, found);
  }
}

void back_over_the_floor(const Scene& scene, bool, Findings& found) {
  Scene stands = scene;
  stands.pushes.clear();
  stands.characters[0].strength = {{0, 1}};
  stands.characters[0].root = {{0, RootDrive::kKinematic}};
  at_rates(scene, kRates, 1, 0.02, found, [&](const Played& played, const Judge& judge) {
    stands.frame_rate = 1 / judge.step();
    const Played unhurt(stands);
    found.at_most("off its clip 2 s later (m)", off(played, 0, 4.5, &unhurt), 1e-3);
  });
}

void elbow_to_its_stop(const Scene& scene, bool, Findings& found) {
  const double truth = off_its_clip(scene, 960, 0, found);
  for (const double hz : kRates)
    found.at_most("furthest off its walk, from that at 1/960 s",
                  std::abs(off_its_clip(scene, hz, 0, found) / truth - 1), 0.2);
}

void moves_at_walking_pace(const Scene& scene, bool, Findings& found) {
  at_rates(scene, {30.0, 60.0, 120.0, 240.0}, 1, 2, found, [&](const Played&, const Judge& judge) {
    // A foot swings at 4.7 m/s.
    found.at_most("fastest body (m/s)", fastest_of(judge, 1, judge.frames() - 1), 8);
  });
}

void slope(const Scene& scene, bool, Findings& found) {
  at_rates(scene, kRates, 1, 5e-3, found, [&](const Played&, const Judge& judge) {
    const int from = judge.frame_at(12), end = judge.frames() - 1;
    for (int m = 0; m < judge.members(); ++m)
      found.at_most("creeps in six seconds (m)",
                    (judge.center_of_mass(end, m) - judge.center_of_mass(from, m)).norm(), 1e-3);
  });
}

void rolling(const Scene& scene, bool, Findings& found) {
  at_rates(scene, kRates, 1, 5e-3, found, [&](const Played&, const Judge& judge) {
    const int end = judge.frames() - 1;
    for (int m = 0; m < judge.members(); ++m) {
      const double way = (judge.center_of_mass(end, m) - judge.center_of_mass(0, m)).norm();
      const double free =
          scene.props[static_cast<std::size_t>(m)].settings.velocity.norm() * end * judge.step();
      found.at_most("off the way of what nothing brakes, share", std::abs(way / free - 1), 0.02);
    }
  });
}

void thin_things(const Scene& scene, bool, Findings& found) {
  at_rates(scene, kRates, 1, 5e-3, found, [&](const Played&, const Judge& judge) {
    const int end = judge.frames() - 1;
    found.at_most("in each other (m)", deepest_between(judge, 1, end), 5e-3);
    found.at_most("fastest at the end (m/s)", judge.fastest(end), 0.02);
  });
}

void getting_up(const Scene& scene, bool, Findings& found) {
  at_rates(scene, kRates, 1, 0.03, found, [&](const Played&, const Judge& judge) {
    found.at_least("height of the centre of mass at the end (m)",
                   judge.center_of_mass(judge.frames() - 1, 0).z(), 0.8);
  });
}

/// One of two columns, as many as the other.
Scene column(Scene scene, bool second) {
  const auto half = scene.characters.begin() + static_cast<std::ptrdiff_t>(scene.characters.size() / 2);
  if (second)
    scene.characters.erase(scene.characters.begin(), half);
  else
    scene.characters.erase(half, scene.characters.end());
  return scene;
}

void columns(const Scene& scene, bool, Findings& found) {
  at_rates(scene, kRates, 1, 0.02, found, [&](const Played& played, const Judge& judge) {
    const int end = judge.frames() - 1;
    found.at_most("in each other (m)", deepest_between(judge, 1, end), 0.03);
    found.at_most("fastest body (m/s)", fastest_of(judge, 1, end), 15);
    const int half = judge.members() / 2;
    for (const bool second : {false, true}) {
      Scene alone = column(scene, second);
      alone.frame_rate = played.recording.frame_rate;
      const Played undisturbed(alone);
      for (int m = 0; m < half; ++m)
        found.at_most("off its clip at the end (m)",
                      apart(played.recording, m + (second ? half : 0), undisturbed.recording, m, end), 0.01);
    }
    note_times(played, found);
    note_passes(played, found);
  });
}

}  // namespace

std::vector<Situation> situations() {
  std::vector<Situation> all = {
      {"bystanders", "what is near and never touches changes nothing, to the bit", bystanders},
      {"levels", "another's detail changes nothing", levels},
      {"corner", "ten figures at 15 m/s stay above the floor and before the walls", corner},
      {"pit", "twelve figures and 300 balls", pit},
      {"nosing", "feet stand on the edge of a step", nosing},
      {"narrow", "what lies on something narrower than itself stays there", narrow},
      {"tumbling_crates", "crates fall edge first and come to rest on each other", tumbling_crates},
      {"pile", "ten limp figures come to rest on each other", pile},
      {"crowd_pushed", "twenty figures are hit at once and stand up again", crowd_pushed},
      {"back_from_ragdoll", "who lay limp is on its animation a second after it may", back_from_ragdoll},
      {"led_through", "a driven figure walks through crates and over one who lies", driven_through},
      {"in_one_another", "what was made in one another parts at a walking pace", in_one_another},
      {"collapse", "a giant and a mouse collapse as a human does, in their own time", collapse},
      {"hit_on_the_hand", "a hit has the effect of fine steps at 120, 60 and 30 Hz", hit_on_the_hand},
      {"hit_in_a_walk", "so it has in a walk, and a second later it is walked on", hit_in_a_walk},
      {"weak_arm", "and where muscles have a tenth of their strength", weak_arm},
      {"shoulder_to_shoulder", "one of three is hit from the side, and all stand again",
       shoulder_to_shoulder},
      {"carried_crate", "hands keep a crate when an arm is hit, and bring it back", carried_crate},
      {"thrown_at_each_other", "two figures collide at 8 m/s", thrown_at_each_other},
      {"long_rest", "limp figures lie still", long_rest},
      {"bouncing_ball", "5/7 of the speed along the floor is left", bouncing_ball},
      {"heap_of_boxes", "boxes that fall in a heap come to rest", heap_of_boxes},
      {"rubble", "who falls among rocks and barrels, and they, come to rest", rubble},
      {"planks", "planks that fall across each other come to rest", planks},
      {"heavy_on_light", "a hundred times the weight lies on crates, and light ones on a figure",
       heavy_on_light},
      {"stairs", "a limp figure falls down stairs", stairs},
      {"wall_of_bricks", "a ball breaks through a wall of bricks", wall_of_bricks},
      {"thin_wall", "nothing flies through a thin wall", thin_wall},
      {"round_obstacles", "boxes and figures lie on balls and rails", round_obstacles},
      {"past_a_platform", "what slides past a platform stops as it does alone", past_a_platform},
      {"balls_at_heads", "no ball flies through a head", balls_at_heads},
      {"own_blends", "whom only the ground holds blends from clip to clip", own_blends},
      {"thrown_at_who_stands", "nor does anything through whom only the ground holds", thrown_at_who_stands},
      {"run_on_a_platform", "on a platform it runs as on the floor", run_on_a_platform},
      {"low_boards", "nor do boards of 1 and 2 cm stop who walks", run_on_a_platform},
      {"tap_in_a_run", "who was tapped runs on as its clip does", tap_in_a_run},
      {"toned_tap", "nor does a tone keep a runner off its clip", toned_tap},
      {"cape_in_a_run", "a cape that legs crumple does not stop a runner", cape_in_a_run},
      {"back_over_the_floor", "no limb goes through the floor on its way back", back_over_the_floor},
      {"elbow_to_its_stop", "a hit into a joint's stop has the effect of fine steps", elbow_to_its_stop},
      {"handcuffs", "a rope that begins too short closes at a walking pace", moves_at_walking_pace},
      {"slope", "what lies on a slope stays where it is", slope},
      {"rolling", "nothing brakes what rolls", rolling},
      {"thin_things", "books, boards and plates lie on each other on the floor", thin_things},
      {"getting_up", "who gets up does so on the floor, not through it", getting_up},
      {"columns", "two columns walk into each other and on", columns},
      {"moving_ground", "pushed on a walkway, a lift and a turntable they keep standing there",
       moving_ground},
      {"walk_on_boards", "what holds it is loose boards", run_on_a_platform},
      {"level_below", "who is knocked off a table stands up on the floor", level_below},
      {"walk_on_boxes", "what holds it is the ground alone, which may be boxes", run_on_a_platform},
      {"led_through_each_other", "who is driven into something is driven on", moves_at_walking_pace},
  };
  for (const std::vector<Situation>& more : {situations_of_things(), situations_of_what_is_tied()})
    all.insert(all.end(), more.begin(), more.end());
  return all;
}

}  // namespace sinew::study
