// An effect of one's own: a hand of the host, such as a mouse, that holds on to a body with a damped spring.
//
// An effect is an energy of the pose at the END of a step, with its gradient and its second derivative: so no
// stiffness makes a step unstable. runtime/sinew/effects/README.md derives what each member has to give.
#pragma once

#include <sinew/effects/effect.h>

struct GrabSettings {
  int joint = 0;                                         ///< simulated
  sinew::Vec3<double> at = sinew::Vec3<double>::Zero();  ///< m, where, joint axes
  sinew::Vec3<double> to = sinew::Vec3<double>::Zero();  ///< m, world, where it is pulled
  double stiffness = 0;                                  ///< N/m
  double damping = 0;                                    ///< N·s/m
};

/// Energy ½ k |x − to|², and the damping as the potential of a step of h, h·c/2·|(x − x₀)/h|².
template <class T>
class Grab final : public sinew::Effect<T> {
 public:
  using Vec = sinew::Vec3<T>;
  explicit Grab(const GrabSettings& s) : settings(s) {}

  sinew::Status attach(const sinew::Skeleton& skeleton, const sinew::Tree<T>&) override {
    if (settings.joint < 0 || settings.joint >= skeleton.body_count)
      return sinew::Status::error(sinew::Code::kInvalidArgument, "a grab needs a simulated joint",
                                  settings.joint);
    if (!(settings.stiffness >= 0) || !(settings.damping >= 0))
      return sinew::Status::error(sinew::Code::kInvalidArgument,
                                  "a grab needs stiffness and damping of at least 0");
    return {};
  }
  int instances() const override { return 1; }
  /// Measured once a step, when it begins.
  void begin_step(const sinew::EffectPose<T>& start) override { start_ = place(start); }
  double add_gradient(const sinew::EffectPose<T>& pose, const sinew::Wrenches<T>& out) const override {
    const Vec x = place(pose), speed = (x - start_) / pose.h;
    out.add(settings.joint, x, gradient(pose, x, speed));
    return double(T(settings.stiffness) / 2 * (x - goal(pose)).squaredNorm() +
                  pose.h * T(settings.damping) / 2 * speed.squaredNorm());
  }
  void add_curvature(const sinew::EffectPose<T>& pose, const sinew::Curvature<T>& out) const override {
    const Vec x = place(pose);
    const T change = T(settings.stiffness) + T(settings.damping) / pose.h;
    out.add(settings.joint, x, gradient(pose, x, (x - start_) / pose.h), change * sinew::Mat3<T>::Identity());
  }
  /// What the muscles of a character on its animation have to bear; decides whether anything is simulated.
  void add_load(const sinew::EffectPose<T>& pose, const sinew::Motion<T>& motion,
                const sinew::Wrenches<T>& out) const override {
    const Vec x = place(pose), arm = x - pose.kinematics.center[settings.joint];
    const Vec speed = motion.velocity[settings.joint] + motion.omega[settings.joint].cross(arm);
    out.add(settings.joint, x, gradient(pose, x, speed));
  }
  std::size_t bytes() const override { return sizeof *this; }

  GrabSettings settings;  ///< `to` and the rest but `joint` may change between steps

 private:
  Vec place(const sinew::EffectPose<T>& pose) const {
    return pose.point(settings.joint, settings.at.template cast<T>());
  }
  /// Positions in a step are relative to a common origin near the character, for the sake of their digits.
  Vec goal(const sinew::EffectPose<T>& pose) const {
    return (settings.to - pose.common_origin).template cast<T>();
  }

  Vec gradient(const sinew::EffectPose<T>& pose, const Vec& x, const Vec& speed) const {
    return T(settings.stiffness) * (x - goal(pose)) + T(settings.damping) * speed;
  }

  Vec start_ = Vec::Zero();  ///< its place when the step begins, from the common origin
};
