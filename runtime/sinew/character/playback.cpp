#include "sinew/character/playback.h"

#include <algorithm>
#include <cmath>

#include "sinew/character/return_to_animation.h"
#include "sinew/character/tone.h"
#include "sinew/effects/support.h"

namespace sinew {

namespace {

/// What the effects ask of a character on its animation: wrenches of the bodies, and rows of the joints.
template <class T>
void add_effect_wrenches(CharacterState<T>& s, const WorldSettings& world, const Vec3<T>& origin, T h) {
  TreeProblem<T>& p = s.problem;
  StepSettings<T> step;
  step.h = h;
  step.gravity = world.gravity.template cast<T>();
  step.common_origin = origin.template cast<double>();
  for (int i = 0; i < s.tree.bodies; ++i) {
    p.start[i] = s.local[i];
    p.local[i] = {s.target[i].rotation, s.target[i].translation};
  }
  for (const Effect<T>* effect : p.effects)
    effect->add_load(effect_pose(step, p), s.motion, {p.force, p.moment});
  measure_effect_rows(step, p);
}

/// What bears on the ground in a check of a character.
template <class T>
Standing<T> standing_of(const CharacterState<T>& s, const CheckContext<T>& c) {
  const WorldSettings& world = c.world;
  return {stands(s, world, c.plan, c.ground) ? c.plan.support : nullptr,
          s.rig->support,
          T(world.ground_height),
          T(world.ground_friction),
          s.grounded() ? T(s.total_mass * world.gravity.norm()) : T(0),
          c.ground};
}

/// What the muscles would have to give, with nothing that acts from outside left out.
template <class T>
void check_under_loads(CharacterState<T>& s, T h, const CheckContext<T>& c) {
  const WorldSettings& world = c.world;
  const StepPlan<T>& plan = c.plan;
  CheckScratch<T> scratch = c.scratch;
  TreeProblem<T>& p = s.problem;
  const Vec3<T> origin = s.target[0].translation, gravity = world.gravity.template cast<T>();
  inertial_wrenches<T>(s.tree, s.target, gravity, origin, p.kinematics, s.motion, p.force, p.moment);
  const auto take_off = [&](bool any, auto add) {
    if (!any) return;
    p.clear_wrenches();
    add();
    add_wrenches<T>(p.kinematics, p.force, p.moment, scratch.body);
  };
  const Standing<T> standing = standing_of(s, c);
  scratch.body = s.motion.body;  // to the bit what check_motion makes
  scratch.rotation = p.kinematics.rotation;
  scratch.origin = p.kinematics.origin;
  take_off(!s.impulses.empty() || !s.forces.empty(), [&] {
    for (const ExternalForce<T>& j : s.impulses)
      plan.impulses->add_gradient({j.body, j.local, j.force / h}, p.kinematics, {p.force, p.moment});
    for (const ExternalForce<T>& f : s.forces)
      plan.impulses->add_gradient(f, p.kinematics, {p.force, p.moment});
  });
  standing.bear(origin.z() - standing.ground, scratch);
  take_off(!p.effects.empty(), [&] { add_effect_wrenches(s, world, origin, h); });
  project_bodies<T>(s.tree, scratch.body, [&](int dof, const T& t) { p.gradient[dof] = t; });
  for (const JointRow<T>& row : p.effect_rows)
    for (int a = 0; a < row.count; ++a) p.gradient[row.dof + a] += row.slope(row.value) * row.gradient[a];
}

/// The same of the animation by itself.
template <class T>
void check_animation(CharacterState<T>& s, const std::vector<JointJet<T>>& target, const CheckContext<T>& c) {
  check_motion<T>(s.tree, target, c.world.gravity.template cast<T>(), standing_of(s, c), c.scratch,
                  s.problem.gradient);
}

/// What it asks for under loads; whether it is more by `most` than the animation asks muscles with a tone for
/// by itself.
template <class T>
bool asks_for_more(CharacterState<T>& s, T h, const CheckContext<T>& context, T most) {
  if (s.problem.law.present.tone) {
    check_animation(s, s.target, context);
    keep_feed_forward(s, &ToneOfDof<T>::feed_forward);
  }
  check_under_loads(s, h, context);
  return s.problem.law.present.tone && overloads_tone<T>(s, s.problem.gradient, most);
}

/// Whether pushes and effects reach a joint. Under a root that is driven, what pushes elsewhere does not,
/// though the check has the ground bear it.
template <class T>
bool feels_pushes(const CharacterState<T>& s, int joint) {
  if (!s.root_is_kinematic() || !s.problem.effects.empty()) return true;
  const auto beyond = [&](const ExternalForce<T>& push) {
    int i = push.body;
    while (i > joint) i = s.tree.parent[i];
    return i == joint;
  };
  return std::any_of(s.forces.begin(), s.forces.end(), beyond) ||
         std::any_of(s.impulses.begin(), s.impulses.end(), beyond);
}

/// Velocity of the root's centre of mass, m/s.
template <class T>
Vec3<T> root_velocity(const Tree<T>& tree, const JointJet<T>& jet) {
  return jet.velocity + jet.rotation * Vec3<T>(jet.omega.cross(tree.center_of_mass[0]));
}

}  // namespace

template <class T>
bool has_plain_check(const CharacterState<T>& s) {
  return s.impulses.empty() && s.forces.empty() && s.problem.effects.empty();
}

template <class T>
bool stands(const CharacterState<T>& s, const WorldSettings& world, const StepPlan<T>& plan,
            const GroundProbe<T>* ground) {
  return plan.support && (world.ground || ground) && world.ground_support && s.settings.ground_contact;
}

template <class T>
bool play(CharacterState<T>& s, T h, const CheckContext<T>& context) {
  if (s.is_struck(T(context.world.accuracy.return_time))) return false;
  if (has_plain_check(s))
    check_animation(s, s.target, context);
  else if (asks_for_more(s, h, context, T(1)))
    return false;
  return play_checked(s, context.world, h);
}

template <class T>
void begin_tone(CharacterState<T>& s, T h, const CheckContext<T>& context) {
  if (!s.problem.law.present.tone || s.passive()) return;
  constexpr T kLittle = T(0.5);  // of what makes a muscle give way
  s.grounding.returns = false;
  check_animation(s, s.last_target(), context);
  keep_feed_forward(s, &ToneOfDof<T>::before);
  s.acted_on = !has_plain_check(s);
  if (s.acted_on) {
    s.acted_on = asks_for_more(s, h, context, kLittle);
    for (int i = 0; i < s.tree.bodies; ++i)
      if (feels_pushes(s, i) && tone_load<T>(s, i, s.problem.gradient, &ToneOfDof<T>::feed_forward) > T(1))
        s.deviation[i].released = true;
    s.clear_deviations();
    return;
  }
  check_animation(s, s.target, context);
  keep_feed_forward(s, &ToneOfDof<T>::feed_forward);
}

template <class T>
bool play_checked(CharacterState<T>& s, const WorldSettings& world, T h) {
  const TreeProblem<T>& p = s.problem;
  const int root_dofs = s.tree.type[0] == JointType::kFree ? s.tree.dof_count(0) : 0;
  const int begin = s.root_is_kinematic() && root_dofs > 0 ? 1 : 0, end = s.limited ? s.tree.bodies : begin;
  for (int i = begin; i < end; ++i)
    for (int dof = s.tree.first_dof[i]; dof < s.tree.first_dof[i + 1]; ++dof)
      if (p.law.overloaded(s.tree, i, dof, p.gradient)) return false;
  if (drives_into_floor(s, world)) return false;
  if (!s.undisturbed()) {
    std::copy(p.gradient.begin(), p.gradient.end(), s.torque.begin());
    follow(s, world, h);
    report_help(s);
    return true;
  }
  std::copy(p.gradient.begin(), p.gradient.end(), s.torque.begin());
  std::fill(s.unknown.begin(), s.unknown.end(), std::uint8_t{0});
  s.played_from.swap(s.local);
  std::transform(s.target.begin(), s.target.end(), s.local.begin(), [](const JointJet<T>& jet) {
    return Transform<T>{jet.rotation, jet.translation};
  });
  s.pose_changed();
  s.history.place = s.target[0].translation.template cast<double>();  // neighbours go by these two
  s.history.velocity[0] = root_velocity(s.tree, s.target[0]);
  s.deferred = {
      .loads = true, .rates = true, .history = true, .totals = true, .h = h, .gravity = world.gravity};
  s.forget_contacts();
  s.report = {};
  s.report.dofs = s.tree.dofs;
  report_help(s);
  return true;
}

template <class T>
void report_help(CharacterState<T>& s) {
  if (!s.grounded() || !s.floats) return;
  const auto size = [&](int first) {
    return Vec3<double>(double(s.torque[first]), double(s.torque[first + 1]), double(s.torque[first + 2]))
        .norm();
  };
  s.report.help_force = size(0);
  s.report.help_torque = size(3);
}

template <class T>
void follow(CharacterState<T>& s, const WorldSettings& world, T h) {
  TreeProblem<T>& p = s.problem;
  s.keep_loads();
  std::copy_n(s.local.begin(), s.tree.bodies, p.start.begin());
  p.common_origin = s.local[0].translation;
  for (int i = 0; i < s.tree.bodies; ++i) {
    s.wanted[i] = {s.target[i].rotation, s.target[i].translation};
    if (i > 0) follow_across<T>(s, i, h, s.wanted[i]);
  }
  if (s.undisturbed())
    p.target = s.wanted;
  else
    choose_targets<T>(s, T(world.accuracy.return_time),
                      height_of_floor<T>(world, double(p.common_origin.z())), h);
  for (int i = 0; i < s.tree.bodies; ++i) {
    s.played_from[i] = p.start[i];
    s.local[i] = p.target[i];
    s.deviation[i].released = false;
    if (s.deviation[i].on_animation) continue;
    // Nobody measures what the return takes: no muscle counts as saturated.
    std::fill_n(s.load.begin() + s.tree.first_dof[i], s.tree.dof_count(i), T(0));
    s.update_deviation(i, joint_offset_value<T>(s.tree, i, s.wanted[i], s.local[i]), h,
                       T(world.accuracy.return_time));
  }
  s.clear_deviations();
  for (std::size_t i = s.tree.bodies; i < s.local.size(); ++i)
    s.local[i] = {s.target[i].rotation, s.target[i].translation};
  s.pose_changed();
  std::fill(s.unknown.begin(), s.unknown.end(), std::uint8_t{0});
  s.history.velocity[0] = (s.local[0].translation - p.start[0].translation) / h;  // neighbours go by it
  s.history.place = s.local[0].translation.template cast<double>();
  s.deferred = {.rates = true, .history = true, .motion = true, .h = h};
  s.forget_contacts();
  s.report = {};
  s.report.dofs = s.tree.dofs;
}

template <class T>
void synchronise(CharacterState<T>& s, std::vector<JointJet<T>>& jets) {
  s.keep_record();
  if (!s.deferred.motion) return;
  s.deferred.history = s.deferred.motion = false;
  // Speeds of the animation, and on top of them those of what is off it.
  jets.assign(s.last_target().begin(), s.last_target().begin() + s.tree.bodies);
  for (int i = 0; i < s.tree.bodies; ++i) {
    JointJet<T>& jet = jets[i];
    const Deviation<T>& d = s.deviation[i];
    const Quat<T> turned = s.local[i].rotation.conjugate() * jet.rotation;
    jet.rotation = s.local[i].rotation;
    jet.translation = s.local[i].translation;
    if (d.on_animation) continue;
    const std::array<T, 6> rate = spin_of_rate<T>(s.tree.type[i], d.offset, d.rate);
    jet.omega = turned * jet.omega;
    switch (s.tree.type[i]) {
      case JointType::kRevolute:
        jet.omega += s.tree.axis[i] * rate[0];
        break;
      case JointType::kBall:
        jet.omega += Vec3<T>(rate[0], rate[1], rate[2]);
        break;
      case JointType::kTranslation:
        jet.velocity += Vec3<T>(rate[0], rate[1], rate[2]);
        break;
      case JointType::kFree:
        jet.velocity += Vec3<T>(rate[0], rate[1], rate[2]);
        jet.omega += Vec3<T>(rate[3], rate[4], rate[5]);
        break;
      default:
        break;  // on the animation's speed
    }
  }
  const Vec3<T>& origin = s.local[0].translation;
  inertial_wrenches<T>(s.tree, jets, Vec3<T>::Zero(), origin, s.problem.kinematics, s.motion, s.problem.force,
                       s.problem.moment);
  advance_exactly<T>(s.tree, s.problem.kinematics, s.motion, T(0), Vec3<T>::Zero(),
                     origin.template cast<double>(), s.history);
  s.history.step_before = T(0);
}

SINEW_PLAYBACK_INSTANCES(template, float)
SINEW_PLAYBACK_INSTANCES(template, double)

}  // namespace sinew
