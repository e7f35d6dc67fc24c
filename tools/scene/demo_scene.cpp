// The demo's story for any asset.
#include <algorithm>

#include "scene/scene.h"

namespace sinew::scene {

Scene demo_scene(std::shared_ptr<const Asset> asset) {
  Scene s;
  const Skeleton& body = asset->skeleton;
  const auto first_of = [&](std::initializer_list<const char*> names, int otherwise) {
    for (const char* n : names)
      for (std::size_t i = 0; i < asset->clips.size(); ++i)
        if (asset->clips[i].name.find(n) != std::string::npos && asset->clips[i].duration > 0.3f)
          return static_cast<int>(i);
    return otherwise;
  };
  int longest = -1;
  for (std::size_t i = 0; i < asset->clips.size(); ++i)
    if (longest < 0 || asset->clips[i].duration > asset->clips[longest].duration)
      longest = static_cast<int>(i);
  const auto body_at = [&](std::initializer_list<Role> roles) {
    for (const Role r : roles)
      if (const int j = body.find(r); j >= 0 && j < body.body_count) return j;
    return body.body_count / 2;
  };
  s.title = body.name;
  s.duration = 12;
  SceneCharacter c;
  c.asset = asset;
  c.name = body.name;
  const int walk = first_of({"walk", "Walk"}, longest), stand = first_of({"stand", "idle", "Idle"}, walk);
  if (walk >= 0) {
    c.clips.push_back({.clip = walk, .start = 0, .blend = 0});
    c.clips.push_back({.clip = stand, .start = 8.2, .blend = 0.5, .align = true});
  }
  const double height = std::max(0.3, body.joints[0].rest.translation.z() * 1.8), mass = body.total_mass();
  c.strength = {{0, 1}, {4.9, 1}, {5.0, 0.01}, {7.8, 0.01}, {8.8, 1}};
  c.root = {{0, RootDrive::kKinematic}, {5.0, RootDrive::kFree}, {7.8, RootDrive::kAssisted}};
  c.settings.root_force = 30 * mass;
  c.settings.root_torque = 8 * mass * height;
  s.characters.push_back(c);
  SceneProp ball;
  ball.name = "ball";
  ball.settings.size = Vec3<double>::Constant(0.07 * height);
  ball.settings.mass = 0.035 * mass;
  ball.target_character = 0;
  ball.target_joint = body_at({Role::kUpperArmL, Role::kChest});
  ball.speed = 7;
  ball.from = {0.6, 2.6, 1.0};
  ball.launch_time = 2.2;
  s.props.push_back(ball);
  ball.name = "heavy ball";
  ball.settings.size = Vec3<double>::Constant(0.1 * height);
  ball.settings.mass = 0.12 * mass;
  ball.target_joint = body_at({Role::kChest, Role::kSpine, Role::kPelvis});
  ball.speed = 9;
  ball.from = {2.4, -1.6, 1.0};
  ball.launch_time = 4.75;
  s.props.push_back(ball);
  s.captions = {
      {0, "playback: nothing to solve"}, {2.4, "a ball at the shoulder: only what saturates is simulated"},
      {3.8, "back on the animation"},    {5.0, "a harder hit: the strength is gone"},
      {7.8, "strength returns"},         {9.6, "playback again"}};
  s.camera.follow_character = 0;
  s.plotted_joint = body_at({Role::kUpperArmL, Role::kChest});
  return s;
}

}  // namespace sinew::scene
