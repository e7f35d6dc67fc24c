#include "sinew/character/island.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

constexpr double kCertified = 0.9;  ///< of the limit: below, a joint at its target leaves the unknowns
constexpr double kSnapAngle =
    2e-3;  ///< rad (0.1°) and m: a returning joint this close is on the animation again
constexpr double kSnapRate = 5e-2;  ///< 1/s
constexpr double kCut = 0.2;  ///< rad and m: an animation that leaps further than this in one step was cut
constexpr int kReleaseRounds = 8;
constexpr int kUnchangedSteps =
    2;  ///< before bdf2 may be used: after one, a dropped ball still lifts off again

/// Contact identity that survives from step to step.
std::uint64_t contact_id(int tree_a, int point, int tree_b, int shape) {
  return (std::uint64_t(tree_a + 1) << 48) ^ (std::uint64_t(point + 1) << 32) ^
         (std::uint64_t(tree_b + 1) << 16) ^ std::uint64_t(shape + 1);
}

/// Order-independent digest of a set of contacts.
std::uint64_t mixed(std::uint64_t id) {
  id ^= id >> 31;
  id *= 0x9e3779b97f4a7c15ull;
  return id ^ (id >> 29);
}

/// Largest ratio of needed torque to limit over a joint's degrees of freedom.
template <class T>
T load_of(const TreeProblem<T>& p, int dof, T torque) {
  const T limit = torque >= T(0) ? p.law.torque_plus[dof] : p.law.torque_minus[dof];
  if (std::isinf(limit)) return T(0);
  return limit > T(0) ? std::abs(torque) / limit : T(0);
}

/// Where the animation was one step ago, going by its present velocity.
template <class T>
Transform<T> rewound(const JointJet<T>& jet, T h) {
  return {jet.rotation * rotation_exp<T>(-h * jet.omega), jet.translation - h * jet.velocity};
}

/// After a cut between clips the way back starts from where the joint is, as seen from the new clip: the
/// offset from the old one means nothing any more.
template <class T>
void start_again_after_cut(CharacterState<T>& s, int i, T h) {
  const Transform<T> before = rewound(s.target[i], h);
  const JointJet<T>& last = s.target_before[i];
  if ((before.translation - last.translation).norm() < T(kCut) &&
      before.rotation.angularDistance(last.rotation) < T(kCut))
    return;
  Deviation<T>& d = s.deviation[i];
  const Transform<T> wanted{s.target[i].rotation, s.target[i].translation};
  const std::array<T, 6> moved = joint_offset<T>(s.tree, i, before, wanted).value;
  d.offset = joint_offset<T>(s.tree, i, before, s.local[i]).value;
  for (int k = 0; k < s.tree.dof_count(i); ++k) d.rate[k] = s.rate[i][k] - moved[k] / h;
}

}  // namespace

template <class T>
void IslandStepper<T>::reserve(int trees, int dofs, int bodies, int contact_points) {
  problems_.reserve(trees);
  contacts_.reserve(contact_points);
  solver_.reserve(dofs, bodies, contact_points);
}

/// Muscles pull to the animation, or along a critically damped way back to it:
/// e(h) = (e₀ + (ė₀ + e₀/τ)·h)·exp(−h/τ), e the offset from the animation.
template <class T>
void IslandStepper<T>::choose_targets(CharacterState<T>& s, const WorldSettings& world, T h) {
  const T tau = T(world.accuracy.return_time);
  const T decay = std::exp(-h / tau);
  for (int i = 0; i < s.tree.bodies; ++i) {
    const Transform<T> wanted{s.target[i].rotation, s.target[i].translation};
    const Deviation<T>& d = s.deviation[i];
    if (d.on_animation) {
      s.problem.target[i] = wanted;
      continue;
    }
    start_again_after_cut(s, i, h);
    std::array<T, 6> offset{};
    for (int k = 0; k < s.tree.dof_count(i); ++k)
      offset[k] = (d.offset[k] + (d.rate[k] + d.offset[k] / tau) * h) * decay;
    s.problem.target[i] = at_offset<T>(s.tree, i, wanted, offset);
  }
}

