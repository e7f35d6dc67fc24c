#include "sinew/character/playback.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sinew/character/grounding.h"
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
          c.ground,
          s.grounding.by_hand ? &s.grounding.hand : nullptr};
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

constexpr double kOfTheHand = 0.1;  ///< of the hand, that ground which gives its utmost may miss: it yields

/// What no floor at all could give to what the animation does, N and N·m of the root. Its accelerations alone
/// ask for that much: who leans further than any feet bear does not hold himself so.
template <class T>
RootWrench<T> beyond_any_floor(CharacterState<T>& s, const CheckContext<T>& c) {
  const CheckScratch<T>& r = c.scratch;
  const auto move_and_place = [&](const Vec3<T>& gravity) {
    for (const int i : s.tree.by_depth) {
      const int p = s.tree.parent[i];
      move_body<T>(s.tree, i, s.target[i], gravity, p < 0 ? nullptr : &r.body[p], r.body[i]);
      place_body<T>(s.tree, i, r);
    }
  };
  move_and_place(Vec3<T>::Zero());
  wrenches_in_world(r);
  const SupportPoints<T>& points = s.rig->support;
  Vec3<T> force = Vec3<T>::Zero(), moment = Vec3<T>::Zero();
  T floor = std::numeric_limits<T>::max();
  for (int i = 0; i < s.tree.bodies; ++i) {
    force += r.force[i];
    moment += r.moment[i];
    for (int k = points.first[i]; k < points.first[i + 1]; ++k) {
      const Vec3<T> center = r.origin[i] + r.rotation[i] * points.points[k].local;
      floor = std::min(floor, center.z() - points.points[k].radius);
    }
  }
  // In the air where its animation has left what it stood on.
  floor = std::min(floor, T(s.grounding.level + s.grounding.by.z - double(s.target[0].translation.z())));
  move_and_place(c.world.gravity.template cast<T>());
  Standing<T> best = standing_of(s, c);
  best.friction = std::max(best.friction, T(kGoodGrip));
  best.probe = nullptr;
  best.bear(-floor, r);
  RootWrench<T> left;
  project_bodies<T>(s.tree, r.body, [&](int dof, const T& t) {
    if (dof < 6) left[dof] = t;
  });
  const auto at_most = [](Vec3<T>& x, T most) { x *= x.norm() > most ? most / x.norm() : T(1); };
  at_most(left.force, force.norm());
  at_most(left.moment, moment.norm() - floor * force.norm());
  return left;
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

/// Whether the check finds that the root of who has only the ground needs more than he is given.
template <class T>
bool is_beyond_its_help(const CharacterState<T>& s) {
  const Grounding<T>& g = s.grounding;
  const auto exceeds = [&](int first, T hand) {
    const T most =
        T(s.help_at_most(first == 0) * double(s.root_strength())) + (g.by_hand ? T(kOfTheHand) * hand : T(0));
    return std::any_of(s.problem.gradient.begin() + first, s.problem.gradient.begin() + first + 3,
                       [&](T asked) { return std::abs(asked) > most; });
  };
  return exceeds(0, g.hand.force.norm()) || exceeds(3, g.hand.moment.norm());
}

/// Whether the joints over what stands have all the strength that they were made with. After a check.
template <class T>
bool bears_with_all_its_strength(const CharacterState<T>& s, const CheckContext<T>& c) {
  const SupportPoints<T>& points = s.rig->support;
  const auto is_weak = [&](int joint) {
    return s.joint_strength[joint] < T(1) || s.activation[joint] < T(1);
  };
  for (int i = 0; i < s.tree.bodies; ++i) {
    bool bears = false;
    for (int k = points.first[i]; k < points.first[i + 1]; ++k)
      bears = bears || !c.scratch.bearing[k].force.isZero(T(0));
    for (int j = i; bears && j > 0; j = s.tree.parent[j])
      if (is_weak(j)) return false;
  }
  for (std::size_t m = 0; m < s.muscle_strength.size(); ++m)
    if (s.muscle_strength[m] < T(1)) return false;
  return s.settings.strength >= 1;
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

/// At what height the ground is that bears a grounded animation, after a check of it.
template <class T>
void note_level(CharacterState<T>& s, const CheckContext<T>& c) {
  if (!s.grounded() || !stands(s, c.world, c.plan, c.ground)) return;
  const double root = double(s.target[0].translation.z());
  double lowest = std::numeric_limits<double>::max();
  for (const BearingPoint<T>& p : c.scratch.bearing) {
    if (p.force.isZero(T(0))) continue;
    const double height =
        c.ground ? root + double(p.place.z() - c.ground->room[p.point].gap) : c.world.ground_height;
    lowest = std::min(lowest, height);
  }
  if (lowest < std::numeric_limits<double>::max()) s.grounding.level = lowest - s.grounding.by.z;
}

/// Whether ground and help bear the root of who has only the ground, if need be with a hand. `ask` makes the
/// check, and tells whether the muscles may.
template <class T, class Ask>
bool is_borne(CharacterState<T>& s, const CheckContext<T>& c, const Ask& ask) {
  Grounding<T>& g = s.grounding;
  g.by_hand = false;
  if (!ask()) return false;
  if (!s.may_have_a_hand() || !is_beyond_its_help(s)) return true;
  g.hand = beyond_any_floor(s, c);
  g.by_hand = true;
  if (!ask() || is_beyond_its_help(s)) return false;
  s.set_leads(true);
  return true;
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
bool may_be_led(const CharacterState<T>& s) {
  return s.may_have_a_hand() && !s.deviation[0].released && has_plain_check(s);
}

template <class T>
void lead_root(CharacterState<T>& s, const CheckContext<T>& context) {
  const auto ask = [&] {
    check_animation(s, s.target, context);
    return true;
  };
  if (is_borne(s, context, ask)) {
    note_level(s, context);
    s.set_leads(bears_with_all_its_strength(s, context));
  }
  s.grounding.by_hand = false;  // what it takes, the solve finds
}

template <class T>
void give_hand(CharacterState<T>& s, const CheckContext<T>& context) {
  if (!s.grounded() || !s.floats || s.passive()) return;
  s.grounding.hand = beyond_any_floor(s, context);
  s.refresh_limits();
}

template <class T>
bool play(CharacterState<T>& s, T h, const CheckContext<T>& context) {
  s.set_leads(false);
  if (s.is_struck(T(context.world.accuracy.return_time))) return false;
  const bool plain = has_plain_check(s);
  const auto ask = [&] {
    if (plain) check_animation(s, s.target, context);
    return plain || !asks_for_more(s, h, context, T(1));
  };
  if (!is_borne(s, context, ask)) return false;
  note_level(s, context);
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
  const bool apart = s.grounding.by_hand;  // the check has taken it off before
  const auto size = [&](int first) {
    Vec3<double> sum = Vec3<double>::Zero();
    for (int k = 0; k < 3; ++k)
      sum[k] = double(s.torque[first + k] + (apart ? s.grounding.hand[first + k] : T(0)));
    return sum.norm();
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
  if (s.deferred.motion) jets.resize(std::size_t(s.tree.bodies));
  synchronise(s, std::span<JointJet<T>>(jets));
}

template <class T>
void synchronise(CharacterState<T>& s, std::span<JointJet<T>> jets) {
  s.keep_record();
  if (!s.deferred.motion) return;
  s.deferred.history = s.deferred.motion = false;
  // Speeds of the animation, and on top of them those of what is off it.
  std::copy_n(s.last_target().begin(), s.tree.bodies, jets.begin());
  jets = jets.first(std::size_t(s.tree.bodies));
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
