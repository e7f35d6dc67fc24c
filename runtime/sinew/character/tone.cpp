#include "sinew/character/tone.h"

#include <algorithm>
#include <cmath>

#include "sinew/character/way_back.h"

namespace sinew {
namespace {

constexpr double kGivesWay = 0.5;  ///< N·m of a human, off what the animation asks for by itself
constexpr double kOfTorque = 5;    ///< 1/rad: what holds a load is that stiff at least
constexpr double kAround = 2.5;    ///< rad: from there on an offset may turn into its opposite in a step

/// rad; rotation vector or angle of a joint's offset.
template <class T>
T turn_of(const CharacterState<T>& s, int joint) {
  T squares = T(0);
  for (int k = 0; k < s.tree.dof_count(joint); ++k)
    squares += s.deviation[joint].offset[k] * s.deviation[joint].offset[k];
  return std::sqrt(squares);
}

/// N·m/rad and N·m·s/rad of one muscle for a step of h seconds; what damps beyond what the step does.
template <class T>
void choose_slope(ToneOfDof<T>& tone, T limit, T steepest, T start, bool around, T h) {
  const T stiffness = std::max(tone.stiffness, T(kOfTorque) * std::min(std::abs(tone.feed_forward), limit));
  const T damping = 2 * tone.damping_ratio * std::sqrt(stiffness * std::max(tone.inertia, T(0)));
  const T damps = around ? T(0) : std::max(damping / h - stiffness / 2, T(0));
  tone.slope = std::min(stiffness + damps, steepest);
  tone.neutral = (tone.feed_forward + damps * start) / tone.slope;
}

/// An ellipsoid's slopes are as the squares of its half axes; as steep on average as was asked for.
template <class T>
void share_slopes(JointLaw<T>& law, int first) {
  T slopes = T(0), squares = T(0);
  for (int dof = first; dof < first + 3; ++dof) {
    const T longer = std::max(law.torque_minus[dof], law.torque_plus[dof]);
    slopes += law.tone[dof].slope;
    squares += longer * longer;
  }
  for (int dof = first; dof < first + 3; ++dof) {
    ToneOfDof<T>& tone = law.tone[dof];
    const T pull = tone.slope * tone.neutral, longer = std::max(law.torque_minus[dof], law.torque_plus[dof]),
            side = on_side(pull, law.torque_minus[dof], law.torque_plus[dof]);
    tone.slope = slopes / squares * longer * longer;
    tone.neutral = side > T(0) ? pull / (slopes / squares * side * side) : T(0);
  }
}

}  // namespace

template <class T>
void keep_feed_forward(CharacterState<T>& s) {
  for (int dof = 0; dof < s.tree.dofs; ++dof) s.problem.law.tone[dof].feed_forward = s.problem.gradient[dof];
}

template <class T>
void choose_tone(CharacterState<T>& s, T h) {
  TreeProblem<T>& p = s.problem;
  JointLaw<T>& law = p.law;
  if (!law.present.tone || s.only_falls()) return;
  sum_subtrees(s);
  for (int i = 0; i < s.tree.bodies; ++i) {
    const bool around = turn_of(s, i) > T(kAround);
    for (int k = 0; k < s.tree.dof_count(i); ++k) {
      const int dof = s.tree.first_dof[i] + k;
      if (!law.has_tone(dof)) continue;
      law.tone[dof].inertia = inertia_of(p, i, dof);
      const T limit = law.limit(dof, law.tone[dof].feed_forward);
      const T steepest = std::max(law.torque_minus[dof], law.torque_plus[dof]) / p.kink_width;
      choose_slope(law.tone[dof], limit, steepest, s.deviation[i].offset[k], around, h);
    }
    if (law.ellipsoidal[i] && s.joint_has_tone(i)) share_slopes(law, s.tree.first_dof[i]);
  }
}

template <class T>
T tone_load(const CharacterState<T>& s, int joint, std::span<const T> torque) {
  const JointLaw<T>& law = s.problem.law;
  T most = T(0);
  for (int dof = s.tree.first_dof[joint]; dof < s.tree.first_dof[joint + 1]; ++dof)
    if (law.has_tone(dof)) most = std::max(most, std::abs(torque[dof] - law.tone[dof].feed_forward));
  return most / (T(kGivesWay) * s.tree.scale.load);
}

template <class T>
bool overloads_tone(const CharacterState<T>& s, std::span<const T> torque, T most) {
  for (int i = 0; i < s.tree.bodies; ++i)
    if (tone_load(s, i, torque) > most) return true;
  return false;
}

SINEW_TONE_INSTANCES(template, float)
SINEW_TONE_INSTANCES(template, double)

}  // namespace sinew
