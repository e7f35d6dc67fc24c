// Renders an asset from your own tool. Usage: turntable ASSET OUT.mp4|OUT_%03d.png [FRAMES]
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "render/render.h"

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::fprintf(stderr, "usage: turntable ASSET OUT [FRAMES]\n");
    return 2;
  }
  auto asset = std::make_shared<sinew::Asset>();
  nlohmann::json report;
  sinew::convert::Error error = sinew::convert::open_any(argv[1], {}, *asset, report);
  sinew::render::Options options;
  options.turntable = true;
  options.frames_per_revolution = argc > 3 ? std::atoi(argv[3]) : 120;
  if (!error) error = sinew::render::render_asset(asset, options, argv[2], {});
  if (!error) return 0;
  std::fprintf(stderr, "turntable: %s\n", error.message.c_str());
  return 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "turntable: %s\n", error.what());
  return 1;
}
