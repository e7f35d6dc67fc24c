// What a body does while it falls: arms reach for the ground, head and trunk keep away from it. Internal to
// behaviours.
//
// People's hands are there before their pelvis in nearly all falls (Hsiao and Robinovitch 1998), half a
// second after they lost their balance, elbows a little bent, and give under the body. So arms go to where
// the shoulders come down, a little further in the direction of the fall; chin to the chest of who falls
// backwards, and up of who falls on his face. What touches the ground lets go over half a second.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sinew/behaviour/behaviour_settings.h"
#include "sinew/behaviour/stance.h"
#include "sinew/character/world.h"
#include "sinew/effects/contact.h"

namespace sinew {

class ByteStream;

/// A body that falls, world.
struct FallingBody {
  MassMotion mass;                               ///< of the whole body
  Vec3<double> spin = Vec3<double>::Zero();      ///< rad/s, of the root
  Vec3<double> forward = Vec3<double>::UnitX();  ///< of the body
  Vec2 feet = Vec2::Zero();                      ///< m, between its feet
  double ground = 0;                             ///< m, height
};

/// Of one body; prepare() first, and begin() for each fall.
template <class T>
class ProtectiveReach {
 public:
  /// Set-up: finds arms, neck and trunk by their roles; what has none lets go at once. `unit`: the figure's
  /// size, of a human's.
  void prepare(const Skeleton& skeleton, const BehaviourSettings& settings, double unit);
  /// A new fall.
  void begin();
  /// Whether something has not let go yet.
  bool acts() const;
  /// Moves what was asked of the joints on by h s, and gives muscles as much of their strength as they need
  /// for it. While it acts.
  void update(Character<T>& character, const FallingBody& body, std::span<JointJet<T>> jets, double h);
  /// Visits what begin() and update() remember. For Behaviour::save() and restore().
  void visit(ByteStream& stream);

 private:
  struct Arm {
    int upper = -1, forearm = -1, hand = -1;  ///< joints; upper −1: there is none
    double length = 0;                        ///< m, straight
    Vec3<T> elbow = Vec3<T>::Zero();          ///< to which it points, axes of what carries the arm
    Vec3<T> hinge = Vec3<T>::Zero();          ///< see TwoBoneJob
    Quat<T> bent = Quat<T>::Identity();       ///< of the forearm in its parent, a little
  };
  enum class Part : std::uint8_t { kLeg, kTrunk, kNeck, kArm };

  bool possible() const { return arms_[0].upper >= 0 && arms_[1].upper >= 0 && settings_.reach_strength > 0; }
  bool touches(std::span<const Transform<T>> model, double ground) const;
  void take_pose(const Character<T>& character, const FallingBody& body, std::span<const JointJet<T>> asked);
  bool reach(const Arm& arm, std::span<const Transform<T>> model, const FallingBody& body, const Vec2& way);
  Vec2 way_of_fall(const FallingBody& body, std::span<const Transform<T>> model) const;
  void nod(double angle);
  void follow(std::span<JointJet<T>> jets, double h) const;
  double share_of(Part part) const;

  BehaviourSettings settings_;
  double unit_ = 1;
  std::array<Arm, 2> arms_;             ///< left, right
  std::vector<ContactPoint<T>> palms_;  ///< where forearms and hands may touch the ground
  std::vector<int> parents_;            ///< [joint]
  std::vector<Part> part_;              ///< [joint]
  std::vector<Quat<T>> rest_;           ///< [joint] in its parent
  std::vector<Vec3<T>> leftwards_;      ///< [joint] the body's left at rest, joint axes
  std::vector<int> neck_;               ///< joints
  std::vector<JointJet<T>> pose_;       ///< [joint] room: what is wanted
  std::vector<T> activation_;           ///< [joint] room
  double time_ = 0;                     ///< s, since it fell
  double touched_ = -1;                 ///< s, since a hand or forearm touched the ground; negative: none has
};

extern template class ProtectiveReach<float>;
extern template class ProtectiveReach<double>;

}  // namespace sinew
