#include "scene/start.h"

#include <random>

#include "sinew/skeleton/rotation.h"

namespace sinew::scene {

template <class T>
void add_speeds(const Skeleton& skeleton, const StartSpeeds& speeds, std::vector<JointJet<T>>& jets) {
  if (speeds.random > 0) randomise_speeds(skeleton, jets, speeds.random, speeds.seed);
  for (const auto& [joint, spin] : speeds.spin) jets[joint].omega = spin.template cast<T>();
  jets[0].velocity += speeds.velocity.template cast<T>();
}

template <class T>
void bend(const Skeleton& skeleton, std::vector<JointJet<T>>& jets, int joint, const Vec3<double>& rotation) {
  jets[joint].rotation =
      (skeleton.joints[joint].rest.rotation * rotation_exp<double>(rotation)).template cast<T>();
}

template <class T>
void randomise_speeds(const Skeleton& skeleton, std::vector<JointJet<T>>& jets, double rms, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, rms);
  for (std::size_t i = 0; i < jets.size(); ++i) {
    const Joint& joint = skeleton.joints[i];
    const Vec3<double> spin(normal(random), normal(random), normal(random));
    if (joint.type == JointType::kRevolute)
      jets[i].omega = (joint.axis * spin.dot(joint.axis)).template cast<T>();
    if (joint.type == JointType::kBall || joint.type == JointType::kFree)
      jets[i].omega = spin.template cast<T>();
  }
}

#define SINEW_SCENE_START(T)                                                                   \
  template void add_speeds<T>(const Skeleton&, const StartSpeeds&, std::vector<JointJet<T>>&); \
  template void bend<T>(const Skeleton&, std::vector<JointJet<T>>&, int, const Vec3<double>&); \
  template void randomise_speeds<T>(const Skeleton&, std::vector<JointJet<T>>&, double, unsigned);
SINEW_SCENE_START(float)
SINEW_SCENE_START(double)

}  // namespace sinew::scene
