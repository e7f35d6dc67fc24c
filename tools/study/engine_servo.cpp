#include "study/engine_servo.h"

#include <cmath>

#include "sinew/skeleton/rotation.h"

namespace sinew::study {

Vec3<double> Servo::rate(int joint, const Quat<double>& now, double h) {
  const double time = Accuracy{}.return_time;
  const Vec3<double> offset = rotation_log<double>(before_[joint].rotation.conjugate() * now),
                     speed = (offset - offset_[joint]) / h;
  offset_[joint] = offset;
  const Vec3<double> left = (offset + (speed + offset / time) * h) * std::exp(-h / time);
  const Quat<double> there = wanted_[joint].rotation * rotation_exp<double>(left);
  return rotation_log<double>(now.conjugate() * there) / h;
}

Servo::Travel Servo::travel(const Transform<double>& now, double h) const {
  return {rotation_log<double>(now.rotation.conjugate() * wanted_[0].rotation) / h,
          (wanted_[0].translation - now.translation) / h};
}

Motor motor_of(const Joint& joint) {
  Motor motor{Vec3<double>::Zero(), Vec3<double>::Zero()};
  for (int k = 0; k < dof_count(joint.type); ++k) {
    motor.bias[k] = (joint.dofs[k].torque_plus - joint.dofs[k].torque_minus) / 2;
    motor.most[k] = (joint.dofs[k].torque_plus + joint.dofs[k].torque_minus) / 2;
  }
  return motor;
}

}  // namespace sinew::study
