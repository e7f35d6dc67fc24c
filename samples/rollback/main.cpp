// A game over a network guesses what another player does, goes on, hears better and goes back: a snapshot,
// the same frames again with the same inputs to the bit, and with the right input to another end. Then frames
// are recorded and played back in another world. Usage: rollback ASSET.sinew
#include <sinew/animation/sampling_job.h>
#include <sinew/character/recording.h>
#include <sinew/character/world.h>
#include <sinew/io/asset.h>

#include <cstdint>
#include <cstdio>

namespace {

constexpr float kStep = 1 / 60.f;                                // s
constexpr int kHeard = 60, kPushed = 66, kNow = 90, kEnd = 150;  // frames

int fail(const char* what, const char* why) {
  std::fprintf(stderr, "rollback: %s: %s\n", what, why);
  return 1;
}

/// A walker, a ball that comes at him, and whatever pushes him: all that a frame depends on.
struct Game {
  const sinew::Asset& asset;
  sinew::World<float> world{{}};
  sinew::Status status;
  int hero = -1;
  std::vector<sinew::JointJet<float>> jets;
  std::vector<std::byte> bytes;  ///< room for a state

  explicit Game(const sinew::Asset& from) : asset(from), jets(from.skeleton.joints.size()) {
    hero = world.add_character(asset.skeleton, {}, status);
    sinew::PropSettings ball;
    ball.mass = 4;
    ball.pose.translation = {5.1, 0.05, 1.4};
    ball.velocity = {-3, 0, 5.8};
    if (status) (void)world.add_prop(ball, status);
    if (!status) return;
    set_inputs(0, 0);
    if (status) status = world.character(hero).reset();
    bytes.resize(world.snapshot_capacity());
  }
  /// Targets and pushes are inputs, a function of the frame: they are given again when it is played again.
  void set_inputs(int frame, float push) {
    status = sinew::SamplingJob<float>{&asset.clips.front(), frame / 60.0, jets}.Run();
    sinew::Character<float> walker = world.character(hero);
    if (status) status = walker.set_target(jets);
    const int chest = asset.skeleton.find(sinew::Role::kChest);
    if (status && frame == kPushed && push > 0)
      status = walker.apply_impulse(chest, walker.model()[chest].translation, {0, push, 0});
  }
  /// Frames up to `last`; `push` (N·s): what the other player does in one of them.
  void play(int& frame, int last, float push) {
    while (status && frame < last) {
      set_inputs(++frame, push);
      if (status) status = world.step(kStep);
    }
  }
  std::vector<std::byte> save() {
    const std::size_t size = world.save(bytes);
    return {bytes.begin(), bytes.begin() + std::ptrdiff_t(size)};
  }
  /// FNV-1a of the state: two machines compare this one number.
  std::uint64_t hash() {
    std::uint64_t sum = 14695981039346656037u;
    for (const std::byte byte : save()) sum = (sum ^ std::uint64_t(byte)) * 1099511628211u;
    return sum;
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: rollback ASSET.sinew\n");
    return 2;
  }
  sinew::Asset asset;
  const sinew::Status loaded = sinew::load_asset(argv[1], asset);
  if (!loaded || asset.clips.empty()) return fail(argv[1], loaded ? "the asset has no clip" : loaded.reason);
  if (asset.skeleton.find(sinew::Role::kChest) < 0) return fail(argv[1], "the character has no chest");

  // On with a guess: the other player does nothing.
  Game game(asset);
  int frame = 0;
  game.play(frame, kHeard, 0);
  const std::vector<std::byte> heard = game.save();  // the last frame of which everything is known
  game.play(frame, kNow, 0);
  if (!game.status) return fail("game", game.status.reason);
  const std::uint64_t guessed = game.hash();
  std::printf("snapshot of frame %d: %zu bytes; guessed frame %d: %016llx\n", kHeard, heard.size(), frame,
              static_cast<unsigned long long>(guessed));

  // Back, and the same again: to the bit.
  const auto go_back = [&] {
    game.status = game.world.restore(heard);
    frame = kHeard;
  };
  go_back();
  game.play(frame, kNow, 0);
  if (!game.status) return fail("game", game.status.reason);
  const std::uint64_t again = game.hash();
  std::printf("back and played again: %016llx\n", static_cast<unsigned long long>(again));
  if (again != guessed) return fail("rollback", "the same frames led elsewhere");

  // Back, and what really happened: a push in frame 66.
  go_back();
  game.play(frame, kNow, 90);
  if (!game.status) return fail("game", game.status.reason);
  const std::uint64_t corrected = game.hash();
  std::printf("back and corrected: %016llx\n", static_cast<unsigned long long>(corrected));
  if (corrected == guessed) return fail("rollback", "the push changed nothing");

  // From here on each step is recorded, with its inputs and its state, and repeated by another world.
  sinew::Recorder<float> recorder(game.world);
  while (game.status && frame < kEnd) {
    game.set_inputs(++frame, 0);
    if (game.status) game.status = recorder.step(kStep);
  }
  if (!game.status) return fail("recording", game.status.reason);
  Game other(asset);
  sinew::ReplayReport report;
  if (sinew::Status s = sinew::replay<float>(other.world, recorder.bytes(), report); !s)
    return fail("replay", s.reason);
  std::printf("recorded %zu bytes, replayed %d steps: %s\n", recorder.bytes().size(), report.steps,
              report.same ? "the same to the bit" : report.field.name);
  if (!report.same || report.steps != kEnd - kNow) return fail("replay", "the recording led elsewhere");
  if (other.hash() != game.hash()) return fail("replay", "both worlds are not the same in the end");
  return 0;
}
