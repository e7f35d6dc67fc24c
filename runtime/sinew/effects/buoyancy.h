// Still or streaming water below a level: what the colliders displace lifts them, and the water drags.
//
// The lift of a spot is ρ·|g|·volume·f(depth), f the submerged share of a ball, so its potential is convex in
// the height. The mass of the water that a body drags along (added mass) is not modelled.
#pragma once

#include "sinew/effects/flow.h"

namespace sinew {

/// The water. attach() refuses numbers that are not finite, and a density or volume below 0.
struct BuoyancySettings {
  double level = 0;                          ///< m, height of the surface
  double density = 1000;                     ///< kg/m³
  Vec3<double> flow = Vec3<double>::Zero();  ///< velocity of the water, m/s, world
  double volume = 1;                         ///< times that of the colliders: they may overlap, or hold air
  std::vector<std::string> joints;           ///< whose colliders feel it; none named: all

  /// Calls visitor(name, member) for each, by its name in scene files.
  template <class Visitor>
  void visit(Visitor&& visitor) {
    visitor("level", level);
    visitor("density", density);
    visitor("flow", flow);
    visitor("volume", volume);
    visitor("joints", joints);
  }
};

/// Lifts and drags one tree's colliders by their share that is under water. Streaming water may give energy.
template <class T>
class Buoyancy final : public Effect<T> {
 public:
  using Settings = BuoyancySettings;  ///< what can be set
  /// Without a check: attach() refuses what cannot be meant.
  explicit Buoyancy(const Settings& s) : settings(s) {}

  Status attach(const Skeleton& skeleton, const Tree<T>& tree) override;
  int instances() const override { return static_cast<int>(spots_.size()); }
  void begin_step(const EffectPose<T>& start) override;
  double add_gradient(const EffectPose<T>& pose, const Wrenches<T>& out) const override;
  void add_curvature(const EffectPose<T>& pose, const Curvature<T>& out) const override;
  void add_load(const EffectPose<T>& pose, const Motion<T>& motion, const Wrenches<T>& out) const override;
  std::size_t bytes() const override;

  Settings settings;  ///< level and flow may change between steps

 private:
  /// A spot in the water during one step.
  struct Floating {
    T level = T(0);   ///< from the common origin, m
    T radius = T(1);  ///< half of its height, m
    T weight = T(0);  ///< of the water that it displaces when it is under, N
    Drag<T> drag;     ///< by as much as was under water when the step began
  };
  Floating floating(const FlowSpot<T>& spot, const EffectPose<T>& pose) const;

  std::vector<FlowSpot<T>> spots_;
  std::vector<Floating> in_step_;  ///< [spot]
};

extern template class Buoyancy<float>;
extern template class Buoyancy<double>;

}  // namespace sinew
