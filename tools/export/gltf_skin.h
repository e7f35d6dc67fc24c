// A figure's joints as nodes, its skin, and the meshes that follow it.
#pragma once

#include "export/gltf.h"
#include "export/gltf_file.h"

namespace sinew::exporting {

struct FigureNodes {
  int first_joint = 0;  ///< those of the other joints follow
  struct Morphing {
    int node = 0;
    const Mesh* mesh = nullptr;  ///< of the asset
  };
  std::vector<Morphing> morphing;  ///< whose meshes have morph targets
};

/// Adds nodes, skin, meshes and materials; all roots go into the scene.
FigureNodes add_figure(const GltfFigure& figure, Surface surface, GltfFile& file);

/// A node with a solid on it; returns it.
int add_solid(const scene::Prop& prop, GltfFile& file);

}  // namespace sinew::exporting
