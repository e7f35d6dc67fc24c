#include "sinew/character/tone.h"

#include <algorithm>
#include <cmath>

#include "sinew/character/return_to_animation.h"

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

/// N·m/rad, by which the weight of what each toned joint carries topples the chain that it is in: at most so
/// much of every joint's own share, its parents' and its children's. After sum_subtrees(), into `neutral` of
/// each joint's first degree of freedom.
template <class T>
void weigh(CharacterState<T>& s, const Vec3<T>& gravity) {
  TreeProblem<T>& p = s.problem;
  const auto sum = [&](int joint) -> T& { return p.law.tone[s.tree.first_dof[joint]].neutral; };
  for (int i = 0; i < s.tree.bodies; ++i)
    if (s.joint_has_tone(i)) sum(i) = T(0);
  for (int i = 0; i < s.tree.bodies; ++i) {
    const Composite<T>& carried = p.composite[i];
    const T topples = -gravity.dot(Vec3<T>(carried.first - carried.mass * p.kinematics.origin[i]));
    if (!(topples > T(0)) || !s.joint_has_tone(i)) continue;
    sum(i) += topples;
    for (int j = s.tree.parent[i]; j >= 0; j = s.tree.parent[j]) {
      if (!s.joint_has_tone(j)) continue;
      sum(i) += topples;
      sum(j) += topples;
    }
  }
}

/// Stiffness (N·m/rad) of every toned muscle, and the inertia that it moves, into `slope` and `inertia`.
template <class T>
void choose_stiffness(CharacterState<T>& s, const Vec3<T>& gravity) {
  TreeProblem<T>& p = s.problem;
  const T weight = gravity.squaredNorm();
  for (int i = 0; i < s.tree.bodies; ++i) {
    const T topples = s.joint_has_tone(i) ? p.law.tone[s.tree.first_dof[i]].neutral : T(0);
    for (int dof = s.tree.first_dof[i]; dof < s.tree.first_dof[i + 1]; ++dof) {
      if (!p.law.has_tone(dof)) continue;
      ToneOfDof<T>& tone = p.law.tone[dof];
      const T load = std::min(std::abs(tone.asked), p.law.limit(dof, tone.asked));
      const T upright = weight > T(0) ? p.kinematics.w[dof].dot(gravity) : T(0);  // nothing topples about it
      const T level = weight > T(0) ? T(1) - upright * upright / weight : T(1);
      tone.inertia = inertia_of(p, i, dof);
      tone.slope = std::max(tone.stiffness, T(kOfTorque) * load) + level * topples;
    }
  }
}

/// In a chain of n alike joints the whole gives way with a stiffness of k/n, and would be damped by a ratio
/// of ζ/√n: n, into `neutral` of each joint's first degree of freedom. Of one chain are those that carry much
/// the same; stiffer ones count less.
template <class T>
void measure_chains(CharacterState<T>& s) {
  constexpr T kSame = T(0.5);  // of the mass
  const auto first = [&](int joint) -> ToneOfDof<T>& { return s.problem.law.tone[s.tree.first_dof[joint]]; };
  for (int i = 0; i < s.tree.bodies; ++i)
    if (s.joint_has_tone(i)) first(i).neutral = T(1);
  for (int i = 0; i < s.tree.bodies; ++i) {
    if (!s.joint_has_tone(i)) continue;
    for (int j = s.tree.parent[i]; j >= 0; j = s.tree.parent[j]) {
      if (s.problem.composite[i].mass < kSame * s.problem.composite[j].mass) break;
      if (!s.joint_has_tone(j)) continue;
      first(i).neutral += std::min(first(i).slope / first(j).slope, T(1));
      first(j).neutral += std::min(first(j).slope / first(i).slope, T(1));
    }
  }
}

