// A clip's pose with the body moved over feet that stand elsewhere. Internal to behaviours.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sinew/animation/foot_leg.h"
#include "sinew/animation/moving_transform.h"
#include "sinew/behaviour/sole.h"

namespace sinew {

/// Centre of mass, and how it moves where that is asked for.
struct MassMotion {
  Vec3<double> place = Vec3<double>::Zero();         ///< m
  Vec3<double> velocity = Vec3<double>::Zero();      ///< m/s
  Vec3<double> acceleration = Vec3<double>::Zero();  ///< m/s²
};

/// How far a foot may turn about its ankle: a cone, see Joint::swing_limit.
template <class T>
struct Ankle {
  Quat<T> rest = Quat<T>::Identity();
  Vec3<T> axis = Vec3<T>::UnitZ();  ///< foot axes
  T most = T(-1);                   ///< rad; negative: as far as anybody likes
};

/// Where a foot may touch the ground.
template <class T>
struct SolePoint {
  int joint = 0;                      ///< of the foot, or of its toes
  Vec3<T> local = Vec3<T>::Zero();    ///< m, joint axes
  Vec3<T> on_foot = Vec3<T>::Zero();  ///< m, foot axes, toes straight as at rest
};

/// The body that stands: what is asked of a skeleton once.
template <class T>
struct StandingBody {
  std::vector<int> parents;                        ///< [joint]
  std::vector<T> mass;                             ///< [joint] share of the whole
  std::vector<Vec3<T>> center_of_mass;             ///< [joint] m, joint axes
  std::array<FootLeg<T>, 2> legs;                  ///< left, right
  std::array<Ankle<T>, 2> ankles;                  ///< how far its feet turn
  std::array<std::vector<SolePoint<T>>, 2> soles;  ///< those that are lowest at rest
  std::array<std::vector<SolePoint<T>>, 2> tips;   ///< those of them with which toes end
  std::array<double, 2> leg_length;                ///< m, hip to ankle, straight
  std::array<Vec3<double>, 2> sole_up;             ///< foot axes: upwards while the foot stands flat
  double total_mass = 0;                           ///< kg
  double height = 0;                               ///< m, of the root's origin at rest over the soles

  /// Set-up, once. Refuses a body without mass or roles of feet, and a foot without colliders.
  Status find(const Skeleton& skeleton);
  /// Of a pose in model space (joint → world); the velocity is 0.
  MassMotion mass_of(std::span<const Transform<T>> model) const;
  /// Of a motion. `model` is room for the joints.
  MassMotion mass_of(std::span<const JointJet<T>> jets, std::span<MovingTransform<T>> model) const;
  /// Adds a foot at a place, m, to what may be pressed on.
  void add_sole(int foot, const Transform<double>& place, Sole& sole) const;
  /// m: height of the lowest point of a foot at a place, its toes straight.
  double lowest_of(std::size_t foot, const Transform<double>& place) const;
  /// The same of a pose in model space, its toes bent as they are there.
  double lowest_of(std::size_t foot, std::span<const Transform<T>> model) const;
  /// Likewise.
  double lowest_of(std::size_t foot, std::span<const MovingTransform<T>> model) const;

 private:
  template <class U, class Place>
  double lowest(std::size_t foot, const Place& place_of) const;
};

/// In another precision.
template <class To, class From>
MovingVector<To> cast_motion(const MovingVector<From>& v) {
  const auto of = [](const TimeJet<From>& x) {
    return TimeJet<To>(static_cast<To>(x.value), static_cast<To>(x.rate), static_cast<To>(x.acceleration));
  };
  return {of(v.x()), of(v.y()), of(v.z())};
}

/// A turn by a vector, rad: of little more than a third of a radian less by a hundredth.
template <class T>
MovingRotation<T> turned_by(const MovingVector<T>& turn) {
  const MovingVector<T> half = turn * TimeJet<T>(T(0.5));
  return moving_rotation(Quat<TimeJet<T>>(TimeJet<T>(T(1)), half.x(), half.y(), half.z()));
}

/// What a stance asks for at an instant.
struct Stance {
  Vec2 body = Vec2::Zero();               ///< m, of the centre of mass
  Vec2 body_velocity = Vec2::Zero();      ///< m/s
  Vec2 body_acceleration = Vec2::Zero();  ///< m/s²
  TimeJet<double> height{0.0};            ///< m, of the root over the clip's
  MovingVector<double> turn =
      still<double>(Vec3<double>::Zero());    ///< rad, of the root from the clip's, world axes
  std::array<MovingVector<double>, 2> ankle;  ///< m
  std::array<Quat<double>, 2> foot;           ///< foot → world
};

/// Bends the clip's motion to a stance: moves the root until the centre of mass is there, and the legs by
/// TwoBoneJob. `model` is room for the joints. O(joints).
template <class T>
void take_stance(const StandingBody<T>& body, const Stance& stance, std::span<JointJet<T>> jets,
                 std::span<MovingTransform<T>> model);

/// Bends the clip's motion to feet that go elsewhere: the root moves by `shift` (m) and turns by `turn` (rad,
/// world axes) from the clip's, legs reach for their feet. O(joints).
template <class T>
void take_feet(const StandingBody<T>& body, const MovingVector<double>& shift,
               const MovingVector<double>& turn, const std::array<MovingTransform<T>, 2>& feet,
               std::span<JointJet<T>> jets);

/// Lifts feet by as much as their soles are below a ground (m), then bends toes up that still are. C².
template <class T>
void lift_soles(const StandingBody<T>& body, T ground, std::span<JointJet<T>> jets);

extern template struct StandingBody<float>;
extern template struct StandingBody<double>;
/// @cond
extern template void take_stance<float>(const StandingBody<float>&, const Stance&, std::span<JointJet<float>>,
                                        std::span<MovingTransform<float>>);
extern template void take_stance<double>(const StandingBody<double>&, const Stance&,
                                         std::span<JointJet<double>>, std::span<MovingTransform<double>>);
extern template void take_feet<float>(const StandingBody<float>&, const MovingVector<double>&,
                                      const MovingVector<double>&,
                                      const std::array<MovingTransform<float>, 2>&,
                                      std::span<JointJet<float>>);
extern template void take_feet<double>(const StandingBody<double>&, const MovingVector<double>&,
                                       const MovingVector<double>&,
                                       const std::array<MovingTransform<double>, 2>&,
                                       std::span<JointJet<double>>);
extern template void lift_soles<float>(const StandingBody<float>&, float, std::span<JointJet<float>>);
extern template void lift_soles<double>(const StandingBody<double>&, double, std::span<JointJet<double>>);
/// @endcond

}  // namespace sinew
