#include "sinew/character/unknowns.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sinew/character/tone.h"
#include "sinew/optimizer/bossak.h"

namespace sinew {
namespace {

/// By which torques in the potential of a step of h seconds are larger than those that act.
template <class T>
T emphasis_of(const TreeProblem<T>& p, T h) {
  return p.prediction.other ? T(1) : constant_emphasis(p.prediction.weight, h);
}

}  // namespace

template <class T>
void choose_unknowns(CharacterState<T>& s) {
  const bool solves = s.levels.allowed >= Level::kPartial;
  for (int i = 0; i < s.tree.bodies; ++i) {
    const int first = s.tree.first_dof[i], count = s.tree.dof_count(i);
    const bool root = s.tree.type[i] == JointType::kFree && s.tree.parent[i] < 0;
    const bool free = s.joint_gives_way(i) && !(root && s.root_is_kinematic());
    const bool given = !solves || s.baked[i];
    for (int dof = first; dof < first + count; ++dof) s.problem.free[dof] = free && !given;
  }
}

template <class T>
bool release_overloaded(CharacterState<T>& s, std::span<const std::uint8_t> bears, T h) {
  if (s.levels.allowed < Level::kPartial) return false;
  const T emphasis = emphasis_of(s.problem, h);
  bool any = false;
  for (int i = 0; i < s.tree.bodies; ++i) {
    const int first = s.tree.first_dof[i], count = s.tree.dof_count(i);
    if (count == 0 || s.problem.free[first] || s.baked[i]) continue;
    if (s.root_is_kinematic() && s.tree.type[i] == JointType::kFree && s.tree.parent[i] < 0) continue;
    for (int dof = first; dof < first + count; ++dof) s.torque[dof] = s.problem.gradient[dof] / emphasis;
    T load = T(0);
    for (int dof = first; dof < first + count; ++dof)
      load = std::max(load, s.problem.law.load(s.tree, i, dof, s.torque));
    const bool gives_way =
        s.joint_has_tone(i) && !bears[i] && tone_load<T>(s, i, s.torque, &ToneOfDof<T>::asked) > T(1);
    if (load <= T(1) && !gives_way) continue;
    for (int dof = first; dof < first + count; ++dof) s.problem.free[dof] = 1;
    any = true;
  }
  return any;
}

template <class T>
void first_guess(CharacterState<T>& s, T h, T share) {
  for (int i = 0; i < s.tree.bodies; ++i) {
    const int first = s.tree.first_dof[i], count = s.tree.dof_count(i);
    TreeProblem<T>& p = s.problem;
    const Transform<T>& wanted = s.wanted[i];
    bool to_target = count == 0 || !p.free[first];
    if (!to_target) {
      T load = T(0);
      for (int dof = first; dof < first + count; ++dof) load = std::max(load, s.load[dof]);
      to_target = s.joint_is_driven(i) && load < T(0.99) && !s.joint_has_tone(i);
    }
    if (to_target) {
      p.local[i] = p.target[i];
      continue;
    }
    std::array<T, 6> moved{};
    const bool goes_on = s.steps_unchanged >= kUnchangedSteps && s.rate_step > T(0);
    const T steady = goes_on ? h / (2 * s.rate_step) : T(0);  // rates are those at the end of a step
    for (int k = 0; k < count; ++k)
      moved[k] = share * h * (s.rate[i][k] + steady * (s.rate[i][k] - s.rate_before[i][k]));
    p.local[i] = at_offset<T>(s.tree, i, rebased<T>(s.tree, i, wanted, p.start[i]), moved);
  }
}

template <class T>
void read_torques(CharacterState<T>& s, T h) {
  const TreeProblem<T>& p = s.problem;
  std::fill(s.torque.begin(), s.torque.end(), T(0));
  for (int dof = 0; dof < s.tree.dofs; ++dof)
    if (!p.free[dof]) s.torque[dof] = p.gradient[dof];
  for (const JointRow<T>& row : p.rows) {
    if (!row.muscle) continue;
    const T slope = row.slope(row.value);
    for (int a = 0; a < row.count; ++a) s.torque[row.dof + a] -= slope * row.gradient[a];
  }
  for (const EllipsoidRow<T>& row : p.ellipsoids) {
    const Vec3<T> torque = row.gradient.transpose() * row.slope(row.value);
    for (int a = 0; a < 3; ++a) s.torque[row.dof + a] -= torque[a];
  }
  const T emphasis = emphasis_of(p, h);
  for (int dof = 0; dof < s.tree.dofs; ++dof) {
    s.torque[dof] /= emphasis;
    s.unknown[dof] = p.free[dof];
    s.limit[dof] = p.law.limit(dof, s.torque[dof]);
  }
}

SINEW_UNKNOWNS_INSTANCES(template, float)
SINEW_UNKNOWNS_INSTANCES(template, double)

}  // namespace sinew
