// A game's loop: fixed steps from an accumulator, poses interpolated for drawing, arrow keys push the
// character, R resets it. Usage: game_loop ASSET.sinew [FRAMES]     Without a display run it with
// SDL_VIDEODRIVER=offscreen (or dummy).
#include <SDL2/SDL.h>
#include <sinew/animation/sampling_job.h>
#include <sinew/character/world.h>
#include <sinew/io/asset.h>

#include <cstdio>
#include <cstdlib>

namespace {

constexpr double kStep = 1 / 60.0;

/// Sticks from every joint to its parent, seen from the side; saturated ones are red.
void draw(SDL_Renderer* renderer, const sinew::Character<float>& hero,
          const std::vector<sinew::Transform<float>>& before, float blend) {
  SDL_SetRenderDrawColor(renderer, 38, 42, 48, 255);
  SDL_RenderClear(renderer);
  SDL_SetRenderDrawColor(renderer, 90, 96, 104, 255);
  SDL_RenderDrawLine(renderer, 0, 400, 640, 400);
  const auto& joints = hero.skeleton().joints;
  const auto place = [&](std::size_t i) -> sinew::Vec3<float> {
    return (1 - blend) * before[i].translation + blend * hero.model()[i].translation;
  };
  const sinew::Vec3<float> root = place(0);
  for (std::size_t i = 1; i < joints.size(); ++i) {
    if (joints[i].parent < 0 || static_cast<int>(i) >= hero.skeleton().body_count) continue;
    const bool unknown = hero.unknown()[static_cast<std::size_t>(hero.first_dof(static_cast<int>(i)))] != 0;
    SDL_SetRenderDrawColor(renderer, unknown ? 230 : 130, unknown ? 70 : 205, unknown ? 50 : 190, 255);
    const sinew::Vec3<float> a = place(static_cast<std::size_t>(joints[i].parent)), b = place(i);
    SDL_RenderDrawLineF(renderer, 320 + 180 * (a.x() - root.x()), 400 - 180 * a.z(),
                        320 + 180 * (b.x() - root.x()), 400 - 180 * b.z());
  }
  SDL_RenderPresent(renderer);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: game_loop ASSET.sinew [FRAMES]\n");
    return 2;
  }
  sinew::Asset asset;
  const sinew::Status loaded = sinew::load_asset(argv[1], asset);
  if (!loaded || asset.clips.empty()) {
    std::fprintf(stderr, "game_loop: %s: %s\n", argv[1], loaded ? "the asset has no clip" : loaded.reason);
    return 1;
  }
  const int last_frame = argc > 2 ? std::atoi(argv[2]) : -1;
  if (SDL_Init(SDL_INIT_VIDEO) != 0) {
    std::fprintf(stderr, "game_loop: %s\n", SDL_GetError());
    return 1;
  }
  SDL_Window* window =
      SDL_CreateWindow("Sinew", SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, 640, 480, 0);
  SDL_Renderer* renderer = window ? SDL_CreateRenderer(window, -1, SDL_RENDERER_SOFTWARE) : nullptr;
  if (!renderer) {
    std::fprintf(stderr, "game_loop: %s\n", SDL_GetError());
    SDL_Quit();
    return 1;
  }
  sinew::Status status;
  sinew::World<float> world({});
  sinew::Character<float> hero = world.character(world.add_character(asset.skeleton, {}, status));
  std::vector<sinew::JointJet<float>> jets(asset.skeleton.joints.size());
  const int pushed = std::max(0, asset.skeleton.find(sinew::Role::kChest));
  double clock = 0, accumulator = 0;
  std::vector<sinew::Transform<float>> before(hero.model().begin(), hero.model().end());
  std::uint64_t last = SDL_GetTicks64();
  bool running = true, fresh = true;
  for (int frame = 0; running && frame != last_frame; ++frame) {
    for (SDL_Event event; SDL_PollEvent(&event);) {
      if (event.type == SDL_QUIT) running = false;
      if (event.type != SDL_KEYDOWN) continue;
      const auto at = hero.model()[static_cast<std::size_t>(pushed)].translation;
      if (event.key.keysym.sym == SDLK_LEFT) status = hero.apply_impulse(pushed, at, {-60, 0, 0});
      if (event.key.keysym.sym == SDLK_RIGHT) status = hero.apply_impulse(pushed, at, {60, 0, 0});
      if (event.key.keysym.sym == SDLK_r) status = hero.reset();
      if (event.key.keysym.sym == SDLK_ESCAPE) running = false;
    }
    const std::uint64_t now = SDL_GetTicks64();
    accumulator += std::min(0.1, double(now - last) / 1000);
    last = now;
    for (; status && accumulator >= kStep; accumulator -= kStep) {
      before.assign(hero.model().begin(), hero.model().end());
      clock += kStep;
      status = sinew::SamplingJob<float>{&asset.clips.front(), clock, jets}.Run();
      if (status) status = hero.set_target(jets);
      if (status && fresh) status = hero.reset();
      fresh = false;
      if (status) status = world.step(static_cast<float>(kStep));
    }
    if (!status) {
      std::fprintf(stderr, "game_loop: %s\n", status.reason);
      running = false;
    }
    draw(renderer, hero, before, static_cast<float>(accumulator / kStep));
    SDL_Delay(2);
  }
  SDL_DestroyRenderer(renderer);
  SDL_DestroyWindow(window);
  SDL_Quit();
  return status ? 0 : 1;
}
