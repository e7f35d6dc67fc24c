// Prints one line per scene and precision: its name, the precision, and a hash of all poses of all frames.
// The same lines are printed on every machine; cross.sh and processors.sh compare them. Usage:
// pose_hashes ASSET.sinew GRAPH.sgraph [--processor baseline|avx2|avx512] [--scene NAME [--frames]]
//   --processor: kernels as a processor chooses that has this and nothing above
//   --frames: a line after every frame, to find the first that differs
// Exits with 77 where the processor lacks what is asked for.
#include <cinttypes>
#include <cstdio>
#include <string_view>

#include "processor.h"
#include "scenes.h"

namespace {

using namespace sinew;
using namespace sinew::portability;

struct Options {
  const char *asset = nullptr, *graph = nullptr, *processor = nullptr, *scene = nullptr;
  bool frames = false;
};

bool read_options(int argc, char** argv, Options& out) {
  if (argc < 3) return false;
  out.asset = argv[1];
  out.graph = argv[2];
  for (int n = 3; n < argc; ++n) {
    const std::string_view option = argv[n];
    if (option == "--frames")
      out.frames = true;
    else if (option == "--processor" && n + 1 < argc)
      out.processor = argv[++n];
    else if (option == "--scene" && n + 1 < argc)
      out.scene = argv[++n];
    else
      return false;
  }
  return true;
}

/// 0, or what to exit with.
int choose_processor(std::string_view name) {
  for (const NamedSet& set : kSets)
    if (name == set.name) {
      if (pretend(set.set)) return 0;
      std::fprintf(stderr, "pose_hashes: this processor cannot be taken for one with %s\n", set.name);
      return 77;
    }
  std::fprintf(stderr, "pose_hashes: no such processor: %.*s\n", int(name.size()), name.data());
  return 2;
}

bool run(const Scene& scene, const char* precision, std::string (*of)(const Actors&, PoseHash&),
         const Actors& actors, bool frames) {
  PoseHash hash;
  if (frames)
    hash.each_frame = [&](int frame, std::uint64_t value) {
      std::printf("%s %s frame %d %016" PRIx64 "\n", scene.name, precision, frame, value);
    };
  if (const std::string fault = of(actors, hash); !fault.empty()) {
    std::fprintf(stderr, "pose_hashes: %s, %s: %s\n", scene.name, precision, fault.c_str());
    return false;
  }
  std::printf("%s %s %016" PRIx64 "\n", scene.name, precision, hash.value());
  std::fflush(stdout);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (!read_options(argc, argv, options)) {
    std::fprintf(stderr,
                 "usage: pose_hashes ASSET.sinew GRAPH.sgraph [--processor baseline|avx2|avx512] "
                 "[--scene NAME [--frames]]\n");
    return 2;
  }
  if (options.processor)
    if (const int wrong = choose_processor(options.processor)) return wrong;
  Actors actors;
  if (const Status loaded = actors.load(options.asset, options.graph); !loaded) {
    std::fprintf(stderr, "pose_hashes: %s, %s: %s\n", options.asset, options.graph, loaded.reason);
    return 1;
  }
  bool any = false, good = true;
  for (const Scene& scene : scenes()) {
    if (options.scene && std::string_view(options.scene) != scene.name) continue;
    any = true;
    good &= run(scene, "float", scene.in_float, actors, options.frames);
    good &= run(scene, "double", scene.in_double, actors, options.frames);
  }
  if (!any) std::fprintf(stderr, "pose_hashes: no such scene: %s\n", options.scene);
  return any && good ? 0 : 1;
}
