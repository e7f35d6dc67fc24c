#include "scenes.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <type_traits>

#include "sinew/animation/blending_job.h"
#include "sinew/animation/inertialize_job.h"
#include "sinew/animation/model_pose_job.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/behaviour/behaviour.h"
#include "sinew/character/world.h"
#include "sinew/crowd/crowd.h"
#include "sinew/effects/buoyancy.h"
#include "sinew/effects/continuous_detection.h"
#include "sinew/effects/force_field.h"
#include "sinew/effects/joint_spring.h"
#include "sinew/effects/restitution.h"
#include "sinew/effects/strand.h"
#include "sinew/effects/wind.h"
#include "sinew/graph/graph_file.h"
#include "sinew/graph/graph_step.h"

namespace sinew::portability {

Status Actors::load(const char* asset_file, const char* graph_file) {
  if (Status s = load_asset(asset_file, asset); !s) return s;
  for (const char* name : {"stand", "walk", "run"})
    if (asset.find_clip(name) < 0)
      return Status::error(Code::kInvalidArgument, "no clip to stand, walk or run");
  for (const Role role : {Role::kChest, Role::kHandL, Role::kHandR})
    if (asset.skeleton.find(role) < 0) return Status::error(Code::kInvalidArgument, "no chest, or no hands");
  std::ifstream file(graph_file, std::ios::binary);
  const std::vector<std::uint8_t> bytes(std::istreambuf_iterator<char>(file), {});
  if (Status s = read_graph(bytes, definition); !s) return s;
  return Graph::bind(definition, asset, graph);
}

namespace {

constexpr double kStep = 1 / 60.0;  ///< s

/// A world with one character, and the frame that all of these scenes share.
template <class T>
struct Stage {
  const Actors& actors;
  World<T> world;
  Status status;
  std::vector<JointJet<T>> jets;
  const char* fault = "";
  bool solved = false;  ///< something was moved by more than its clip

  explicit Stage(const Actors& a, const WorldSettings& settings = {})
      : actors(a), world(settings), jets(a.asset.skeleton.joints.size()) {}

