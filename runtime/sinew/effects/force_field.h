// A pull towards a place, or a blast away from it: acceleration of every body that falls off with distance.
//
// The potential is mass·a·s·(√(1 + d²/s²) − 1) within reach s of the centre and beyond: the acceleration
// grows linearly over the first `reach` metres and is `acceleration` far away. Attraction is convex; a blast
// is not, and goes into the step without second derivative.
#pragma once

#include "sinew/effects/effect.h"

namespace sinew {

/// The field. attach() refuses numbers that are not finite, and a reach that is not above 0.
struct ForceFieldSettings {
  Vec3<double> center = Vec3<double>::Zero();  ///< m, world
  double acceleration = 0;                     ///< m/s² towards the centre; negative: away from it
  double reach = 1;                            ///< m
  std::vector<std::string> joints;             ///< whose bodies feel it; none named: all

  /// Calls visitor(name, member) for each, by its name in scene files.
  template <class Visitor>
  void visit(Visitor&& visitor) {
    visitor("center", center);
    visitor("acceleration", acceleration);
    visitor("reach", reach);
    visitor("joints", joints);
  }
};

/// Pulls one tree's bodies at their centres of mass, by the same acceleration whatever their mass.
template <class T>
class ForceField final : public Effect<T> {
 public:
  using Settings = ForceFieldSettings;  ///< what can be set
  /// Without a check: attach() refuses what cannot be meant.
  explicit ForceField(const Settings& s) : settings(s) {}

  Status attach(const Skeleton& skeleton, const Tree<T>& tree) override;
  int instances() const override { return static_cast<int>(bodies_.size()); }
  double add_gradient(const EffectPose<T>& pose, const Wrenches<T>& out) const override;
  void add_curvature(const EffectPose<T>& pose, const Curvature<T>& out) const override;
  void add_load(const EffectPose<T>& pose, const Motion<T>& motion, const Wrenches<T>& out) const override;
  std::size_t bytes() const override { return sizeof *this + bodies_.capacity() * sizeof(int); }

  Settings settings;  ///< centre, acceleration and reach may change between steps

 private:
  /// A body against the centre: offset by the reach, and the root in the potential.
  struct Place {
    Vec3<T> offset;
    T root;
  };
  Place place(const EffectPose<T>& pose, int body) const;

  std::vector<int> bodies_;
};

extern template class ForceField<float>;
extern template class ForceField<double>;

}  // namespace sinew
