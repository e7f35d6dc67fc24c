#include "sinew/character/baking.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sinew/optimizer/bossak.h"
#include "sinew/optimizer/joint_terms.h"
#include "sinew/optimizer/joint_terms_pass.h"
#include "sinew/optimizer/problem_pass.h"

namespace sinew {
namespace {

/// Of a joint's own equations, until it moves by less than kSettled: a hand that is whipped turns by a third
/// of a radian in a step.
constexpr int kRounds = 8;
constexpr double kSettled = 1e-4;  ///< rad or m
/// rad or m in one part of a step, that a baked joint may be off its own equations after the solve. At 0.03
/// limp hands are 9 to 30° rms off the unbaked ones after six blows, at 0.01 one, with two more solves in a
/// hundred.
constexpr double kMissed = 0.01;
/// rad that what a baked joint hangs on turns in one part of a step: where it goes is guessed along the
/// straight, and from here on that is off by half of kMissed.
constexpr double kExpectable = 0.1;

template <class T>
using Block = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
template <class T>
using Column = Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 6, 1>;

/// Not Eigen's maxCoeff(), whose packets are wider than a column here.
template <class T>
T furthest(const Column<T>& way) {
  T most = T(0);
  for (int a = 0; a < way.size(); ++a) most = std::max(most, std::abs(way[a]));
  return most;
}

template <class T>
bool has_no_muscle(const TreeProblem<T>& p, int i) {
  for (int dof = p.tree->first_dof[i]; dof < p.tree->first_dof[i + 1]; ++dof)
    if (p.law.has_muscle(dof)) return false;
  return true;
}

template <class T>
bool hangs_on(const Tree<T>& tree, int body, int joint) {
  while (body > joint) body = tree.parent[body];
  return body == joint;
}

/// Puts what hangs on joint i where the local transforms have it.
template <class T>
void place_hanging(TreeProblem<T>& p, int i) {
  for (int b = i; b < p.tree->bodies; ++b)
    if (hangs_on(*p.tree, b, i)) place_body<T>(*p.tree, b, p.local[b], p.common_origin, p.kinematics);
}

/// Equations of one joint, the rest of the tree standing where it is.
template <class T>
struct OwnEquations {
  Block<T> matrix;   ///< change of `torque` by a small motion in the joint's chart
  Column<T> torque;  ///< N·m (N) that the joint's motion asks of its muscles
};

/// What hangs on joint i, as one rigid body: inertia and gravity against the prediction, and the joint's
/// damping.
template <class T>
OwnEquations<T> own_equations(const StepSettings<T>& settings, const TreeProblem<T>& p, int i) {
  const Tree<T>& tree = *p.tree;
  const Kinematics<T>& k = p.kinematics;
  const T weight = p.prediction.weight;
  Composite<T> body;
  Vec3<T> force = Vec3<T>::Zero(), moment = Vec3<T>::Zero();
  for (int b = i; b < tree.bodies; ++b) {
    if (!hangs_on(tree, b, i)) continue;
    const Vec3<T>& c = k.center[b];
    const Vec3<T> own = (weight * tree.mass[b]) * (c - p.prediction.center[b]) +
                        gravity_gradient<T>(tree.mass[b], settings.gravity);
    force += own;
    moment += c.cross(own) +
              (lacks_energy(p) ? p.prediction.other->couple(settings, p, b) : inertial_couple<T>(p, b));
    body.add_body(weight * tree.mass[b], c,
                  weight * (k.rotation[b] * tree.inertia[b] * k.rotation[b].transpose()));
  }
  const int first = tree.first_dof[i], count = tree.dof_count(i);
  const T larger = emphasis<T>(settings, weight);
  const std::array<T, 6> moved = joint_offset_value<T>(tree, i, p.start[i], p.local[i]);
  OwnEquations<T> own{Block<T>(count, count), Column<T>(count)};
  for (int a = 0; a < count; ++a) {
    const Vec3<T>&w = k.w[first + a], &v = k.v[first + a];
    const Vec3<T> push = body.mass * v + w.cross(body.first);
    const Vec3<T> turn = body.rotational * w + body.first.cross(v);
    for (int b = 0; b < count; ++b) own.matrix(a, b) = k.w[first + b].dot(turn) + k.v[first + b].dot(push);
    const T damping = settings.plan->joints.damping ? larger * p.law.damping[first + a] / settings.h : T(0);
    own.torque[a] = w.dot(moment) + v.dot(force) + damping * moved[a];
    own.matrix(a, a) += damping;
  }
  return own;
}

/// A joint's torques and where it would rather be.
template <class T>
struct Pull {
  std::array<T, 6> off{};  ///< from the muscles' target; without muscles from where the step began
  Column<T> torque;        ///< that muscles, or dry friction without them, give where `asked` is asked for
};

/// All they have where they are off their target, what is asked within their limits where they are on it.
template <class T>
Pull<T> pull_of(const StepSettings<T>& settings, TreeProblem<T>& p, int i, const Column<T>& asked) {
  const int first = p.tree->first_dof[i];
  std::copy_n(asked.data(), asked.size(), p.gradient.begin() + first);
  const bool passive = has_no_muscle(p, i);
  Pull<T> pull{joint_offset_value<T>(*p.tree, i, passive ? p.start[i] : p.target[i], p.local[i]), asked};
  const T larger = emphasis<T>(settings, p.prediction.weight);
  const T load = p.law.ellipsoidal[i] ? p.law.load(*p.tree, i, first, p.gradient) / larger : T(0);
  for (int a = 0; a < asked.size(); ++a) {
    const T friction = settings.plan->joints.damping ? p.law.dry_friction[first + a] : T(0);
    const T minus = larger * (passive ? friction : p.law.torque_minus[first + a]);
    const T plus = larger * (passive ? friction : p.law.torque_plus[first + a]);
    if (p.law.ellipsoidal[i])
      pull.torque[a] = asked[a] / std::max(load, T(1));
    else if (std::abs(pull.off[a]) > p.kink_width)
      pull.torque[a] = pull.off[a] > T(0) ? -minus : plus;
    else
      pull.torque[a] = std::clamp(asked[a], -minus, plus);
  }
  return pull;
}

/// x of m·x = b, m symmetric and positive definite, by Cholesky's factors (six rows at most: Eigen's blocked
/// ones take longer to compile than all else here).
template <class T>
Column<T> solve_positive(Block<T> m, Column<T> b) {
  const int n = static_cast<int>(b.size());
  for (int j = 0; j < n; ++j) {
    for (int k = 0; k < j; ++k)
      for (int i = j; i < n; ++i) m(i, j) -= m(i, k) * m(j, k);
    const T pivot = std::sqrt(m(j, j));
    for (int i = j; i < n; ++i) m(i, j) /= pivot;
    for (int k = 0; k < j; ++k) b[j] -= m(j, k) * b[k];
    b[j] /= pivot;
  }
  for (int j = n - 1; j >= 0; --j) {
    for (int k = j + 1; k < n; ++k) b[j] -= m(k, j) * b[k];
    b[j] /= m(j, j);
  }
  return b;
}

template <class T>
struct Way {
  Column<T> change;
  T asked;  ///< rad or m: the furthest, were there no target on the way
};

/// What joint i moves by so that what is asked becomes what is given, along those degrees of freedom where it
/// is not; and no further than to its target, if it is not there.
template <class T>
Way<T> way_to(const TreeProblem<T>& p, OwnEquations<T> own, const Pull<T>& pull) {
  Column<T> missing = pull.torque - own.torque;
  for (int a = 0; a < missing.size(); ++a) {
    if (missing[a] != T(0)) continue;
    own.matrix.row(a).setZero();
    own.matrix.col(a).setZero();
    own.matrix(a, a) = T(1);
  }
  Column<T> way = solve_positive(own.matrix, missing);
  const T asked = furthest<T>(way);
  for (int a = 0; a < way.size(); ++a) {
    if (pull.torque[a] == T(0) || std::abs(pull.off[a]) <= p.kink_width) continue;
    if (way[a] * pull.off[a] < T(0))
      way[a] = pull.off[a] > T(0) ? std::max(way[a], -pull.off[a]) : std::min(way[a], -pull.off[a]);
  }
  return {way, asked};
}

template <class T>
void move_by_itself(const StepSettings<T>& settings, TreeProblem<T>& p, int i) {
  for (int round = 0; round < kRounds; ++round) {
    place_hanging(p, i);
    const OwnEquations<T> own = own_equations(settings, p, i);
    const Way<T> way = way_to(p, own, pull_of(settings, p, i, own.torque));
    if (way.asked > T(0)) p.local[i] = displaced<T>(*p.tree, i, p.local[i], way.change.data());
    if (way.asked < T(kSettled)) break;
  }
  place_hanging(p, i);
}

/// Whether a limit of joint i bears at the present pose. A joint that is not solved for has no rows: there is
/// room for its own.
template <class T>
bool bears_at_limit(const StepSettings<T>& settings, TreeProblem<T>& p, int i) {
  const std::ptrdiff_t others = std::ssize(p.rows);
  append_limit_rows(settings, p, i);
  const auto own = p.rows.begin() + others;
  const bool bears =
      std::any_of(own, p.rows.end(), [](const JointRow<T>& row) { return row.slope(row.value) > T(0); });
  p.rows.erase(own, p.rows.end());
  return bears;
}

/// Whether something holds what hangs on joint i of a tree of the solve.
template <class T>
bool touched(const Tree<T>& tree, std::span<const Contact<T>> contacts, int index, int i) {
  return std::any_of(contacts.begin(), contacts.end(), [&](const Contact<T>& c) {
    return c.lagged_normal_force > T(0) && ((c.tree_a == index && hangs_on(tree, c.body_a, i)) ||
                                            (c.tree_b == index && hangs_on(tree, c.body_b, i)));
  });
}

}  // namespace

template <class T>
void choose_baked(CharacterState<T>& s, const LevelOfDetail& detail, T h) {
  const int bake_every = detail.bake_every;
  const T kept = h / (1 + T(detail.baked_decay) * h);  // of a rate that q'' = −k·q' slows, implicitly
  const bool decays = detail.baked_decay > 0;
  const bool asked = s.detail.bake || std::min(s.detail.most, s.levels.cap) <= Level::kPartial;
  const bool bakes = asked && bake_every > 1 && !s.is_prop && !s.pushed() &&
                     s.levels.steps % static_cast<std::uint32_t>(bake_every) != 0;
  for (int i = 0; i < s.tree.bodies; ++i) {
    s.baked[i] = 0;
    if (!bakes || !s.rig->bakes[i]) continue;
    const int parent = s.tree.parent[i];
    if (!decays && parent >= 0 && turn_of<T>(s.history, parent, h) > T(kExpectable)) continue;
    const bool passive = has_no_muscle(s.problem, i);
    s.baked[i] = passive || (s.joint_is_driven(i) && s.deviation[i].released && !s.joint_has_tone(i));
    if (!passive && !(decays && s.baked[i])) continue;
    std::array<T, 6> moved{};
    for (int k = 0; k < s.tree.dof_count(i); ++k) moved[k] = s.rate[i][k] * kept;
    s.problem.target[i] = at_offset<T>(s.tree, i, s.problem.start[i], moved);
  }
}

template <class T>
void move_baked(CharacterState<T>& s, const LevelOfDetail& detail, int index,
                std::span<const Contact<T>> contacts, const StepSettings<T>& settings) {
  TreeProblem<T>& p = s.problem;
  if (detail.baked_decay > 0) return;
  if (std::none_of(s.baked.begin(), s.baked.end(), [](std::uint8_t baked) { return baked != 0; })) return;
  forward_kinematics<T>(s.tree, p.local, p.common_origin, p.kinematics);
  for (int i = 0; i < s.tree.bodies; ++i)
    if (s.baked[i] && !touched(s.tree, contacts, index, i)) move_by_itself(settings, p, i);
}

template <class T>
bool release_baked(CharacterState<T>& s, const LevelOfDetail& detail, const StepSettings<T>& settings) {
  if (detail.baked_decay > 0) return false;
  TreeProblem<T>& p = s.problem;
  bool any = false;
  for (int i = 0; i < s.tree.bodies; ++i) {
    if (!s.baked[i]) continue;
    const int first = s.tree.first_dof[i], count = s.tree.dof_count(i);
    OwnEquations<T> own = own_equations(settings, p, i);
    std::copy_n(p.gradient.begin() + first, count, own.torque.data());
    const T missed = way_to(p, own, pull_of(settings, p, i, own.torque)).asked;
    if (missed < T(kMissed) && !bears_at_limit(settings, p, i)) continue;
    s.baked[i] = 0;
    ++s.unbaked;
    std::fill_n(s.problem.free.begin() + first, count, std::uint8_t{1});
    any = true;
  }
  return any;
}

SINEW_BAKING_INSTANCES(template, float)
SINEW_BAKING_INSTANCES(template, double)

}  // namespace sinew
