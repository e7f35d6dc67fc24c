// Scene files: who is there, what they play, what happens to them. Schema: tools/scene/README.md.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "convert/convert.h"
#include "scene/graph_motion.h"
#include "scene/recording.h"
#include "scene/start.h"
#include "scene/timeline.h"
#include "sinew/behaviour/behaviour_settings.h"
#include "sinew/character/world.h"
#include "study/schemes/schemes.h"

namespace sinew::scene {

struct ClipUse {
  int clip = 0;
  double start = 0, blend = 0.3, rate = 1;
  double offset = 0;       ///< s of the clip at `start`
  bool align = false;      ///< begins where the character's root stands and faces then
  bool from_pose = false;  ///< blends from the pose in which the character is then, not from the clip before
  int clip_when_prone = -1;  ///< get_up: played instead when the character lies face down at `start`
};

/// Of the muscles below a joint, or of a group.
struct PartTone {
  int joint = -1;     ///< −1: those of `group`
  std::string group;  ///< of Skeleton::muscles
  Timeline<Tone> tone;
};

struct SceneCharacter {
  std::shared_ptr<const Asset> asset;
  std::string name;
  Vec3<double> position = Vec3<double>::Zero();
  double yaw = 0;  ///< rad
  std::vector<ClipUse> clips;
  GraphUse graph;  ///< instead of clips, where there is one
  // What it does without clips: stands at `position`, or goes along `path`, turning from `yaw` on; all joined
  // by straight lines.
  Timeline<Vec3<double>> path;                               ///< m; a jump where a time stands twice
  Timeline<double> turn_rate;                                ///< about the vertical, rad/s
  std::vector<std::pair<int, Timeline<Vec3<double>>>> pose;  ///< joints' rotation vectors from rest, rad
  StartSpeeds speeds;
  Timeline<double> strength{{0, 1}};
  /// Further factors for the subtrees below joints, parents first; a subtree's own factor replaces that of a
  /// larger one around it.
  std::vector<std::pair<int, Timeline<double>>> group_strength;
  Timeline<Tone> tone{{0, Tone::kRigid}};
  std::vector<PartTone> part_tones;  ///< each over those before it
  Timeline<RootDrive> root{{0, RootDrive::kKinematic}};
  CharacterSettings settings;
  bool bake = false;                           ///< see CharacterDetail
  std::optional<BehaviourSettings> behaviour;  ///< keeps its balance
};

struct SceneProp {
  PropSettings settings;
  std::string name;
  double launch_time = 0;  ///< hidden far away until then
  // A throw is aimed when it starts, so that gravity brings the prop to the joint in `flight` seconds.
  int target_character = -1, target_joint = -1;
  double speed = 8;              ///< m/s
  Vec3<double> from{2, 0, 1.5};  ///< relative to the character's root position at launch, its heading as X
};

struct Push {
  double time = 0, duration = 0;  ///< s; 0: within one step
  double every = 0;               ///< s after which it comes again; 0: once
  int character = 0, joint = 0;
  Vec3<double> point = Vec3<double>::Zero();    ///< m, in the joint's axes
  Vec3<double> impulse = Vec3<double>::Zero();  ///< N·s in total, world
  Timeline<Vec3<double>> force;  ///< N, world, from its first to its last time; instead of all of the above
};

/// An effect of the runtime that acts on some characters and props, each of which gets its own.
struct SceneEffect {
  std::string name;
  std::vector<int> characters, props;
  std::function<std::unique_ptr<Effect<float>>(const Skeleton&)> make_float;
  std::function<std::unique_ptr<Effect<double>>(const Skeleton&)> make_double;

  template <class T>
  std::unique_ptr<Effect<T>> make(const Skeleton& skeleton) const {
    if constexpr (std::is_same_v<T, float>)
      return make_float(skeleton);
    else
      return make_double(skeleton);
  }
};

struct Scene {
  std::string title;
  double duration = 5;
  double frame_rate = 60;
  bool double_precision = false;
  WorldSettings world;
  study::Compared scheme = study::Compared::kBossak;
  std::vector<SceneCharacter> characters;
  std::vector<SceneProp> props;
  std::vector<Collider> obstacles;
  std::vector<Push> pushes;
  std::vector<LoopSettings> loops;
  std::vector<ParticleBody> particles;
  std::vector<SceneEffect> effects;
  bool restitution = true, continuous_detection = true;  ///< declared in the world
  Timeline<std::string> captions;
  Camera camera;
  int plotted_joint = -1;
};

/// Reads and checks a scene file; assets are looked up relative to it. One line names the file and the fault.
convert::Error load_scene(const std::string& path, Scene& out);

struct EffectRow;
/// The same with other effects than effect_registry()'s.
convert::Error load_scene(const std::string& path, std::span<const EffectRow> registry, Scene& out);

/// The demo's story for any asset: playback, a ball at the shoulder, a harder hit that fells it, strength
/// returns.
Scene demo_scene(const std::shared_ptr<const Asset>& asset);

}  // namespace sinew::scene
