// What a scene puts into a world, and what it asks of it in every step. `sinew simulate`, videos and hard
// cases all play their scenes by it.
#pragma once

#include <memory>
#include <vector>

#include "scene/player.h"
#include "scene/scene.h"
#include "sinew/behaviour/behaviour.h"
#include "sinew/character/fade_timer.h"

namespace sinew::scene {

/// What a push does to a world point of a joint in one step.
struct Impulse {
  int character = 0, joint = 0;
  Vec3<double> point = Vec3<double>::Zero(), impulse = Vec3<double>::Zero();  ///< N·s
  bool lasts = false;  ///< a force over the step, no hit
};
/// Applies it to a step of h seconds.
template <class T>
Status apply(const Impulse& p, T h, World<T>& world) {
  Character<T> character = world.character(p.character);
  const Vec3<T> point = p.point.cast<T>(), impulse = p.impulse.cast<T>();
  return p.lasts ? character.apply_force(p.joint, point, impulse / h)
                 : character.apply_impulse(p.joint, point, impulse);
}

/// Scene and world must outlive it.
template <class T>
class Play {
 public:
  Play(const Scene& scene, World<T>& world) : s_(scene), world_(world) {}

  /// Fills the empty world and sets it to the state of time 0.
  convert::Error set_up();
  /// Before the step from `from` to `to`, s: targets, strengths, root drives, things that are thrown.
  convert::Error prepare(double from, double to);
  /// The share of every push that falls into that step; whoever steps the world applies them.
  std::vector<Impulse> pushes(double from, double to);

  /// The state in which a character started.
  const std::vector<JointJet<T>>& start(int character) const { return starts_[character]; }
  /// Of a character that keeps its balance; null where it does not.
  const Behaviour<T>* behaviour(int character) const { return behaviours_[character].get(); }
  /// rad/s²: the greatest of a joint, that the last prepare() has set as its target.
  double asked_acceleration(int character) const { return asked_[std::size_t(character)].acceleration; }
  /// [slot of its asset's curves] at that time.
  std::span<const TimeJet<T>> curves(int character) const { return players_[character].curves(); }
  bool launched(int prop) const { return launched_[static_cast<std::size_t>(prop)]; }

 private:
  /// What was last asked of a character: what changes in between is the host's.
  struct Asked {
    double strength = -1;
    std::vector<double> groups;
    std::vector<Tone> tones;  ///< of all, then of its parts
    RootDrive root = RootDrive::kKinematic;
    bool still = false;       ///< its target does not change any more
    double acceleration = 0;  ///< rad/s²
  };

  convert::Error add_all();
  convert::Error add_effects();
  convert::Error drive(int character, double t, double h);
  void set_tones(int character, double t);
  void launch(double t);
  Vec3<double> target_of(const SceneProp& prop, double t);
  void aim(const SceneProp& prop, double t, Vec3<double>& from, Vec3<double>& velocity);

  const Scene& s_;
  World<T>& world_;
  // Of the character that is driven, [joint]:
  std::vector<T> loads_;
  std::vector<JointJet<T>> body_;
  std::vector<Player<T>> players_;
  std::vector<std::unique_ptr<FadeTimer<T>>> timers_;      ///< [character] null: has no graph
  std::vector<std::unique_ptr<Behaviour<T>>> behaviours_;  ///< [character] null: has none
  std::vector<JointJet<T>> jets_;  ///< [joint] of the character that is driven, as its behaviour wants it
  std::vector<Asked> asked_;
  std::vector<std::vector<JointJet<T>>> starts_;  ///< [character]
  std::vector<bool> launched_;
};

extern template class Play<float>;
extern template class Play<double>;

}  // namespace sinew::scene
