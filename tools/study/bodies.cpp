#include "study/bodies.h"

namespace sinew::study {

CharacterSettings passive() {
  CharacterSettings settings;
  settings.root = RootDrive::kFree;
  settings.strength = 0;
  return settings;
}

WorldSettings weightless() {
  WorldSettings settings;
  settings.gravity.setZero();
  settings.ground = false;
  return settings;
}

template <class T>
int add_thrown_humanoid(Stage<T>& stage, double height, double rms, unsigned seed) {
  Skeleton body = humanoid();
  make_frictionless(body);
  std::vector<JointJet<T>> jets = rest_jets<T>(body);
  jets[0].translation.z() += T(height);
  randomise_speeds(body, jets, rms, seed);
  return stage.add(body, passive(), jets);
}

Skeleton& skeleton_of(scene::Scene& scene, int character) {
  std::shared_ptr<const Asset>& asset = scene.characters[static_cast<std::size_t>(character)].asset;
  const auto copy = std::make_shared<Asset>(*asset);
  asset = copy;
  return copy->skeleton;
}

Collider obstacle_box(const Vec3<double>& center, const Vec3<double>& half, double friction) {
  Collider c;
  c.shape = Shape::kBox;
  c.local.translation = center;
  c.size = half;
  c.friction = friction;
  return c;
}

template int add_thrown_humanoid<float>(Stage<float>&, double, double, unsigned);
template int add_thrown_humanoid<double>(Stage<double>&, double, double, unsigned);

}  // namespace sinew::study
