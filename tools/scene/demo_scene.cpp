// The demo's story for any asset.
#include <algorithm>
#include <cmath>

#include "scene/scene.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/effects/contact.h"

namespace sinew::scene {
namespace {

/// The asset itself or, where it has no clip, a copy with one that holds the rest pose.
std::shared_ptr<const Asset> with_a_clip(const std::shared_ptr<const Asset>& asset) {
  if (!asset->clips.empty()) return asset;
  auto copy = std::make_shared<Asset>(*asset);
  Clip& rest = copy->clips.emplace_back();
  rest.name = "rest";
  rest.duration = 1;
  rest.joint_count = static_cast<int>(copy->skeleton.joints.size());
  for (const Joint& joint : copy->skeleton.joints) rest.constants.push_back(joint.rest.cast<float>());
  return copy;
}

/// Lowest and highest point of the colliders in a clip's first pose, m.
std::pair<double, double> extent(const Asset& asset, int clip) {
  const Skeleton& skeleton = asset.skeleton;
  std::vector<JointJet<double>> jets(skeleton.joints.size());
  (void)SamplingJob<double>{&asset.clips[clip], 0, jets}.Run();
  std::vector<Transform<double>> model(jets.size());
  for (std::size_t i = 0; i < model.size(); ++i) {
    const int parent = skeleton.joints[i].parent;
    model[i] = {jets[i].rotation, jets[i].translation};
    if (parent >= 0) model[i] = model[parent] * model[i];
  }
  std::vector<ContactPoint<double>> points;
  for (const Collider& collider : skeleton.colliders) append_contact_points<double>(collider, points);
  std::pair<double, double> lowest_highest{model[0].translation.z(), model[0].translation.z()};
  for (const ContactPoint<double>& p : points) {
    const double z = (model[p.body] * p.local).z();
    lowest_highest.first = std::min(lowest_highest.first, z - p.radius);
    lowest_highest.second = std::max(lowest_highest.second, z + p.radius);
  }
  return lowest_highest;
}

/// The moment of a clip between `begin` and `end`, s, at which the body stands as tall as it mostly does and
/// moves least: where a fallen one may join in, and where a ball meets what it was thrown at.
double calmest_moment(const Asset& asset, int clip, double stature, double begin, double end) {
  constexpr int kMoments = 100;
  std::vector<JointJet<double>> jets(asset.skeleton.joints.size());
  std::vector<double> unrest, heights;  // 1/s, m
  const auto time = [&](int i) { return begin + (end - begin) * (i + 1) / (kMoments + 1); };
  for (int i = 0; i < kMoments; ++i) {
    (void)SamplingJob<double>{&asset.clips[clip], time(i), jets}.Run();
    double sum = jets[0].velocity.norm();
    for (const JointJet<double>& jet : jets) sum += jet.omega.norm();
    unrest.push_back(sum);
    heights.push_back(jets[0].translation.z());
  }
  std::vector<double> sorted = heights;
  std::nth_element(sorted.begin(), sorted.begin() + kMoments / 2, sorted.end());
  const double tall = sorted[kMoments / 2], slack = 0.05 * stature;
  int calmest = 0;
  for (int i = 1; i < kMoments; ++i) {
    const bool stands = std::abs(heights[i] - tall) < slack,
               stood = std::abs(heights[calmest] - tall) < slack;
    if (stands == stood ? unrest[i] < unrest[calmest] : stands) calmest = i;
  }
  return time(calmest);
}

}  // namespace

Scene demo_scene(const std::shared_ptr<const Asset>& source) {
  const std::shared_ptr<const Asset> asset = with_a_clip(source);
  Scene s;
  const Skeleton& body = asset->skeleton;
  const auto first_of = [&](std::initializer_list<const char*> names, int otherwise) {
    for (const char* n : names)
      for (std::size_t i = 0; i < asset->clips.size(); ++i)
        if (asset->clips[i].name.find(n) != std::string::npos && asset->clips[i].duration > 0.3f)
          return static_cast<int>(i);
    return otherwise;
  };
  int longest = 0;
  for (std::size_t i = 0; i < asset->clips.size(); ++i)
    if (asset->clips[i].duration > asset->clips[longest].duration) longest = static_cast<int>(i);
  const auto body_at = [&](std::initializer_list<Role> roles) {
    for (const Role r : roles)
      if (const int j = body.find(r); j >= 0 && j < body.body_count) return j;
    return body.body_count / 2;
  };
  s.title = body.name;
  SceneCharacter c;
  c.asset = asset;
  c.name = body.name;
  const int walk = first_of({"walk", "Walk"}, longest), stand = first_of({"stand", "idle", "Idle"}, walk);
  const auto [lowest, highest] = extent(*asset, walk);
  const double height = std::max(0.3, highest - lowest), mass = body.total_mass();
  // Its shapes stand on the floor, not in it: a leg that the floor pushes never comes back to its clip.
  c.position.z() = std::max(0.0, -std::min(lowest, extent(*asset, stand).first));
  c.clips.push_back({.clip = walk, .start = 0, .blend = 0});
  // From how it lies to the first pose of its own way up or, where it has none, to standing; then played.
  const int own_way = first_of({"get_up_supine", "get_up", "getup", "GetUp"}, -1);
  ClipUse up{.clip = own_way >= 0 ? own_way : stand, .align = true};
  up.clip_when_prone = own_way >= 0 ? first_of({"get_up_prone"}, -1) : -1;
  up.offset = own_way >= 0 ? 0 : calmest_moment(*asset, stand, height, 0, asset->clips[stand].duration);
  up.start = 7.4;
  up.blend = 2;
  up.rate = 0;
  up.from_pose = true;
  c.clips.push_back(up);
  up.start += up.blend;
  up.blend = 0;
  up.rate = 1;
  up.from_pose = false;
  c.clips.push_back(up);
  double stands = up.start;  // s
  if (own_way >= 0) {
    stands += double(asset->clips[own_way].duration) - 0.1;
    c.clips.push_back({.clip = stand, .start = stands, .blend = 0.3, .align = true});
  }
  c.strength = {{0, 1}, {4.9, 1}, {5.0, 0}, {7.4, 0}, {8.6, 1}};
  c.root = {{0, RootDrive::kKinematic},
            {5.0, RootDrive::kFree},
            {7.4, RootDrive::kAssisted},
            {stands + 0.3, RootDrive::kKinematic}};
  // Less than the weight: while it gets up, the ground has to carry it.
  c.settings.root_force = 6 * mass;
  c.settings.root_torque = 1.3 * mass * height;
  s.characters.push_back(c);
  SceneProp ball;
  ball.name = "ball";
  ball.settings.size = Vec3<double>::Constant(0.07 * height);
  ball.settings.mass = 0.1 * mass;
  ball.target_character = 0;
  ball.target_joint = body_at({Role::kUpperArmL, Role::kChest});
  ball.speed = 14;
  ball.from = {0.6, 2.6, 1.0};
  const double hit = calmest_moment(*asset, walk, height, 1.5, 3.5);
  ball.launch_time = hit - ball.from.norm() / ball.speed;
  s.props.push_back(ball);
  ball.name = "heavy ball";
  ball.settings.size = Vec3<double>::Constant(0.1 * height);
  ball.settings.mass = 0.12 * mass;
  ball.target_joint = body_at({Role::kChest, Role::kSpine, Role::kPelvis});
  ball.speed = 9;
  ball.from = {2.4, -1.6, 1.0};
  ball.launch_time = 4.75;
  s.props.push_back(ball);
  s.duration = std::max(12.0, stands + 2);
  s.captions = {{0, "playback: nothing to solve"},
                {hit, "a ball at the shoulder: only what saturates is simulated"},
                {hit + 1.2, "back on the animation"},
                {5.0, "a harder hit: the strength is gone"},
                {7.4, "strength returns"},
                {stands + 0.3, "playback again"}};
  s.camera.follow_character = 0;
  s.plotted_joint = body_at({Role::kUpperArmL, Role::kChest});
  return s;
}

}  // namespace sinew::scene