/// κ and s* of one muscle for a step of h seconds, from its stiffness in `slope`; damped beyond what the step
/// does by itself.
template <class T>
void choose_slope(ToneOfDof<T>& tone, T chain, T steepest, T start, bool around, T h) {
  const T stiffness = tone.slope;
  const T damping = 2 * tone.damping_ratio * std::sqrt(stiffness * chain * std::max(tone.inertia, T(0)));
  const T damps = around ? T(0) : std::max(damping / h - stiffness / 2, T(0));
  tone.slope = std::min(stiffness + damps, steepest);
  tone.neutral = (tone.asked + damps * start) / tone.slope;
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
void reserve_for_tone(CharacterState<T>& s) {
  JointLaw<T>& law = s.problem.law;
  if (law.present.muscles || !s.skeleton.muscles.empty()) law.tone.resize(s.tree.dofs);
}

template <class T>
void keep_feed_forward(CharacterState<T>& s, T ToneOfDof<T>::*into) {
  for (int dof = 0; dof < s.tree.dofs; ++dof) s.problem.law.tone[dof].*into = s.problem.gradient[dof];
}

namespace {

/// What the animation asks for in a part, on average, and its joints lose on its own way.
template <class T>
void choose_asked(CharacterState<T>& s, T h, const PartOfFrame<T>& part) {
  TreeProblem<T>& p = s.problem;
  const T middle = (part.begin + part.end) / 2;
  for (int i = 0; i < s.tree.bodies; ++i) {
    if (!s.joint_has_tone(i)) continue;
    for (int dof = s.tree.first_dof[i]; dof < s.tree.first_dof[i + 1]; ++dof) {
      ToneOfDof<T>& tone = p.law.tone[dof];
      tone.asked = tone.before + middle * (tone.feed_forward - tone.before);
    }
    if (!part.losses || !p.law.present.losses) continue;
    const JointJet<T> begins = animation_within<T>(s.last_target()[i], s.target[i], part.frame, part.begin);
    const Transform<T> from{begins.rotation, begins.translation};
    const JointStep<T> joint{.tree = s.tree,
                             .law = p.law,
                             .body = i,
                             .local = s.wanted[i],
                             .target = s.wanted[i],
                             .start = from,
                             .h = h,
                             .kink_width = p.kink_width};
    JointOffset<T> way;
    p.clear_rows();
    if (!part.losses->look(joint, way, p)) continue;
    for (int k = 0; k < joint.dofs(); ++k) part.losses->append(joint, way, k, p);
    for (const JointRow<T>& row : p.rows)
      for (int a = 0; a < row.count; ++a)
        p.law.tone[row.dof + a].asked += row.slope(row.value) * row.gradient[a];
  }
  p.clear_rows();
}

}  // namespace

template <class T>
void choose_tone(CharacterState<T>& s, const Vec3<T>& gravity, T h, const PartOfFrame<T>& part) {
  TreeProblem<T>& p = s.problem;
  JointLaw<T>& law = p.law;
  if (!law.present.tone || s.only_falls()) return;
  choose_asked(s, h, part);
  sum_subtrees(s);
  weigh(s, gravity);
  choose_stiffness(s, gravity);
  measure_chains(s);
  for (int i = 0; i < s.tree.bodies; ++i) {
    const bool around = turn_of(s, i) > T(kAround);
    const T chain = s.joint_has_tone(i) ? law.tone[s.tree.first_dof[i]].neutral : T(1);
    for (int k = 0; k < s.tree.dof_count(i); ++k) {
      const int dof = s.tree.first_dof[i] + k;
      if (!law.has_tone(dof)) continue;
      const T steepest = std::max(law.torque_minus[dof], law.torque_plus[dof]) / p.kink_width;
      choose_slope(law.tone[dof], chain, steepest, s.deviation[i].offset[k], around, h);
    }
    if (law.ellipsoidal[i] && s.joint_has_tone(i)) share_slopes(law, s.tree.first_dof[i]);
  }
}

template <class T>
T tone_load(const CharacterState<T>& s, int joint, std::span<const T> torque, T ToneOfDof<T>::*own) {
  const JointLaw<T>& law = s.problem.law;
  T most = T(0);
  for (int dof = s.tree.first_dof[joint]; dof < s.tree.first_dof[joint + 1]; ++dof)
    if (law.has_tone(dof)) most = std::max(most, std::abs(torque[dof] - law.tone[dof].*own));
  return most / (T(kGivesWay) * s.tree.scale.load);
}

template <class T>
bool overloads_tone(const CharacterState<T>& s, std::span<const T> torque, T most) {
  for (int i = 0; i < s.tree.bodies; ++i)
    if (tone_load(s, i, torque, &ToneOfDof<T>::feed_forward) > most) return true;
  return false;
}

SINEW_TONE_INSTANCES(template, float)
SINEW_TONE_INSTANCES(template, double)

}  // namespace sinew
