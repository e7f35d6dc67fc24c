// How a body that lies gets up: from where it lies into the nearest pose of a get-up clip, and up by it.
// Internal to behaviours.
//
// *Gather*: the joints go from where they are to that pose, C², while their strength comes back; the root has
// nothing but the ground. *Rise*: the clip is played from there with a rate that waits where the body is
// behind, r = clamp(1.5 − e/0.08 m, 0, 1), e how far the body is from the clip's pose wherever that stands
// and faces (Tao et al., "Learning to get up", 2022, wait in poses that bear, too); the root is grounded.
//
// On a slope the clip's ground is the plane that bears the body, so that hands, knees and feet find it. As
// the centre of mass comes over the feet the body leans back to the vertical about its ankles, by w of the
// slope, w from 0 (40 cm off them) to 1 (15 cm), C²; legs reach for the feet where they were.
#pragma once

#include <vector>

#include "sinew/animation/inertialize_job.h"
#include "sinew/behaviour/behaviour_settings.h"
#include "sinew/behaviour/get_up_clips.h"
#include "sinew/behaviour/stance.h"
#include "sinew/character/world.h"

namespace sinew {

class ByteStream;

/// How far an attempt to get up has come in a frame. The three that are failures leave their clip out of the
/// next choice (GetUp::forget).
enum class GetUpOutcome : std::uint8_t {
  kGathers,  ///< on its way into the pose to rise from, or rolls over
  kRises,    ///< follows the clip
  kStuck,    ///< the pose to rise from was not reached
  kTooFar,   ///< it left the clip while rising
  kTooLong,  ///< waited for the body for 0.8 s, or took 7 s in all (a human's)
  kUp,       ///< the clip is nearly at its end and the body stands as it does there
};

/// One body's attempts to get up by clips. prepare() first; then begin() and update() until one is over.
template <class T>
class GetUp {
 public:
  /// Set-up. `unit`: the figure's size, of a human's; `weight`: its mass, likewise. See GetUpClips::prepare.
  void prepare(const Skeleton& skeleton, std::span<const Clip> clips, const BehaviourSettings& settings,
               double unit, double weight);
  /// Whether there is a clip to get up by.
  bool possible() const { return !clips_.empty(); }
  /// From where the body lies. `ground`: m, height of what it is to stand on, where nothing bears it now.
  /// Whether there is a way.
  bool begin(Character<T>& character, double ground);
  /// Moves on by h s, and writes what the body is to do.
  GetUpOutcome update(Character<T>& character, const StandingBody<T>& body, std::span<JointJet<T>> jets,
                      double h);
  /// Writes the pose in which its clip ends, at rest, where that was played. After begin(). O(joints).
  void stand(const StandingBody<T>& body, std::span<JointJet<T>> jets);
  /// Visits what begin() and update() remember. For Behaviour::save() and restore().
  void visit(ByteStream& stream);
  /// Forgets which clips failed.
  void forget() { tried_ = 0; }
  int variant() const { return variant_; }     ///< chosen, of GetUpClips::variants(); −1 before begin()
  double time() const { return time_.value; }  ///< s, in its clip
  double off() const { return off_; }          ///< m, from the pose that it should be in
  const GetUpClips<T>& clips() const { return clips_; }  ///< by which it may get up

 private:
  void look_at_ground(const Character<T>& character, double ground);
  void look(const Character<T>& character);
  GetUpChoice choose() const;
  bool gather_to(Character<T>& character, const GetUpChoice& choice);
  GetUpOutcome gather(Character<T>& character, std::span<JointJet<T>> jets, double h);
  bool rolls() const;
  GetUpOutcome roll(Character<T>& character, std::span<JointJet<T>> jets, double h);
  GetUpOutcome rise(const Character<T>& character, const StandingBody<T>& body, std::span<JointJet<T>> jets,
                    double h);
  void begin_rise(Character<T>& character);
  double height(const Character<T>& character) const;
  void lean(const StandingBody<T>& body, std::span<JointJet<T>> jets);
  void put(std::span<JointJet<T>> jets) const;
  GetUpOutcome fail(GetUpOutcome why);
  void move_time(double h);

  GetUpClips<T> clips_;
  BehaviourSettings settings_;
  double unit_ = 1, weight_ = 1;
  std::uint32_t tried_ = 0;  ///< variants that failed
  bool rises_ = false;
  int entry_ = -1, variant_ = -1, gathers_ = 0;
  double elapsed_ = 0, waits_ = 0, off_ = 0, strong_from_ = 0;
  double caught_ = 0;   ///< m, that it was off when it began to rise: a limb under the body, that comes free
  Displacement place_;  ///< of the clip
  double ground_ = 0;   ///< m, height of its ground at the origin
  Vec3<double> normal_ = Vec3<double>::UnitZ();  ///< of its ground; exactly up where that is level
  TimeJet<double> time_{0.0};
  double rate_change_ = 0;  ///< 1/s², how τ'' changes: that time itself is C²
  InertialState<T> fade_;
  std::vector<T> fade_numbers_;
  std::vector<JointJet<T>> lies_, pose_;   ///< [joint]
  std::vector<Transform<T>> model_;        ///< [joint]
  std::vector<MovingTransform<T>> moves_;  ///< [joint]
  std::vector<Vec3<double>> is_, wanted_;  ///< [point] m
};

extern template class GetUp<float>;
extern template class GetUp<double>;

}  // namespace sinew
