// The state in which a character starts.
#pragma once

#include <utility>
#include <vector>

#include "sinew/animation/clip.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew::scene {

/// Speeds besides those of the animation, in the order in which they are put on.
struct StartSpeeds {
  double random = 0;  ///< rad/s rms in each of the joints' own freedoms, drawn from a normal distribution
  unsigned seed = 1;
  std::vector<std::pair<int, Vec3<double>>> spin;  ///< (joint, rad/s in its axes), in place of what was drawn
  Vec3<double> velocity = Vec3<double>::Zero();    ///< of the root, m/s, world

  bool any() const { return random > 0 || !spin.empty() || !velocity.isZero(); }
};

template <class T>
void add_speeds(const Skeleton& skeleton, const StartSpeeds& speeds, std::vector<JointJet<T>>& jets);

/// Bends joint `joint` from rest by the rotation vector (child axes, rad).
template <class T>
void bend(const Skeleton& skeleton, std::vector<JointJet<T>>& jets, int joint, const Vec3<double>& rotation);

/// Joint speeds drawn from a normal distribution of the given rms (rad/s), in the joints' own freedoms.
template <class T>
void randomise_speeds(const Skeleton& skeleton, std::vector<JointJet<T>>& jets, double rms, unsigned seed);

}  // namespace sinew::scene
