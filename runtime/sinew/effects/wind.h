// Moving air: quadratic drag on the colliders, against the air's own velocity. Still air only slows.
#pragma once

#include "sinew/effects/flow.h"

namespace sinew {

/// The air. attach() refuses numbers that are not finite, and a density below 0.
struct WindSettings {
  Vec3<double> velocity = Vec3<double>::Zero();  ///< of the air, m/s, world
  double density = 1.2;                          ///< kg/m³, at sea level
  std::vector<std::string> joints;               ///< whose colliders feel it; none named: all

  /// Calls visitor(name, member) for each, by its name in scene files.
  template <class Visitor>
  void visit(Visitor&& visitor) {
    visitor("velocity", velocity);
    visitor("density", density);
    visitor("joints", joints);
  }
};

/// Drags one tree's colliders along with the air, each on its own: none is in another's lee.
template <class T>
class Wind final : public Effect<T> {
 public:
  using Settings = WindSettings;  ///< what can be set
  /// Without a check: attach() refuses what cannot be meant.
  explicit Wind(const Settings& s) : settings(s) {}

  Status attach(const Skeleton& skeleton, const Tree<T>& tree) override;
  int instances() const override { return static_cast<int>(spots_.size()); }
  void begin_step(const EffectPose<T>& start) override;
  double add_gradient(const EffectPose<T>& pose, const Wrenches<T>& out) const override;
  void add_curvature(const EffectPose<T>& pose, const Curvature<T>& out) const override;
  void add_load(const EffectPose<T>& pose, const Motion<T>& motion, const Wrenches<T>& out) const override;
  bool passive() const override { return settings.velocity.isZero(0); }
  std::size_t bytes() const override;

  Settings settings;  ///< velocity and density may change between steps: gusts are the host's

 private:
  std::vector<FlowSpot<T>> spots_;
  std::vector<Drag<T>> drag_;  ///< [spot] in the present step
};

extern template class Wind<float>;
extern template class Wind<double>;

}  // namespace sinew
