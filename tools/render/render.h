// Recording or asset → video or pictures, off-screen.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "convert/convert.h"
#include "scene/recording.h"

namespace sinew::render {

struct Options {
  int width = 1280, height = 720;  ///< pixels, even
  double fps = 30;
  int samples = 4;               ///< multisampling, 1 or 4
  std::string quality = "full";  ///< full: ambient occlusion, softer shadows | fast
  std::string theme = "dark";    ///< dark | light
  std::string background;        ///< RRGGBB, sRGB: one colour instead of the theme's sky; empty: the sky
  std::string mode = "skin";     ///< skin | xray: muscles coloured by load in translucent skin | shapes |
                                 ///< both: skin on the left, xray on the right
  bool transparent = false;      ///< .png: neither sky nor floor, with alpha
  std::string pass = "color";    ///< color | .png without an overlay: depth (16-bit grey, mm along the view;
                               ///< 65535: nothing) | normal (in the world's axes, −1 … 1 as 0 … 255) | id (a
                               ///< colour for each thing: id_colors), the last two with alpha
  bool overlay = true;
  bool inside = false;     ///< scenes: what the world has inside over the picture (Recording::shows_inside)
  double start = 0;        ///< s: scenes begin here; the moment of a single picture
  bool turntable = false;  ///< assets: the camera goes round
  int frames_per_revolution = 120;
  std::string clip;  ///< assets: clip to play; empty: rest pose on the turntable
  int threads = 4;   ///< of the video encoder: fixed, so that two runs give identical frames
};

/// Writes OUT by its extension: .mp4, .webm, .gif or .png (frame_%04d.png for all frames, x.png for one).
/// Atomic: nothing half-written is left behind. `progress(done, total)` may be empty.
convert::Error render_recording(const scene::Recording& recording, const Options& options,
                                const std::string& output, const std::function<void(int, int)>& progress);

/// An asset on its own: one revolution of the turntable, or one pass of a clip (with `turntable` too: one
/// revolution while the clip plays).
convert::Error render_asset(const std::shared_ptr<const Asset>& asset, const Options& options,
                            const std::string& output, const std::function<void(int, int)>& progress);

/// Name and colour RRGGBB of each character, prop and obstacle in pictures of pass "id".
std::vector<std::pair<std::string, std::string>> id_colors(const scene::Recording& recording);

}  // namespace sinew::render