/// A joint is an unknown if it was released and has not come to rest on its target since, or if nothing
/// drives it.
template <class T>
void IslandStepper<T>::choose_unknowns(CharacterState<T>& s) {
  for (int i = 0; i < s.tree.bodies; ++i) {
    const int first = s.tree.first_dof[i], count = s.tree.dof_count(i);
    bool driven = true;
    for (int dof = first; dof < first + count; ++dof)
      driven = driven && s.problem.law.torque_minus[dof] > T(0) && s.problem.law.torque_plus[dof] > T(0);
    const bool root = s.tree.type[i] == JointType::kFree && s.tree.parent[i] < 0;
    const bool free = root ? !s.root_is_kinematic() && (!driven || s.deviation[i].released)
                           : !driven || s.deviation[i].released;
    for (int dof = first; dof < first + count; ++dof) s.problem.free[dof] = free;
  }
}

/// Hands joints whose needed torque exceeds their muscles' limit to the solve. True if there were any.
template <class T>
bool IslandStepper<T>::release_overloaded(CharacterState<T>& s) {
  bool any = false;
  for (int i = 0; i < s.tree.bodies; ++i) {
    const int first = s.tree.first_dof[i], count = s.tree.dof_count(i);
    if (count == 0 || s.problem.free[first]) continue;
    if (s.root_is_kinematic() && s.tree.type[i] == JointType::kFree && s.tree.parent[i] < 0) continue;
    T load = T(0);
    for (int dof = first; dof < first + count; ++dof)
      load = std::max(load, load_of(s.problem, dof, s.problem.gradient[dof]));
    if (load <= T(1)) continue;
    for (int dof = first; dof < first + count; ++dof) s.problem.free[dof] = 1;
    any = true;
  }
  return any;
}

/// Driven joints start at their target, the others go on as they moved: the best start measured.
template <class T>
void IslandStepper<T>::first_guess(CharacterState<T>& s, T h) {
  for (int i = 0; i < s.tree.bodies; ++i) {
    const int first = s.tree.first_dof[i], count = s.tree.dof_count(i);
    TreeProblem<T>& p = s.problem;
    p.start[i] = s.local[i];
    const Transform<T> wanted{s.target[i].rotation, s.target[i].translation};
    bool to_target = count == 0 || !p.free[first];
    if (!to_target) {
      T load = T(0);
      bool driven = true;
      for (int dof = first; dof < first + count; ++dof) {
        driven = driven && p.law.torque_minus[dof] > T(0) && p.law.torque_plus[dof] > T(0);
        load = std::max(load, s.load[dof]);
      }
      to_target = driven && load < T(0.99);
    }
    if (to_target) {
      p.local[i] = p.target[i];
      continue;
    }
    std::array<T, 6> moved{};
    for (int k = 0; k < count; ++k) moved[k] = h * s.rate[i][k];
    p.local[i] = at_offset<T>(s.tree, i, rebased<T>(s.tree, i, wanted, s.local[i]), moved);
  }
}

template <class T>
void IslandStepper<T>::add_contact(Contact<T> c, T reach, std::span<const LaggedForce<T>> lagged) {
  TreeProblem<T>& a = *problems_[c.tree_a];
  TreeProblem<T>* b = c.tree_b < 0 ? nullptr : problems_[c.tree_b];
  begin_step<T>(a.kinematics, b ? &b->kinematics : nullptr, c);
  if (c.gap > reach || contacts_.size() == contacts_.capacity()) return;
  const auto found = std::lower_bound(lagged.begin(), lagged.end(), c.id,
                                      [](const LaggedForce<T>& f, std::uint64_t id) { return f.id < id; });
  if (found != lagged.end() && found->id == c.id) c.lagged_normal_force = found->force;
  contacts_.push_back(c);
}

