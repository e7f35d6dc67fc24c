// A game changes its mind: from clip to clip in the middle of a transition, without a jump of pose, velocity
// or acceleration. Prints how much muscles are loaded while it happens. Usage: transitions ASSET.sinew
// [SECONDS]
#include <sinew/animation/crossfade.h>
#include <sinew/animation/inertialize_job.h>
#include <sinew/animation/root_motion.h>
#include <sinew/animation/sampling_job.h>
#include <sinew/animation/smooth_input.h>
#include <sinew/character/world.h>
#include <sinew/io/asset.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace {

/// Plays one clip of an asset at a time, and fades away what was different when it changed.
class Player {
 public:
  explicit Player(const sinew::Asset& asset)
      : asset_(asset),
        joints_(static_cast<int>(asset.skeleton.joints.size())),
        numbers_(sinew::inertial_numbers(joints_, joints_)),
        next_(joints_),
        jets_(joints_),
        state_{numbers_, joints_, joints_} {}

  /// From now on. Whatever is going on goes over into it: interrupting a transition is no special case.
  void play(int clip) {
    clip_ = clip;
    time_ = 0;
    place_ = {};
    sample(next_);
    if (begun_) {  // the new clip goes on where the character is and where it is heading
      place_ = ground(jets_[0]) * ground(next_[0]).inverse();
      sinew::place_root(place_, next_[0]);
    } else {
      jets_ = next_;
      begun_ = true;
    }
    (void)sinew::begin_inertial<float>(jets_, next_, 0.25f, state_);
  }
  /// What the animation wants h seconds later, at `speed`.
  std::span<const sinew::JointJet<float>> advance(float h, const sinew::TimeJet<float>& speed) {
    const double mean = (time_.rate + double(speed.value)) / 2;
    time_ = {time_.value + mean * double(h), double(speed.value), double(speed.rate)};
    state_.elapsed += h;
    sample(jets_);
    (void)sinew::InertializeJob<float>{jets_, &state_, {}, jets_}.Run();
    return jets_;
  }

 private:
  void sample(std::vector<sinew::JointJet<float>>& out) const {
    (void)sinew::SamplingJob<float>{&asset_.clips[clip_], time_, out}.Run();
    sinew::place_root(place_, out[0]);
  }
  static sinew::Transform<float> ground(const sinew::JointJet<float>& root) {
    const sinew::JointJet<float> travel = sinew::split_root(root).travel;
    return {travel.rotation, travel.translation};
  }

  const sinew::Asset& asset_;
  int joints_, clip_ = 0;
  bool begun_ = false;
  sinew::Transform<float> place_;  ///< clip → world
  sinew::ClipTime time_;
  std::vector<float> numbers_;
  std::vector<sinew::JointJet<float>> next_, jets_;
  sinew::InertialState<float> state_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: transitions ASSET.sinew [SECONDS]\n");
    return 2;
  }
  sinew::Asset asset;
  const sinew::Status loaded = sinew::load_asset(argv[1], asset);
  if (!loaded || asset.clips.empty()) {
    std::fprintf(stderr, "transitions: %s: %s\n", argv[1], loaded ? "the asset has no clip" : loaded.reason);
    return 1;
  }
  const double seconds = argc > 2 ? std::atof(argv[2]) : 4;
  const int stand = std::max(0, asset.find_clip("stand")), walk = std::max(0, asset.find_clip("walk"));
  sinew::Status status;
  sinew::World<float> world({});
  const int hero = world.add_character(asset.skeleton, {}, status);
  if (!status) return 1;

  Player player(asset);
  sinew::SmoothInput<float> speed;  // of the clip: the game asks in steps, the clip follows smoothly
  speed.x = sinew::TimeJet<float>(1.f);
  constexpr float h = 1 / 60.f;
  for (int frame = 0; frame <= seconds * 60; ++frame) {
    const int in_cycle = frame % 120;
    if (frame == 0) player.play(stand);
    if (in_cycle == 30 || in_cycle == 42) player.play(walk);
    if (in_cycle == 36 || in_cycle == 100) player.play(stand);  // the first: the walk has hardly begun
    speed.step(in_cycle < 70 ? 1.f : 0.5f, sinew::SmoothInput<float>::pole_of(0.1f), h);
    status = world.character(hero).set_target(player.advance(h, speed.x));
    if (status) status = frame == 0 ? world.character(hero).reset() : world.step(h);
    if (!status) {
      std::fprintf(stderr, "transitions: %s\n", status.reason);
      return 1;
    }
    if (in_cycle % 6 == 0)
      std::printf("%5.2f s  speed %.2f  unknown DOFs %d\n", frame / 60.0, double(speed.x.value),
                  world.character(hero).report().unknown_dofs);
  }
  return 0;
}
