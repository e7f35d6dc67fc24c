// What the handles of the C interface name.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "sinew/behaviour/behaviour.h"
#include "sinew/c/handle.h"
#include "sinew/character/contact_events.h"
#include "sinew/character/recording.h"
#include "sinew/character/world.h"
#include "sinew/effects/static_shape.h"
#include "sinew/io/asset.h"

namespace sinew::c {

/// An asset; whoever plays its clips for long (a behaviour, a graph) shares it, so that its handle may go
/// before.
struct OwnedAsset {
  std::shared_ptr<const Asset> asset;
};

/// A character's balance, and whose clips it gets up by.
struct OwnedBehaviour {
  OwnedBehaviour(const Skeleton& skeleton, const BehaviourSettings& settings, Status& status)
      : behaviour(skeleton, settings, status) {}

  std::shared_ptr<const Asset> clips;  ///< null: it stays down
  Behaviour<float> behaviour;
};

/// A world and what the interface keeps for it.
struct OwnedWorld {
  explicit OwnedWorld(const WorldSettings& settings) : world(settings) {}

  std::atomic<bool> busy{false};                     ///< a call runs
  bool broken = false;                               ///< an exception left something half added
  std::vector<std::unique_ptr<StaticShape>> shapes;  ///< the world refers to them: they go after it
  World<float> world;
  ParallelFor jobs;
  int loops = 0;
  std::vector<JointJet<float>> jets;                        ///< of one character, as many as the largest has
  std::vector<std::unique_ptr<OwnedBehaviour>> behaviours;  ///< [character], or null
  std::vector<ContactEvent> waiting;
  std::optional<ContactRing> ring;
  std::unique_ptr<Recorder<float>> recorder;
};

}  // namespace sinew::c