/// All pairs that may touch within the step, measured at its start. Points of bodies that no unknown moves
/// meet only other trees: a driven root bears what its feet would.
template <class T>
void IslandStepper<T>::collect_contacts(const WorldSettings& world, std::span<const Collider> obstacles, T h,
                                        std::span<const int> indices,
                                        std::span<const LaggedForce<T>> lagged) {
  contacts_.clear();
  for (std::size_t n = 0; n < states_.size(); ++n) {
    CharacterState<T>& s = *states_[n];
    const T sink_stiffness =
        T(s.skeleton.total_mass() * std::max(1.0, world.gravity.norm()) / world.accuracy.sink_depth);
    for (std::size_t k = 0; k < s.points.size(); ++k) {
      const ContactPoint<T>& point = s.points[k];
      bool moved = false;
      for (int i = point.body; i >= 0 && !moved; i = s.tree.parent[i])
        moved = s.tree.dof_count(i) > 0 && s.problem.free[s.tree.first_dof[i]];
      const T reach = T(0.1) + T(1) * h * (s.history.velocity[point.body].norm() + T(5) * h);
      Contact<T> c;
      c.tree_a = static_cast<int>(n);
      c.body_a = point.body;
      c.local_a = point.local;
      c.radius = point.radius;
      c.stiffness = sink_stiffness;
      if (moved && s.settings.ground_contact) {
        if (world.ground) {
          c.plane = true;
          c.plane_height = T(world.ground_height) - settings_.common_origin.z();
          c.friction = point.friction * T(world.ground_friction);
          c.id = contact_id(indices[n], static_cast<int>(k), -1, -1);
          add_contact(c, reach, lagged);
        }
        for (std::size_t o = 0; o < obstacles.size(); ++o) {
          c.plane = false;
          c.shape = obstacles[o].shape;
          c.size = obstacles[o].size.template cast<T>();
          c.shape_pose = obstacles[o].local.template cast<T>();
          c.shape_pose.translation -= settings_.common_origin;
          c.friction = std::sqrt(point.friction * T(obstacles[o].friction));
          c.id = contact_id(indices[n], static_cast<int>(k), -1, static_cast<int>(o));
          add_contact(c, reach, lagged);
        }
      }
      c.plane = false;
      for (std::size_t m = 0; m < states_.size(); ++m) {
        const CharacterState<T>& other = *states_[m];
        // A ball's centre against a limb says it all; the limb's ends against the ball would say it twice.
        const bool ball = other.is_prop && other.skeleton.colliders[0].shape == Shape::kSphere;
        if (m == n || (ball && !(s.is_prop && m < n))) continue;
        for (std::size_t o = 0; o < other.skeleton.colliders.size(); ++o) {
          const Collider& shape = other.skeleton.colliders[o];
          if (shape.joint >= other.skeleton.body_count) continue;
          c.tree_b = static_cast<int>(m);
          c.body_b = shape.joint;
          c.shape = shape.shape;
          c.size = shape.size.template cast<T>();
          c.shape_pose = shape.local.template cast<T>();
          c.stiffness =
              std::min(sink_stiffness, T(other.skeleton.total_mass() * std::max(1.0, world.gravity.norm()) /
                                         world.accuracy.sink_depth));
          c.friction = std::sqrt(point.friction * T(shape.friction));
          c.id = contact_id(indices[n], static_cast<int>(k), indices[m], static_cast<int>(o));
          add_contact(c, reach + h * other.history.velocity[shape.joint].norm(), lagged);
        }
      }
    }
  }
}

