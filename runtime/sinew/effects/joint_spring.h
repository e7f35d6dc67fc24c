// Passive springs and dampers of joints: ligaments, clothes, a prosthesis, a tail that hangs stiffly.
//
// They pull a joint to its rest pose and resist its speed whether or not a muscle drives it: a muscle that
// holds a joint away from rest bears the spring too. A skeleton's own DofLimits::damping needs none of this.
#pragma once

#include "sinew/effects/effect.h"

namespace sinew {

/// The spring and damper of every degree of freedom. attach() refuses stiffness and damping below 0, and a
/// rest that is not finite.
struct JointSpringSettings {
  double stiffness = 10;                     ///< N·m/rad (N/m where the joint slides), ≥ 0
  double damping = 0;                        ///< N·m·s/rad (N·s/m), ≥ 0
  Vec3<double> rest = Vec3<double>::Zero();  ///< where it is relaxed: offsets from the skeleton's rest pose
                                             ///< per degree of freedom, rad (m)
  std::vector<std::string> joints;           ///< none named: all that have freedom, but not a free root

  /// Calls visitor(name, member) for each, by its name in scene files.
  template <class Visitor>
  void visit(Visitor&& visitor) {
    visitor("stiffness", stiffness);
    visitor("damping", damping);
    visitor("rest", rest);
    visitor("joints", joints);
  }
};

/// Springs of one tree's joints; one row per degree of freedom, two with damping.
template <class T>
class JointSpring final : public Effect<T> {
 public:
  using Settings = JointSpringSettings;  ///< what can be set
  /// Without a check: attach() refuses what cannot be meant.
  explicit JointSpring(const Settings& s) : settings(s) {}

  Status attach(const Skeleton& skeleton, const Tree<T>& tree) override;
  int instances() const override { return static_cast<int>(bodies_.size()); }
  void add_rows(const EffectPose<T>& pose, std::vector<JointRow<T>>& out) const override;
  int most_rows() const override { return rows_; }
  std::size_t bytes() const override { return sizeof *this + bodies_.capacity() * sizeof(int); }

  Settings settings;  ///< stiffness, damping and rest may change between steps

 private:
  std::vector<int> bodies_;
  int rows_ = 0;
};

extern template class JointSpring<float>;
extern template class JointSpring<double>;

}  // namespace sinew
