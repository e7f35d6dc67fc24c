// What one character's animation wants: clips one after the other, or the motion that the scene file writes
// down.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "scene/scene.h"

namespace sinew::scene {

/// A place on the ground, turned about the vertical.
Transform<double> upright(const Vec3<double>& position, double yaw);

/// Angle about the vertical (rad) of a root that points ahead at rest.
double heading(const Quat<double>& rotation, const Quat<double>& rest);

/// Clips are crossfaded, each placed in the world. The character must outlive the player.
template <class T>
class Player {
 public:
  explicit Player(const SceneCharacter& c);

  /// Whether what it wants changes in time.
  bool moves() const;
  /// `now`: local pose of the character, root in the world.
  const std::vector<JointJet<T>>& at(double t, std::span<const Transform<T>> now);
  /// The same for who plays a graph, which may ask for more. What is wrong with its motion: fault().
  const std::vector<JointJet<T>>& at(double t, const Felt<T>& felt);
  bool has_graph() const { return graph_.has_value(); }
  const Status& fault() const { return fault_; }
  /// [slot of the asset's curves] what they were when a pose was last asked for.
  std::span<const TimeJet<T>> curves() const { return curves_; }
  /// At time 0, with the speeds that the character starts with.
  std::vector<JointJet<T>> start(std::span<const Transform<T>> now);

 private:
  void stand(double t, std::vector<JointJet<T>>& jets) const;
  void begin(std::size_t i, std::span<const Transform<T>> pose);

  const SceneCharacter& c_;
  std::vector<Transform<double>> places_;
  std::vector<int> chosen_;         ///< [use] clip
  std::size_t begun_ = 0;           ///< uses that have started
  std::vector<Transform<T>> held_;  ///< [joint] pose in which the last use with from_pose began
  std::vector<JointJet<T>> a_, b_;
  std::vector<TimeJet<T>> curves_, clip_curves_;
  std::optional<GraphMotion<T>> graph_;
  Status fault_;
};

extern template class Player<float>;
extern template class Player<double>;

}  // namespace sinew::scene
