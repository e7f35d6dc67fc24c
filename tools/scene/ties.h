// Loops and particle bodies of a scene file.
#pragma once

#include <string>

#include "scene/reader.h"
#include "scene/scene.h"

namespace sinew::scene {

/// One entry of `loops`.
LoopSettings read_loop(const json& entry, const std::string& where, const Scene& scene);

/// One entry of `particles`: a strand, cloth or soft tissue.
ParticleBody read_particles(const json& entry, const std::string& where, const Scene& scene);

/// The pairs of nodes between which a particle body is drawn, as thin capsules: of tissue, its surface.
std::vector<std::array<int, 2>> drawn_edges(const ParticleBody& body);

}  // namespace sinew::scene