/// Whether the contacts of a tree that touched after the last step are predicted (constant velocity and
/// gravity) to be the same after this one.
template <class T>
bool IslandStepper<T>::contacts_unchanged(const WorldSettings& world, T h, int tree) const {
  std::uint64_t signature = 0;
  const auto speed = [&](int t, int body, const Vec3<T>& x) {
    const CharacterState<T>& s = *states_[t];
    const Mat3<T> spin = s.history.rotation_rate[body] * s.history.rotation[body].transpose();
    return Vec3<T>(s.history.velocity[body] + spin * (x - s.problem.kinematics.center[body]) +
                   h * world.gravity.template cast<T>());
  };
  for (const Contact<T>& c : contacts_) {
    if (c.tree_a != tree && c.tree_b != tree) continue;
    T gap = c.gap + h * c.normal.dot(speed(c.tree_a, c.body_a, c.point));
    if (c.tree_b >= 0) gap -= h * c.normal.dot(speed(c.tree_b, c.body_b, c.point));
    if (gap < T(0)) signature ^= mixed(c.id);
  }
  return signature == states_[tree]->contact_signature;
}

template <class T>
void IslandStepper<T>::finish(CharacterState<T>& s, int tree, const WorldSettings& world, T h,
                              const SolveReport& solved) {
  TreeProblem<T>& p = s.problem;
  std::fill(s.torque.begin(), s.torque.end(), T(0));
  for (int dof = 0; dof < s.tree.dofs; ++dof)
    if (!p.free[dof]) s.torque[dof] = p.gradient[dof];
  for (const JointRow<T>& row : p.rows) {
    if (!row.muscle) continue;
    const T slope = row.slope(row.value);
    for (int a = 0; a < row.count; ++a) s.torque[row.dof + a] -= slope * row.gradient[a];
  }
  for (int dof = 0; dof < s.tree.dofs; ++dof) {
    s.unknown[dof] = p.free[dof];
    s.limit[dof] = s.torque[dof] >= T(0) ? p.law.torque_plus[dof] : p.law.torque_minus[dof];
    s.load[dof] = std::min(load_of(p, dof, s.torque[dof]), T(1));
  }
  for (int i = 0; i < s.tree.bodies; ++i) {
    s.rate[i] = joint_offset<T>(s.tree, i, s.local[i], p.local[i]).value;
    for (T& r : s.rate[i]) r /= h;
    const Transform<T> wanted{s.target[i].rotation, s.target[i].translation};
    const JointOffset<T> from_animation = joint_offset<T>(s.tree, i, wanted, p.local[i]);
    const JointOffset<T> from_target = joint_offset<T>(s.tree, i, p.target[i], p.local[i]);
    Deviation<T>& d = s.deviation[i];
    T offset = T(0), rate = T(0), missed = T(0), load = T(0);
    const int first = s.tree.first_dof[i];
    for (int k = 0; k < s.tree.dof_count(i); ++k) {
      d.rate[k] = (from_animation.value[k] - d.offset[k]) / h;
      d.offset[k] = from_animation.value[k];
      offset = std::max(offset, std::abs(d.offset[k]));
      rate = std::max(rate, std::abs(d.rate[k]));
      missed = std::max(missed, std::abs(from_target.value[k]));
      load = std::max(load, s.load[first + k]);
    }
    // Released until it has met its target with strength to spare; the kink's rounding is not a miss.
    const bool free = s.tree.dof_count(i) > 0 && p.free[first];
    d.released = free && !(missed < T(4) * settings_.kink_width && load < T(kCertified));
    d.on_animation = !d.released && offset < T(kSnapAngle) && rate < T(kSnapRate);
    if (d.on_animation) {
      d.offset = {};
      d.rate = {};
    }
    s.local[i] = p.local[i];
  }
  for (std::size_t i = s.tree.bodies; i < s.local.size(); ++i)
    s.local[i] = {s.target[i].rotation, s.target[i].translation};
  s.update_model();
  advance<T>(s.tree, p.kinematics, p.prediction, p.couple, h, settings_.common_origin, s.history);

  CharacterReport& r = s.report;
  r = {};
  r.dofs = s.tree.dofs;
  r.unknown_dofs = static_cast<int>(std::count(p.free.begin(), p.free.end(), 1));
  r.outer_passes = solved.outer_passes;
  r.factorisations = solved.factorisations;
  r.converged = solved.converged;
  r.used_bdf2 = p.prediction.scheme == Scheme::kBdf2;
  std::uint64_t signature = 0;
  for (const Contact<T>& c : contacts_) {
    if ((c.tree_a != tree && c.tree_b != tree) || c.gap >= T(0)) continue;
    signature ^= mixed(c.id);
    ++r.contacts;
    r.penetration = std::max(r.penetration, double(-c.gap));
  }
  s.steps_unchanged = signature == s.contact_signature ? s.steps_unchanged + 1 : 0;
  s.contact_signature = signature;
  for (int i = 0; i < s.tree.bodies; ++i) {
    const Mat3<T>& rate = s.history.rotation_rate[i];
    r.kinetic_energy += 0.5 * double(s.tree.mass[i] * s.history.velocity[i].squaredNorm() +
                                     (rate * s.tree.second_moment[i]).cwiseProduct(rate).sum());
    r.potential_energy -= double(s.tree.mass[i] * world.gravity.template cast<T>().dot(s.history.center[i]));
  }
}

