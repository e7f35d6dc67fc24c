// The run of project/main.gd through the C interface alone, and what Godot's skeletons said after each of its
// steps. Usage: sample_godot_compare ASSET.sinew POSES. Prints the hashes that main.gd prints; fails where
// poses differ.
#include <sinew/c/sinew.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <vector>

#include "axes.h"

namespace {

using axes::Transform;

constexpr int kFrames = 600;
/// The bystander in main.tscn.
const axes::Place kPlace = [] {
  axes::Place place;
  place.yaw = std::acos(-1.0) / 2;
  place.origin = {4, 0, -3};
  return place;
}();

// Godot keeps transforms, and multiplies them along the chain, in single precision: up to nine of them, each
// off by half a unit in the last place (1e-7 of a unit vector, 5e-7 m at 8 m). Turned bones are multiplied by
// as many more.
constexpr double kTurned = 2e-5, kMoved = 1e-5;  // entries of a rotation, m

void check(sinew_status status, const char* what) {
  if (status == SINEW_OK) return;
  std::fprintf(stderr, "compare: %s: %s: %s\n", what, sinew_status_name(status), sinew_last_reason());
  std::exit(1);
}

struct Scene {
  sinew_asset asset = 0;
  sinew_world world = 0;
  sinew_character hero = 0, bystander = 0;
  sinew_prop ball = 0;
  std::int32_t chest = 0, walk = 0, stand = 0;
  std::vector<sinew_jet> jets;
  bool bystander_rises = false;

  explicit Scene(const char* path) {
    check(sinew_asset_load(path, &asset), path);
    check(sinew_asset_find_joint(asset, "chest", &chest), "chest");
    check(sinew_asset_find_clip(asset, "walk", &walk), "walk");
    check(sinew_asset_find_clip(asset, "stand", &stand), "stand");
    sinew_asset_info info{};
    info.size = sizeof info;
    check(sinew_asset_get_info(asset, &info), path);
    jets.resize(std::size_t(info.joints));
    check(sinew_world_create(nullptr, &world), "world");
    check(sinew_world_add_character(world, asset, nullptr, &hero), "hero");
    sinew_character_settings settings{};
    settings.size = sizeof settings;
    check(sinew_character_settings_init(&settings), "bystander");
    settings.root = SINEW_ROOT_GROUNDED;
    check(sinew_world_add_character(world, asset, &settings, &bystander), "bystander");
    check(sinew_character_add_behaviour(bystander, nullptr), "bystander");
    sinew_prop_settings thrown{};
    thrown.size = sizeof thrown;
    check(sinew_prop_settings_init(&thrown), "ball");
    thrown.mass = 4;
    thrown.pose.translation[1] = 3;
    thrown.pose.translation[2] = 1.5;
    thrown.velocity[0] = 1.2;
    thrown.velocity[1] = -6;
    thrown.velocity[2] = 2;
    check(sinew_world_add_prop(world, &thrown, &ball), "ball");
  }

  ~Scene() {
    sinew_world_destroy(world);
    sinew_asset_destroy(asset);
  }

  void step(int frame) {
    const float h = 1 / 60.f;
    const sinew_play play = {hero, asset, walk, 0, frame / 60.0, 1, 0};
    check(sinew_play_clips(&play, 1), "walk");
    const auto joints = std::int32_t(jets.size());
    check(sinew_clip_sample(asset, stand, frame / 60.0, 1, 0, jets.data(), joints), "stand");
    kPlace.put(jets[0]);
    if (frame == 0 || bystander_rises) {
      check(sinew_character_set_target(bystander, jets.data(), joints), "stand");
    } else {
      check(sinew_character_balance(bystander, jets.data(), joints, h), "balance");
    }
    if (frame == 0) check(sinew_character_reset(hero), "reset");
    if (frame == 0) check(sinew_character_reset(bystander), "reset");
    check(sinew_world_step(world, h), "step");
    sinew_character_report report{};
    report.size = sizeof report;
    check(sinew_character_get_report(bystander, &report), "bystander");
    if (bystander_rises && report.on_animation) {
      bystander_rises = false;
      check(sinew_character_set_root_drive(bystander, SINEW_ROOT_GROUNDED), "bystander");
    }
  }

  /// What main.gd does after so many steps.
  void act(int frame) {
    if (frame == 60) {
      const float* const at = model(hero, chest).translation;
      const double point[3] = {at[0], at[1], at[2]}, impulse[3] = {0, 90, 0};
      check(sinew_character_apply_impulse(hero, chest, point, impulse), "push");
    } else if (frame == 180) {
      const sinew_transform pose = {{0, 0, 0, 1}, {3.8f, 2, 1.6f}};
      const float velocity[3] = {1.2f, -8, 0}, still[3] = {0, 0, 0};
      check(sinew_prop_set_state(ball, &pose, velocity, still), "ball");
    } else if (frame == 240) {
      check(sinew_character_set_root_drive(hero, SINEW_ROOT_FREE), "hero");
      check(sinew_character_set_strength(hero, 0), "hero");
      check(sinew_character_order(bystander, SINEW_BEHAVIOUR_KNOCK_DOWN), "bystander");
    } else if (frame == 420) {
      check(sinew_character_set_strength(hero, 1), "hero");
      check(sinew_character_set_root_drive(hero, SINEW_ROOT_KINEMATIC), "hero");
      check(sinew_character_order(bystander, SINEW_BEHAVIOUR_STAND), "bystander");
      check(sinew_character_set_root_drive(bystander, SINEW_ROOT_KINEMATIC), "bystander");
      bystander_rises = true;
    }
  }

