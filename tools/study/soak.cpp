#include "study/soak.h"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

#include "scene/humanoid.h"
#include "sinew/effects/continuous_detection.h"
#include "study/bodies.h"

namespace sinew::study {
namespace {

constexpr int kCharacters = 20;
constexpr double kApart = 0.9;  // m: arm's length, so that whoever falls falls onto somebody
constexpr int kLookEvery = 20;  // frames

/// What happens to one character in one frame: mostly nothing.
template <class T>
void disturb(Character<T> c, std::vector<JointJet<T>>& jets, int index, std::mt19937_64& random) {
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (double(random() >> 11) * 0x1p-53);
  };
  const std::uint64_t event = random() % 600;
  const int joint = static_cast<int>(random() % jets.size());
  if (event < 6) {
    const Vec3<T> impulse(T(uniform(-60, 60)), T(uniform(-60, 60)), T(uniform(-30, 30)));
    (void)c.apply_impulse(joint, c.model()[joint].translation, impulse);
  } else if (event < 8) {
    (void)c.set_strength(T(uniform(0, 2)));
  } else if (event < 10) {
    (void)c.set_strength(joint, T(uniform(0, 1)));
  } else if (event < 12) {
    (void)c.set_root_drive(event == 10 ? RootDrive::kFree : RootDrive::kAssisted);
  } else if (event < 13) {
    const int column = index % 5, row = index / 5;
    jets[0].translation =
        Vec3<T>(T(kApart * column + uniform(-0.2, 0.2)), T(kApart * row + uniform(-0.2, 0.2)), T(1.42));
    (void)c.set_root_drive(RootDrive::kKinematic);
    (void)c.set_target(jets);
    (void)c.reset();
  }
}

/// Whether any two characters touch, by their poses.
template <class T>
bool any_touch(World<T>& world, const audit::Member& body) {
  std::vector<std::vector<Transform<double>>> poses(kCharacters);
  for (int i = 0; i < kCharacters; ++i)
    for (std::size_t b = 0; b < body.bodies.size(); ++b)
      poses[i].push_back(world.character(i).model()[b].template cast<double>());
  const std::vector<audit::Member> members(kCharacters, body);
  const std::vector<audit::Poses> at(poses.begin(), poses.end());
  return audit::deepest_between(members, at) > 0;
}

}  // namespace

template <class T>
SoakReport soak(double seconds, double h, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  World<T> world((WorldSettings()));
  (void)world.template declare<ContinuousDetection>();
  const Skeleton body = humanoid();
  const audit::Member member = audit::member_of(body);
  std::vector<std::vector<JointJet<T>>> jets(kCharacters, rest_jets<T>(body));
  for (int i = 0; i < kCharacters; ++i) {
    Status status;
    const int row = i / 5;
    jets[i][0].translation += Vec3<T>(T(kApart * (i % 5)), T(kApart * row), T(0));
    world.add_character(body, {}, status);
    (void)world.character(i).set_target(jets[i]);
    (void)world.character(i).reset();
  }
  SoakReport report;
  report.frames = static_cast<int>(std::lround(seconds / h));
  std::vector<float> times;
  times.reserve(static_cast<std::size_t>(report.frames));
  Measurement& m = report.measured;
  for (int frame = 0; frame < report.frames; ++frame) {
    for (int i = 0; i < kCharacters; ++i) disturb(world.character(i), jets[i], i, random);
    const auto heap_before = static_cast<long>(mallinfo2().uordblks);
    const auto begin = std::chrono::steady_clock::now();
    (void)world.step(T(h));
    times.push_back(
        std::chrono::duration<float, std::micro>(std::chrono::steady_clock::now() - begin).count());
    const auto heap = static_cast<long>(mallinfo2().uordblks);
    if (frame > static_cast<int>(1 / h)) report.heap_growth += heap - heap_before;
    ++m.steps;
    m.microseconds += double(times.back());
    bool finite = true;
    for (int i = 0; i < kCharacters; ++i) {
      const Character<T> c = world.character(i);
      for (const Transform<T>& joint : c.model())
        finite = finite && joint.translation.allFinite() && joint.rotation.coeffs().allFinite();
      const CharacterReport& r = c.report();
      if (r.unknown_dofs > 0) m.count(r);
      m.penetration = std::max(m.penetration, r.penetration);
    }
    report.not_finite += !finite;
    if (frame % kLookEvery == 0) ++report.looked, report.touching += any_touch(world, member);
    m.finite = m.finite && finite;
  }
  std::sort(times.begin(), times.end());
  report.median_us = double(times[times.size() / 2]);
  report.p999_us = double(times[static_cast<std::size_t>(double(times.size() - 1) * 0.999)]);
  return report;
}

template SoakReport soak<float>(double, double, std::uint64_t);
template SoakReport soak<double>(double, double, std::uint64_t);

}  // namespace sinew::study
