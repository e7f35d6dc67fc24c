// What the judges of the talk's scenes share.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "study/talk/talk.h"

namespace sinew::study {

/// Mechanisms of the talk's first half: springs, hinges, linked bodies, loops.
std::vector<Situation> talk_mechanisms();
/// Its second half: characters with muscles.
std::vector<Situation> talk_characters();

inline scene::Scene by_scheme(scene::Scene scene, Compared scheme) {
  scene.scheme = scheme;
  return scene;
}

inline const Transform<float>& joint_at(const Played& played, int frame, int character, int joint) {
  return played.recording.frames[static_cast<std::size_t>(frame)]
      .characters[static_cast<std::size_t>(character)]
      .model[static_cast<std::size_t>(joint)];
}

/// World place of a point of a joint, m.
inline Eigen::Vector3d point_at(const Played& played, int frame, int character, int joint,
                                const Eigen::Vector3d& point) {
  const Transform<float>& at = joint_at(played, frame, character, joint);
  return at.rotation.cast<double>() * point + at.translation.cast<double>();
}

inline int joint_named(const scene::Scene& scene, int character, const char* name) {
  return scene.characters[static_cast<std::size_t>(character)].asset->skeleton.find(name);
}

}  // namespace sinew::study
