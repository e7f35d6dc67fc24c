// Characters and what they do → glTF 2.0: skeletons, skins, materials, animations.
#pragma once

#include <string>
#include <vector>

#include "export/motion.h"

namespace sinew::exporting {

/// What joints carry in the file.
enum class Surface {
  kSkin,    ///< the asset's meshes; its shapes where it has none
  kShapes,  ///< the colliders of the physical body, each on its joint; sticks where there are none
  kNone     ///< the skeleton alone
};

struct GltfFigure {
  const Asset* asset = nullptr;
  std::string name;
  std::vector<Motion> motions;  ///< an animation each, its name once; of another figure's name: one for both,
                                ///< at the same times
};

struct GltfProp {
  scene::Prop prop;
  std::vector<double> times;
  std::vector<Transform<float>> poses;  ///< [time] world
  std::vector<bool> hidden;             ///< [time] it is not there yet
  std::string motion;                   ///< name of the animation
};

struct GltfContent {
  std::vector<GltfFigure> figures;
  std::vector<GltfProp> props;
  Surface surface = Surface::kSkin;
  bool cubic = false;  ///< splines through the keys with the clips' own velocities; else straight lines
  bool binary = true;  ///< GLB; else JSON with the buffer in it
};

/// The file's bytes. Axes are glTF's (Y up, a figure looks along +Z): root joints are turned, and all others'
/// frames are Sinew's own.
std::string write_gltf(const GltfContent& content);

}  // namespace sinew::exporting
