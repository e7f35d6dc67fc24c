// Recording or asset → video or pictures, off-screen.
#pragma once

#include <functional>
#include <string>

#include "convert/convert.h"
#include "scene/recording.h"

namespace sinew::render {

struct Options {
  int width = 1280, height = 720;
  double fps = 30;
  int samples = 4;             ///< MSAA of the figure, 1 or 4
  std::string theme = "dark";  ///< dark | light
  std::string mode =
      "skin";  ///< skin | xray (muscle spindles coloured by load, translucent mesh beside) | shapes
  bool overlay = true;
  bool turntable = false;
  int frames_per_revolution = 120;
  std::string clip;  ///< assets: clip played during the turntable; empty: rest pose
  int threads = 4;   ///< video encoder threads: fixed, so that two runs give identical frames
};

/// Writes OUT by its extension: .mp4, .webm, .gif, or a directory/pattern ending in .png (frame_%04d.png; a
/// plain "x.png" with one frame). Atomic: nothing half-written is left behind. `progress(done, total)` may be
/// empty.
convert::Error render_recording(const scene::Recording& recording, const Options& options,
                                const std::string& output, const std::function<void(int, int)>& progress);

/// Turntable (or clip playback) of an asset on its own.
convert::Error render_asset(std::shared_ptr<const Asset> asset, const Options& options,
                            const std::string& output, const std::function<void(int, int)>& progress);

}  // namespace sinew::render
