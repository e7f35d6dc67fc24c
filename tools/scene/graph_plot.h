// What a graph asks of a character's joints and muscles, beside the same graph with the usual crossfades.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"

namespace sinew::scene {

/// Of the first character, frame by frame.
struct AskedOf {
  std::vector<double> time;          ///< s
  std::vector<double> acceleration;  ///< rad/s², the greatest that the animation asks of a joint
  std::vector<double> load;          ///< of the most loaded muscle, as a share of its limit
};

/// The scene with every transition of its graphs a crossfade of the same duration by a smoothstep; cuts stay.
convert::Error with_smoothsteps(const Scene& scene, Scene& out);

/// Runs the scene, whose first character plays a graph.
convert::Error run_asked(const Scene& scene, AskedOf& out);

/// "greatest |q''| 960 rad/s², 95 % of the frames below 330; a muscle at its limit in 12 % of them".
std::string summary_of(const AskedOf& asked);

/// Both curves of both, drawn to a file (.svg or .png).
convert::Error plot_asked(const Scene& scene, const AskedOf& own, const AskedOf& usual,
                          const std::string& path);

}  // namespace sinew::scene