  static const sinew_transform& model(sinew_character who, int joint,
                                      sinew_view_kind kind = SINEW_VIEW_MODEL) {
    sinew_view view{};
    check(sinew_character_get_view(who, kind, &view), "view");
    return static_cast<const sinew_transform*>(view.data)[joint];
  }
};

/// The same rotation and place another way: the images of Godot's axes under the quaternion, in double.
std::array<double, 12> turned_axes(const sinew_transform& t) {
  std::array<double, 12> columns;
  const double q[3] = {t.rotation[0], t.rotation[1], t.rotation[2]}, w = t.rotation[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double v[3] = {0, 0, 0}, u[3], r[3];
    v[(axis + 1) % 3] = 1;  // Godot's x, y, z are Sinew's y, z, x
    for (std::size_t k = 0; k < 3; ++k)
      u[k] = q[(k + 1) % 3] * v[(k + 2) % 3] - q[(k + 2) % 3] * v[(k + 1) % 3] + w * v[k];
    for (std::size_t k = 0; k < 3; ++k)
      r[k] = v[k] + 2 * (q[(k + 1) % 3] * u[(k + 2) % 3] - q[(k + 2) % 3] * u[(k + 1) % 3]);
    for (std::size_t k = 0; k < 3; ++k) columns[3 * axis + k] = r[(k + 1) % 3];
  }
  for (std::size_t k = 0; k < 3; ++k) columns[9 + k] = t.translation[(k + 1) % 3];
  return columns;
}

/// A bone that rests without rotation where a joint does, when the joint is there: now * at_rest^-1 turns it.
std::array<double, 12> turned_since(const sinew_transform& at_rest, const sinew_transform& now) {
  const auto before = turned_axes(at_rest), after = turned_axes(now);
  std::array<double, 12> columns = after;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      columns[3 * i + k] = 0;
      for (std::size_t axis = 0; axis < 3; ++axis)
        columns[3 * i + k] += after[3 * axis + k] * before[3 * axis + i];
    }
  return columns;
}

struct Worst {
  const char* what;
  double turned = 0, moved = 0;
  void take(const std::array<float, 12>& there, const std::array<double, 12>& here) {
    for (std::size_t k = 0; k < 12; ++k) {
      double& worst = k < 9 ? turned : moved;
      const double off = std::fabs(there[k] - here[k]);
      if (!(off <= worst)) worst = off;  // not a number stays
    }
  }
  bool report() const {
    std::printf("%-42s %.2g in rotations, %.2g m\n", what, turned, moved);
    return turned <= kTurned && moved <= kMoved;
  }
};

/// Godot's script has written the columns of the rotation, then the origin.
bool same_floats(const std::array<float, 12>& columns, const Transform& rows) {
  bool same = true;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) same = same && columns[3 * i + k] == rows[3 * k + i];
  return same && std::equal(columns.begin() + 9, columns.end(), rows.begin() + 9);
}

std::uint64_t add_pose(std::uint64_t hash, sinew_character who, int joints) {
  for (int j = 0; j < joints; ++j) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(&Scene::model(who, j));
    for (std::size_t k = 0; k < 7 * sizeof(float); ++k) hash = (hash ^ bytes[k]) * 0x100000001b3u;
  }
  return hash;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: sample_godot_compare ASSET.sinew POSES\n");
    return 2;
  }
  Scene scene(argv[1]);
  std::ifstream file(argv[2], std::ios::binary);
  Worst bones{"the hero's bones, as Godot holds them"}, chain{"the hero's bones, in Godot's chain"},
      placed{"the bystander's, turned and placed"};
  const int joints = int(scene.jets.size());
  std::vector<sinew_transform> at_rest;
  for (int j = 0; j < joints; ++j) at_rest.push_back(Scene::model(scene.bystander, j));
  std::uint64_t hash = 0xcbf29ce484222325;
  long different = 0;
  const auto next = [&] {
    std::array<float, 12> read;
    if (file.read(reinterpret_cast<char*>(read.data()), sizeof read)) return read;
    std::fprintf(stderr, "compare: %s: shorter than %d frames of %d bones\n", argv[2], kFrames, joints);
    std::exit(1);
  };
  for (int frame = 0; frame < kFrames; ++frame) {
    scene.step(frame);
    hash = add_pose(hash, scene.hero, joints);
    for (int j = 0; j < joints; ++j) {
      const sinew_transform& local = Scene::model(scene.hero, j, SINEW_VIEW_LOCAL);
      const auto pose = next();
      if (!same_floats(pose, axes::to_godot(local))) ++different;
      bones.take(pose, turned_axes(local));
      chain.take(next(), turned_axes(Scene::model(scene.hero, j)));
    }
    for (int j = 0; j < joints; ++j)
      placed.take(next(), turned_since(at_rest[std::size_t(j)], Scene::model(scene.bystander, j)));
    if (frame + 1 == 180 || frame + 1 == kFrames)
      std::printf("pose hash %016llx\n", static_cast<unsigned long long>(hash));
    scene.act(frame + 1);
  }
  std::printf("%ld of %d poses are not the floats that Sinew gave\n", different, kFrames * joints);
  const bool near = int(bones.report()) + int(chain.report()) + int(placed.report()) == 3;
  if (file.peek() != std::ifstream::traits_type::eof()) {
    std::fprintf(stderr, "compare: %s: more than %d frames of %d bones\n", argv[2], kFrames, joints);
    return 1;
  }
  return near && different == 0 ? 0 : 1;
}
