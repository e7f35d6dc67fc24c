// What the handles of the C interface name.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "sinew/animation/foot_leg.h"
#include "sinew/animation/look_chain.h"
#include "sinew/animation/mirror_job.h"
#include "sinew/behaviour/behaviour.h"
#include "sinew/c/graph_player.h"
#include "sinew/c/handle.h"
#include "sinew/c/sinew.h"
#include "sinew/character/contact_events.h"
#include "sinew/character/recording.h"
#include "sinew/character/sensor.h"
#include "sinew/character/world.h"
#include "sinew/crowd/population.h"
#include "sinew/effects/buoyancy.h"
#include "sinew/effects/force_field.h"
#include "sinew/effects/joint_spring.h"
#include "sinew/effects/static_shape.h"
#include "sinew/effects/wind.h"
#include "sinew/io/asset.h"
#include "sinew/skeleton/convex_hull.h"

namespace sinew::c {

/// An asset; whoever plays its clips for long (a behaviour, a graph) shares it, so that its handle may go
/// before.
struct OwnedAsset {
  explicit OwnedAsset(std::shared_ptr<const Asset> read);

  std::shared_ptr<const Asset> asset;
  // What jobs on poses need of it.
  std::vector<int> parents;              ///< [joint]
  std::vector<Transform<float>> rest;    ///< [joint]
  std::optional<LookChain<float>> look;  ///< of a skeleton with a head
  MirrorMap<float> mirror;               ///< where `mirrors` is ok
  Status mirrors;                        ///< else why left and right were not found
  std::array<FootLeg<float>, 2> legs;    ///< left and right, where `stands` is ok
  int pelvis = -1;                       ///< joint that carries them
  Status stands;                         ///< else why legs were not found
};

/// A character's balance, and whose clips it gets up by.
struct OwnedBehaviour {
  OwnedBehaviour(const Skeleton& skeleton, const BehaviourSettings& settings, Status& status)
      : behaviour(skeleton, settings, status) {}

  std::shared_ptr<const Asset> clips;  ///< null: it stays down
  Behaviour<float> behaviour;
};

/// An effect that was added, and what it is.
struct OwnedEffect {
  EffectId id;
  std::variant<std::monostate, Wind<float>*, Buoyancy<float>*, ForceField<float>*, JointSpring<float>*>
      effect;  ///< the world's; gone where World::effect() says so
};

/// The host's question, with the bodies that it knows.
struct AskedAccept {
  sinew_accept accept = nullptr;
  void* context = nullptr;
};

/// A sensor, and whom the host has it pass by.
struct OwnedSensor {
  explicit OwnedSensor(std::size_t bodies) : sensor(bodies) {}

  Sensor<float> sensor;
  AskedAccept asked;  ///< the sensor's filter refers to it
};

/// A world, or a crowd's, and what the interface keeps for it.
struct OwnedWorld {
  explicit OwnedWorld(const WorldSettings& settings) : alone(settings), world(*alone) {}
  explicit OwnedWorld(std::unique_ptr<Population> with) : crowd(std::move(with)), world(crowd->world()) {}

  std::atomic<bool> busy{false};                     ///< a call runs
  bool broken = false;                               ///< an exception left something half added
  std::vector<std::unique_ptr<StaticShape>> shapes;  ///< the world refers to them: they go after it
  std::vector<std::unique_ptr<ConvexHull>> hulls;    ///< likewise
  std::vector<std::unique_ptr<GraphPlayer>>
      graphs;                                ///< [character], or null; likewise: it saves their blocks
  std::shared_ptr<const Asset> crowd_asset;  ///< whose clips the crowd plays
  std::unique_ptr<Population> crowd;         ///< or null: the world is alone
  std::optional<World<float>> alone;
  World<float>& world;
  ParallelFor jobs;
  int loops = 0;
  std::vector<int> nodes;                                   ///< [body of particles] how many it has
  std::vector<JointJet<float>> jets;                        ///< of one character, as many as the largest has
  std::vector<std::unique_ptr<OwnedBehaviour>> behaviours;  ///< [character], or null
  std::vector<OwnedEffect> effects;  ///< in the order in which they were added, those that are gone too
  std::vector<std::unique_ptr<OwnedSensor>> sensors;  ///< in the order in which they were added
  std::vector<ContactEvent> waiting;
  std::optional<ContactRing> ring;
  std::unique_ptr<Recorder<float>> recorder;

  /// After a step: graphs hear of their characters' bodies.
  void feel() {
    for (std::size_t k = 0; k < graphs.size(); ++k)
      if (graphs[k]) graphs[k]->feel(world.character(static_cast<int>(k)));
  }
};

}  // namespace sinew::c