template <class T>
void IslandStepper<T>::step(const WorldSettings& world, std::span<const Collider> obstacles, T h,
                            std::span<CharacterState<T>* const> states, std::span<const int> indices,
                            std::span<const LaggedForce<T>> lagged, std::vector<LaggedForce<T>>& lagged_out) {
  states_ = states;
  problems_.clear();
  settings_.h = h;
  settings_.gravity = world.gravity.template cast<T>();
  settings_.common_origin = states[0]->model[0].translation;
  settings_.limit_stiffness = T(world.accuracy.limit_stiffness);
  settings_.stick = T(world.accuracy.stick_speed) * h;
  settings_.kink_width = T(1e-3) * h;
  for (CharacterState<T>* s : states) {
    problems_.push_back(&s->problem);
    choose_targets(*s, world, h);
    choose_unknowns(*s);
    first_guess(*s, h);
    s->problem.pushes.clear();
    for (const ExternalForce<T>& j : s->impulses) s->problem.pushes.push_back({j.body, j.local, j.force / h});
    forward_kinematics<T>(s->tree, s->local, settings_.common_origin, s->problem.kinematics);
  }
  SolveReport total;
  for (int round = 0; round < kReleaseRounds; ++round) {
    // Which points can move depends on what was released.
    for (CharacterState<T>* s : states)
      forward_kinematics<T>(s->tree, s->problem.start, settings_.common_origin, s->problem.kinematics);
    collect_contacts(world, obstacles, h, indices, lagged);
    if (round == 0) {
      bool second = world.accuracy.scheme == Scheme::kBdf2;
      for (std::size_t n = 0; n < states.size() && second; ++n)
        second = states[n]->steps_unchanged >= kUnchangedSteps &&
                 contacts_unchanged(world, h, static_cast<int>(n));
      for (CharacterState<T>* s : states)
        predict<T>(s->tree, s->history, second ? Scheme::kBdf2 : Scheme::kBdf1, h, settings_.common_origin,
                   s->problem.prediction);
    }
    const SolveReport solved = solver_.solve(settings_, world.accuracy, problems_, contacts_);
    total.outer_passes += solved.outer_passes;
    total.factorisations += solved.factorisations;
    total.converged = solved.converged;
    bool released = false;
    for (CharacterState<T>* s : states) released = release_overloaded(*s) || released;
    if (!released) break;
  }
  for (std::size_t n = 0; n < states.size(); ++n) finish(*states[n], static_cast<int>(n), world, h, total);
  for (const Contact<T>& c : contacts_)
    if (const T force = ContactLaw<T>::force(c.stiffness, c.gap); force > T(0))
      lagged_out.push_back({c.id, force});
}

template class IslandStepper<float>;
template class IslandStepper<double>;

}  // namespace sinew