  Character<T> hero() { return world.character(0); }
  int joint(Role role) const { return actors.asset.skeleton.find(role); }
  Vec3<T> place(Role role) { return hero().model()[std::size_t(joint(role))].translation; }
  void expect(const Status& s) {
    if (!s && !*fault) fault = s.reason;
  }
  /// The demo's character as a clip begins, `height` m above it.
  void add(const CharacterSettings& settings, const char* clip, double height = 0) {
    (void)world.add_character(actors.asset.skeleton, settings, status);
    expect(status);
    play(clip, 0);
    jets[0].translation.z() += T(height);
    expect(hero().set_target(jets));
    expect(hero().reset());
  }
  void play(const char* clip, double time) { expect(SamplingJob<T>{&actors.clip(clip), time, jets}.Run()); }
  /// Goes on by a frame; tells the hash where everybody and every prop is.
  void step(PoseHash& hash) {
    expect(world.step(T(kStep)));
    for (int c = 0; c < world.character_count(); ++c) {
      hash.add(world.character(c).model());
      solved |= world.character(c).report().unknown_dofs > 0;
    }
    for (int p = 0; p < world.prop_count(); ++p) {
      hash.add(world.prop_pose(p));
      solved |= world.prop_report(p).contacts > 0;
    }
    hash.end_frame();
  }
  /// What is wrong with a scene in which something was to be solved for.
  std::string result() const { return *fault ? fault : solved ? "" : "nothing was disturbed"; }
};

CharacterSettings limp() {
  CharacterSettings settings;
  settings.root = RootDrive::kFree;
  settings.strength = 0;
  return settings;
}

/// Clips sampled, blended, and changed by a transition that is interrupted: no physics.
template <class T>
std::string playback(const Actors& actors, PoseHash& hash) {
  const Skeleton& skeleton = actors.asset.skeleton;
  const int joints = int(skeleton.joints.size());
  std::vector<int> parents;
  for (const Joint& joint : skeleton.joints) parents.push_back(joint.parent);
  std::vector<JointJet<T>> a(joints), b(joints), mixed(joints), shown(joints);
  std::vector<Transform<T>> model(joints);
  std::vector<T> numbers(inertial_numbers(joints, 1));
  InertialState<T> fade{numbers, joints, 1};
  for (const Clip& clip : actors.asset.clips)
    for (int frame = 0; frame < 60; ++frame) {
      const double time = frame * kStep;
      bool good = SamplingJob<T>{&actors.clip("walk"), ClipTime(time, 0.9, 0.1), a}.Run().ok();
      good &= SamplingJob<T>{&clip, time, b}.Run().ok();
      const T w = T(frame) / 60;
      const BlendLayer<T> layers[] = {{a, {1 - w, T(-1), T(0)}}, {b, {w, T(1), T(0)}}};
      good &= BlendingJob<T>{.layers = layers, .out = mixed}.Run().ok();
      if (frame == 20 || frame == 26) good &= begin_inertial<T>(shown, mixed, T(0.2), fade).ok();
      good &= InertializeJob<T>{mixed, &fade, {}, shown}.Run().ok();
      good &= ModelPoseJob<T>{.parents = parents, .jets = shown, .model = model}.Run().ok();
      if (!good) return "a job failed";
      fade.elapsed += T(kStep);
      hash.add(std::span<const Transform<T>>(model));
      for (const JointJet<T>& jet : shown) {
        hash.add(jet.omega);
        hash.add(jet.alpha);
      }
      hash.end_frame();
    }
  return {};
}

/// A Crowd's own sampling and check, which are of floats.
std::string crowd_in_batches(const Actors& actors, PoseHash& hash) {
  constexpr int kCount = 21;
  Status status;
  const auto crowd = Crowd::create(actors.asset.skeleton, {.capacity = kCount}, status);
  if (!crowd) return status.reason;
  for (int n = 0; n < kCount; ++n) {
    CrowdTrack track{&actors.clip(n % 2 ? "walk" : "run"), {0.13 * n, 0.8 + 0.05 * (n % 5), 0.1}};
    track.place.translation = {float(n), 0, 0};
    if (status = crowd->play(n, track); !status) return status.reason;
  }
  for (int frame = 0; frame < 30; ++frame) {
    if (status = crowd->step(kStep); !status) return status.reason;
    for (int n = 0; n < kCount; ++n) {
      hash.add(std::span<const Transform<float>>(crowd->model(n)));
      for (int dof = 0; dof < crowd->dof_count(); ++dof) {
        const float torque = crowd->torque(n, dof);
        hash.add(std::span<const float>(&torque, 1));
      }
    }
    hash.end_frame();
  }
  return {};
}

/// Many whom nothing disturbs: a world checks them in batches (in float), and finds torques and loads.
template <class T>
std::string crowd(const Actors& actors, PoseHash& hash) {
  constexpr int kCount = 21;
  Stage<T> stage(actors);
  for (int n = 0; n < kCount; ++n) {
    (void)stage.world.add_character(actors.asset.skeleton, {}, stage.status);
    stage.expect(stage.status);
  }
  for (int frame = 0; frame < 60; ++frame) {
    for (int n = 0; n < kCount; ++n) {
      stage.play(n % 2 ? "walk" : "run", frame * kStep + 0.11 * n);
      stage.jets[0].translation.y() += T(2 * n);
      stage.expect(stage.world.character(n).set_target(stage.jets));
      if (frame == 0) stage.expect(stage.world.character(n).reset());
    }
    for (int n = 0; frame > 0 && n < kCount; ++n) {
      hash.add(stage.world.character(n).torque());
      hash.add(stage.world.character(n).load());
    }
    stage.step(hash);
  }
  if (*stage.fault) return stage.fault;
  if constexpr (std::is_same_v<T, float>) return crowd_in_batches(actors, hash);
  return {};
}

/// A walker who is hit at the chest.
template <class T>
std::string blow(const Actors& actors, PoseHash& hash) {
  Stage<T> stage(actors);
  stage.add({}, "walk");
  for (int frame = 0; frame < 150; ++frame) {
    stage.play("walk", frame * kStep);
    stage.expect(stage.hero().set_target(stage.jets));
    if (frame == 30)
      stage.expect(
          stage.hero().apply_impulse(stage.joint(Role::kChest), stage.place(Role::kChest), {0, 90, 0}));
    stage.step(hash);
  }
  return stage.result();
}

/// Falls limp onto the floor, out of a run.
template <class T>
std::string limp_fall(const Actors& actors, PoseHash& hash) {
  Stage<T> stage(actors);
  CharacterSettings settings = limp();
  settings.self_collision = true;
  stage.add(settings, "run", 0.2);
  for (int frame = 0; frame < 150; ++frame) stage.step(hash);
  return stage.result();
}

/// Balls that hit a walker, bounce and roll; one is too fast for a step to see.
template <class T>
std::string thrown_balls(const Actors& actors, PoseHash& hash) {
  Stage<T> stage(actors);
  stage.expect(stage.world.template declare<Restitution>());
  stage.expect(stage.world.template declare<ContinuousDetection>());
  CharacterSettings relaxed;
  relaxed.tone = Tone::kAlert;
  stage.add(relaxed, "walk");
  for (const double speed : {6.0, 25.0}) {
    PropSettings ball;
    ball.mass = 3;
    ball.restitution = 0.5;
    ball.pose.translation = {0.3, speed / 2, 1.2};
    ball.velocity = {0, -speed, 2};
    (void)stage.world.add_prop(ball, stage.status);
    stage.expect(stage.status);
  }
  for (int frame = 0; frame < 120; ++frame) {
    stage.play("walk", frame * kStep);
    stage.expect(stage.hero().set_target(stage.jets));
    stage.step(hash);
  }
  return stage.result();
}

/// Boxes that are dropped onto each other, and what slides and rolls down a slope.
template <class T>
std::string stack_and_slope(const Actors& actors, PoseHash& hash) {
  Stage<T> stage(actors);
  Collider slope;
  slope.shape = Shape::kBox;
  slope.size = {1.5, 1, 0.1};
  slope.local.translation = {3, 0, 0.4};
  slope.local.rotation = Quat<double>(0.96592582628906829, 0, 0.25881904510252076, 0);  // 30° about y
  stage.expect(stage.world.add_obstacle(slope));
  const auto drop = [&](Shape shape, const Vec3<double>& size, const Vec3<double>& at) {
    PropSettings prop;
    prop.shape = shape;
    prop.size = size;
    prop.mass = 2;
    prop.pose.translation = at;
    (void)stage.world.add_prop(prop, stage.status);
    stage.expect(stage.status);
  };
  for (int n = 0; n < 4; ++n) drop(Shape::kBox, {0.2, 0.15, 0.1}, {0.03 * n, 0.01 * n, 0.12 + 0.22 * n});
  drop(Shape::kBox, {0.15, 0.1, 0.1}, {2.6, -0.4, 1.1});
  drop(Shape::kSphere, {0.1, 0.1, 0.1}, {2.6, 0, 1.1});
  drop(Shape::kCapsule, {0.08, 0.08, 0.2}, {2.6, 0.4, 1.1});
  for (int frame = 0; frame < 150; ++frame) stage.step(hash);
  return stage.result();
}

/// Hangs limp by both hands from a rod on two ropes, with a strand at its chest; lets go with one hand.
template <class T>
std::string bar_and_strand(const Actors& actors, PoseHash& hash) {
  Stage<T> stage(actors);
  stage.add(limp(), "stand", 1);
  const Role hands[] = {Role::kHandL, Role::kHandR};
  int grips[2] = {};
  for (int side = 0; side < 2; ++side) {
    LoopSettings grip;
    grip.kind = side ? LoopKind::kRope : LoopKind::kPoint;
    grip.length = side ? 0.1 : 0;
    grip.a = {AnchorKind::kCharacter, 0, stage.joint(hands[side]), {}};
    grip.b.frame.translation = stage.place(hands[side]).template cast<double>() + Vec3<double>(0.02, 0, 0.05);
    grips[side] = stage.world.add_loop(grip, stage.status);
    stage.expect(stage.status);
  }
  StrandSettings strand;
  strand.frame = {AnchorKind::kCharacter, 0, stage.joint(Role::kChest), {}};
  strand.direction = {1, 0, 0};
  strand.particles = 8;
  (void)stage.world.add_particles(make_strand(strand), stage.status);
  stage.expect(stage.status);
  for (int frame = 0; frame < 90; ++frame) {
    if (frame == 50) stage.expect(stage.world.set_loop(grips[0], false));
    for (int node = 0; node < strand.particles; ++node) hash.add(stage.world.particle(0, node));
    stage.step(hash);
  }
  return stage.result();
}

/// Limp in water up to the chest, in a gale, on springs, pulled away.
template <class T>
std::string wind_and_water(const Actors& actors, PoseHash& hash) {
  Stage<T> stage(actors);
  stage.add(limp(), "walk");
  WindSettings gale;
  gale.velocity = {3, 18, 0};
  stage.expect(stage.world.add_effect(0, std::make_unique<Wind<T>>(gale)));
  BuoyancySettings water;
  water.level = 0.9;
  water.flow = {0.5, 0, 0};
  stage.expect(stage.world.add_effect(0, std::make_unique<Buoyancy<T>>(water)));
  JointSpringSettings spring;
  spring.damping = 1;
  stage.expect(stage.world.add_effect(0, std::make_unique<JointSpring<T>>(spring)));
  ForceFieldSettings pull;
  pull.center = {2, 0, 1};
  pull.acceleration = 3;
  stage.expect(stage.world.add_effect(0, std::make_unique<ForceField<T>>(pull)));
  for (int frame = 0; frame < 120; ++frame) stage.step(hash);
  return stage.result();
}

/// Stands, walks and runs by a graph, and is pushed in a transition.
template <class T>
std::string graph(const Actors& actors, PoseHash& hash) {
  Stage<T> stage(actors);
  stage.add({}, "stand");
  GraphScratch<T> scratch(actors.graph);
  GraphMemory state(actors.graph.template state_bytes<T>());
  stage.expect(start_graph<T>(actors.graph, state));
  GraphParameters<T> parameters(actors.graph, state);
  const int speed = actors.definition.find_parameter("speed");
  for (int frame = 0; frame < 240; ++frame) {
    if (frame == 30) stage.expect(parameters.set(speed, T(1.275)));
    if (frame == 120) stage.expect(parameters.set(speed, T(3.2)));
    if (frame == 130)
      stage.expect(
          stage.hero().apply_impulse(stage.joint(Role::kChest), stage.place(Role::kChest), {0, 60, 0}));
    GraphStepJob<T> job{&actors.graph, state, frame ? T(kStep) : T(0), &scratch, stage.jets};
    stage.expect(job.Run());
    stage.expect(stage.hero().set_target(stage.jets));
    stage.step(hash);
  }
  return stage.result();
}

/// Stands, is pushed so that a step has to catch it, then so that none can: falls, and gets up.
template <class T>
std::string balance(const Actors& actors, PoseHash& hash) {
  Stage<T> stage(actors);
  CharacterSettings settings;
  settings.root = RootDrive::kGrounded;
  stage.add(settings, "stand");
  Behaviour<T> behaviour(actors.asset.skeleton, {}, stage.status);
  stage.expect(stage.status);
  stage.expect(behaviour.use_get_ups(actors.asset.skeleton, actors.asset.clips));
  int steps = 0;
  bool fell = false;
  for (int frame = 0; frame < 480; ++frame) {
    stage.play("stand", frame * kStep);
    stage.expect(behaviour.update(stage.hero(), stage.jets, T(kStep)));
    stage.expect(stage.hero().set_target(stage.jets));
    const T force = frame >= 20 && frame < 26 ? T(400) : frame >= 200 && frame < 206 ? T(2000) : T(0);
    if (force > 0)
      stage.expect(
          stage.hero().apply_force(stage.joint(Role::kChest), stage.place(Role::kChest), {force, 0, 0}));
    stage.step(hash);
    steps = std::max(steps, behaviour.report().steps);
    fell |= behaviour.fallen();
  }
  if (std::string wrong = stage.result(); !wrong.empty()) return wrong;
  return steps == 0 ? "no step was taken" : fell ? "" : "it did not fall";
}

#define SINEW_SCENE(function, about) \
  { #function, about, function < float>, function < double> }
constexpr Scene kScenes[] = {
    SINEW_SCENE(playback, "every clip, blended with a walk, through a transition that is interrupted"),
    SINEW_SCENE(crowd, "walkers and runners that nothing disturbs, with their torques"),
    SINEW_SCENE(blow, "a walker is hit at the chest"),
    SINEW_SCENE(limp_fall, "a limp body falls out of a run"),
    SINEW_SCENE(thrown_balls, "balls hit a walker, bounce and roll"),
    SINEW_SCENE(stack_and_slope, "boxes fall on each other, others slide and roll"),
    SINEW_SCENE(bar_and_strand, "a limp body hangs by its hands, and lets go with one"),
    SINEW_SCENE(wind_and_water, "a limp body in water, wind, springs and a field"),
    SINEW_SCENE(graph, "stands, walks and runs by a graph, and is pushed meanwhile"),
    SINEW_SCENE(balance, "is pushed, takes a step; is pushed, falls and gets up"),
};
#undef SINEW_SCENE

}  // namespace

std::span<const Scene> scenes() {
  return kScenes;
}

}  // namespace sinew::portability
