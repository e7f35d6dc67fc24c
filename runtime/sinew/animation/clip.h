// Clips as uniform B-splines, and the poses and jets that sampling them gives.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sinew/animation/clip_event.h"
#include "sinew/skeleton/status.h"
#include "sinew/skeleton/transform.h"

namespace sinew {

/// One joint's local motion at an instant: pose, velocity and acceleration of the child frame relative to its
/// parent. Rotation derivatives are in child axes, translation derivatives in parent axes.
template <class T>
struct JointJet {
  Quat<T> rotation = Quat<T>::Identity();  ///< unit, child axes → parent axes
  Vec3<T> omega = Vec3<T>::Zero();         ///< rad/s, child axes
  Vec3<T> alpha = Vec3<T>::Zero();         ///< rad/s², child axes
  Vec3<T> translation = Vec3<T>::Zero();   ///< m
  Vec3<T> velocity = Vec3<T>::Zero();      ///< m/s
  Vec3<T> acceleration = Vec3<T>::Zero();  ///< m/s²
};

/// A span of time in which a joint is meant to rest on the ground (seconds, clip time). Of a loop it may run
/// over the seam: `end` is beyond the duration then.
struct ContactWindow {
  int joint = 0;    ///< of the skeleton
  float begin = 0;  ///< s
  float end = 0;    ///< s, ≥ begin
};

/// A phase of a cycle and the clip time at which it is reached (see PhaseMap).
struct PhaseMarker {
  double phase = 0;  ///< cycles
  double time = 0;   ///< s
};

/// A number that clips may move, and what it is where they do not. The slots of one asset are the same for
/// all its clips.
struct CurveSlot {
  std::string name;  ///< unique in its asset
  float rest = 0;    ///< in the unit that the game gives it
};

/// One such number over a clip: a uniform cubic B-spline, C². Between its least and its greatest control.
struct FloatCurve {
  int slot = 0;                 ///< of the asset
  float knot_interval = 0;      ///< s
  std::vector<float> controls;  ///< one a knot where the clip loops; else 3 more
};

/// Uniform B-spline curves for all joints of one skeleton, and what else a clip says.
///
/// Each animated joint has a rotation track: control points are sign-aligned quaternions in R⁴ (x, y, z, w),
/// normalised after evaluation; and, where the joint moves relative to its parent, a translation track.
/// Tracks are grouped by (degree, knot spacing) so that basis weights are evaluated once per group. Joints
/// without a track keep the constant given here. Random access is O(1).
struct Clip {
  /// Whose curve it is.
  struct Track {
    int joint = 0;  ///< < joint_count
  };
  /// How the controls of one track follow from whole numbers, which is what asset files hold
  /// (clip_packing.h). Samplers do not look at it.
  struct Packing {
    std::uint8_t step = 0;          ///< index of what the numbers are multiples of, see packing_step()
    std::uint8_t components = 3;    ///< of a rotation: 3 beside the reference, or 4 without it; else 3
    std::int8_t reference[4] = {};  ///< x y z w of a rotation with 3 components; its length means nothing
  };
  /// Tracks of one kind, one degree and one knot spacing.
  struct Group {
    bool rotation = true;         ///< quaternion tracks (4 floats) or translation tracks (3 floats)
    int degree = 3;               ///< 3 (C²) or 5 (C⁴)
    float knot_interval = 0;      ///< s
    int control_count = 0;        ///< per track; periodic clips wrap, others hold `degree` extra at the ends
    std::vector<Track> tracks;    ///< in the order of `controls` and `packings`
    std::vector<float> controls;  ///< [knot][track][component]
    std::vector<Packing> packings;  ///< [track], or none: files hold the controls as they are
  };
  std::string name;                             ///< what Asset::find_clip() looks for
  float duration = 0;                           ///< s
  bool loops = false;                           ///< periodic knots: the seam is as smooth as the rest
  int joint_count = 0;                          ///< of the skeleton
  std::vector<Transform<float>> constants;      ///< [joint_count] local transforms of joints without a track
  std::vector<Group> groups;                    ///< those of like knots side by side share basis weights
  std::vector<ContactWindow> contacts;          ///< of any joints, in any order
  std::vector<FloatCurve> curves;               ///< by rising slot, at most one each (CurveJob)
  std::vector<ClipEvent> events;                ///< by rising begin (EventJob)
  std::vector<PhaseMarker> markers;             ///< as fit_phase_map() takes them, or none
  int cycles = 1;                               ///< that the markers count
  Vec3<float> root_step = Vec3<float>::Zero();  ///< what one loop adds to the root's translation (m), Z up
};

/// What is at fault, if anything: sizes, NaN, zero knot intervals, joints out of range, events outside.
/// `Status::index`: group, curve, event or marker.
Status validate(const Clip& clip);

}  // namespace sinew
