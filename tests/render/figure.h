// Something to draw without files: a humanoid of shapes, one in a skin, and recordings of both.
#pragma once

#include <string>

#include "render/render.h"
#include "render/stage.h"

namespace sinew::render::fixtures {

/// 14 bodies, no mesh: drawn from its shapes.
std::shared_ptr<Asset> bare_humanoid();

/// The same with a capsule of skin around every bone.
std::shared_ptr<Asset> skinned_humanoid();

/// `seconds` at 30 fps: the arms swing, the load of all joints rises from 0 to 1, a caption is shown.
scene::Recording swinging(const std::shared_ptr<const Asset>& asset, double seconds);

/// Name in a directory of the running case.
std::string own_file(const std::string& name);
/// All files of that directory, one line each.
std::string own_files();

/// Small and quick to draw, without overlay.
Options small_options(int width = 160, int height = 90);

/// What a .png written by render_recording shows, BGRA.
Image picture(const scene::Recording& recording, const Options& options);

/// Mean brightness of the pixels in a box given in shares of the picture, 0 … 255.
double brightness(const Image& image, double left, double top, double right, double bottom);

}  // namespace sinew::render::fixtures
