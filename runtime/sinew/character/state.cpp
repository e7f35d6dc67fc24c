#include "sinew/character/state.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "sinew/character/contact_finder.h"
#include "sinew/character/cut.h"
#include "sinew/character/tone.h"
#include "sinew/residual/tree_pass.h"
#include "sinew/skeleton/portable_math.h"

namespace sinew {
namespace {

/// rad (0.1°) and m. A joint is on its animation again within these at 1/60 s; in shorter steps within less,
/// so that what is left out is an acceleration that muscles do not notice.
constexpr double kHalfTurn = std::numbers::pi;  ///< rad
constexpr double kFelt = 1e-3 * 2.718;          ///< m · e: see is_struck()
constexpr double kSnapAngle = 2e-3;
constexpr double kSnapRate = 5e-2;  ///< 1/s
constexpr double kSamePath = 4e-3;  ///< 1/s; four times the muscles' rounding

}  // namespace

template <class T>
Rig<T>::Rig(const Skeleton& s, const StepPlan<T>& plan)
    : skeleton(s), tree(skeleton), total_mass(skeleton.total_mass()), radius(T(0.1) * tree.scale.length) {
  for (std::size_t n = 0; n < skeleton.colliders.size(); ++n) {
    Collider on_body = skeleton.colliders[n];
    while (on_body.joint >= skeleton.body_count) {
      on_body.local = skeleton.joints[on_body.joint].rest * on_body.local;
      on_body.joint = skeleton.joints[on_body.joint].parent;
    }
    first_point.push_back(static_cast<int>(points.size()));
    if (plan.contacts)
      plan.contacts->append_points(on_body, points, static_cast<int>(n), double(tree.scale.length));
    colliders.push_back(on_body);
    bound_center.push_back(on_body.local.translation.template cast<T>());
    bound_radius.push_back(T(bounding_radius(on_body)));
  }
  first_point.push_back(static_cast<int>(points.size()));
  if (plan.contacts) plan.contacts->share_stiffness(points);
  if (plan.support) support = plan.support->points(tree, points);
  std::vector<Transform<T>> local;
  for (int i = 0; i < tree.bodies; ++i) local.push_back(skeleton.joints[i].rest.template cast<T>());
  Kinematics<T> rest(tree);
  forward_kinematics<T>(tree, local, Vec3<T>::Zero(), rest);
  if (plan.contacts) choose_self_pairs(rest, *plan.contacts);
  choose_baked();
  measure_reach(rest);
}

/// Joints turn as they like and slide as far as their limits.
template <class T>
void Rig<T>::measure_reach(const Kinematics<T>& rest) {
  body_reach.assign(tree.bodies, T(0));
  for (std::size_t c = 0; c < colliders.size(); ++c) {
    T& reach = body_reach[colliders[c].joint];
    reach = std::max(reach, bound_center[c].norm() + bound_radius[c]);
  }
  for (const ContactPoint<T>& p : points)
    body_reach[p.body] = std::max(body_reach[p.body], p.local.norm() + p.half_axis.norm() + p.radius);
  std::vector<T> chain(tree.bodies, T(0));  // from the root's origin to the joint, stretched
  for (int i = 0; i < tree.bodies; ++i) {
    const int parent = tree.parent[i];
    chain[i] = parent < 0 ? (rest.origin[i] - rest.origin[0]).norm()
                          : chain[parent] + T(skeleton.joints[i].rest.translation.norm());
    for (int k = 0; k < tree.dof_count(i); ++k) {
      const DofLimits& dof = skeleton.joints[i].dofs[k];
      const double slide = std::max(std::abs(dof.lower), std::abs(dof.upper));
      if (parent >= 0 && slide < 1e9 && slides(tree, tree.first_dof[i] + k)) chain[i] += T(slide);
    }
    if (body_reach[i] > T(0)) radius = std::max(radius, chain[i] + body_reach[i]);
  }
}

/// Ends of limbs, by what they mean on a body; where nothing says so, the last joints.
template <class T>
void Rig<T>::choose_baked() {
  bakes.assign(tree.bodies, 0);
  std::vector<std::uint8_t> last(tree.bodies, 1);
  bool any = false;
  for (int i = 0; i < tree.bodies; ++i) {
    const Role role = skeleton.joints[i].role;
    bakes[i] = role == Role::kHandL || role == Role::kHandR || role == Role::kFootL || role == Role::kFootR ||
               role == Role::kToesL || role == Role::kToesR;
    any = any || bakes[i];
    if (tree.parent[i] >= 0 && tree.dof_count(i) > 0) last[tree.parent[i]] = 0;
  }
  for (int i = 0; i < tree.bodies && !any; ++i)
    bakes[i] = last[i] && tree.parent[i] > 0 && tree.dof_count(i) > 0;
}

template <class T>
CharacterState<T>::CharacterState(std::shared_ptr<const Rig<T>> of, const CharacterSettings& c,
                                  const StepPlan<T>& plan)
    : rig(std::move(of)),
      skeleton(rig->skeleton),
      tree(rig->tree),
      total_mass(rig->total_mass),
      colliders(rig->colliders),
      bound_center(rig->bound_center),
      bound_radius(rig->bound_radius),
      points(rig->points),
      first_point(rig->first_point),
      may_touch(rig->may_touch),
      radius(rig->radius),
      settings(c),
      detail(c.detail),
      target(skeleton.joints.size()),
      target_before(skeleton.joints.size()),
      local(skeleton.joints.size()),
      model_pose(skeleton.joints.size()),
      played_from(skeleton.joints.size()),
      rate(tree.bodies),
      rate_before(tree.bodies),
      deviation(tree.bodies),
      joint_strength(tree.bodies, T(1)),
      muscle_strength(skeleton.muscles.size(), T(1)),
      activation(tree.bodies, T(1)),
      torque(tree.dofs, T(0)),
      load(tree.dofs, T(0)),
      limit(tree.dofs, T(0)),
      smooth(tree.dofs, T(0)),
      lasting(tree.dofs, T(0)),
      lasting_before(tree.dofs, T(0)),
      unknown(tree.dofs, 0),
      problem(tree, skeleton),
      guessed(tree),
      history(tree.bodies),
      motion(tree),
      baked(tree.bodies, 0),
      wanted(tree.bodies) {
  floats = tree.type[0] == JointType::kFree && std::count(tree.parent.begin(), tree.parent.end(), -1) == 1;
  if (plan.impulses)
    for (auto* v : {&impulses, &forces}) v->reserve(64);
  for (std::size_t i = 0; i < skeleton.joints.size(); ++i) {
    const Transform<T> rest = skeleton.joints[i].rest.template cast<T>();
    target[i].rotation = rest.rotation;
    target[i].translation = rest.translation;
  }
  report.dofs = tree.dofs;
  set_tone(0, settings.tone);
  refresh_limits();
  reset_to_target(Vec3<T>::Zero());
}

/// Colliders of one body, of neighbours, and those that overlap at rest never touch: joints hold them.
template <class T>
void Rig<T>::choose_self_pairs(const Kinematics<T>& rest, const ContactTerm<T>& contacts) {
  const int count = static_cast<int>(colliders.size());
  may_touch.assign(std::size_t(count) * count, 0);
  const auto moving = [&](int body) {  // the body itself, or what it is fixed to
    while (body > 0 && tree.dof_count(body) == 0) body = tree.parent[body];
    return body;
  };
  const double clearance = 0.01 * double(tree.scale.length);  // m
  for (int a = 0; a < count; ++a)
    for (int b = 0; b < count; ++b) {
      const int i = moving(colliders[a].joint), j = moving(colliders[b].joint);
      const auto above = [&](int body) { return tree.parent[body] < 0 ? -1 : moving(tree.parent[body]); };
      if (i == j || above(i) == j || above(j) == i) continue;
      bool apart = true;
      for (int k = first_point[a]; k < first_point[a + 1] && apart; ++k) {
        if (!points[k].meets(colliders[b].shape)) continue;
        Contact<T> c;
        c.body_a = points[k].body;
        c.local_a = points[k].local;
        c.half_axis_a = points[k].half_axis;
        c.radius = points[k].radius;
        c.body_b = colliders[b].joint;
        c.shape = colliders[b].shape;
        c.size = colliders[b].size.template cast<T>();
        c.hull = colliders[b].hull;
        c.shape_pose = colliders[b].local.template cast<T>();
        contacts.measure(rest, &rest, c);
        apart = c.gap > T(clearance);
      }
      may_touch[std::size_t(a) * count + b] = apart;
    }
  for (int a = 0; a < count; ++a)
    for (int b = 0; b < a; ++b) {
      std::uint8_t &one = may_touch[std::size_t(a) * count + b], &two = may_touch[std::size_t(b) * count + a];
      one = two = one && two;
    }
}

namespace {

/// Of 0 and infinity, 0 wins: a dead muscle stays dead in a character that only plays.
template <class T>
T scaled(double limit_at_rest, T strength) {
  return limit_at_rest > 0 && strength > T(0) ? T(limit_at_rest) * strength : T(0);
}

}  // namespace

template <class T>
T CharacterState<T>::muscle_limit(int muscle, double limit_at_rest) const {
  const T own = scaled<T>(limit_at_rest, muscle_strength[muscle]);
  return scaled<T>(double(own), strength_of(skeleton.muscles[muscle].joint));
}

template <class T>
double CharacterState<T>::help_at_most(bool force) const {
  constexpr double kHumanMass = 75, kLeast = 1e-3;  // with none at all there would be no animation to follow
  if (const double asked = force ? grounding.help_force : grounding.help_torque; asked >= 0)
    return std::max(asked, kLeast);
  const double weight = total_mass / kHumanMass;
  return weight *
         std::max(force ? settings.help_force : settings.help_torque * double(tree.scale.length), kLeast);
}

template <class T>
void CharacterState<T>::refresh_limits() {
  keep_loads();
  for (int i = 0; i < tree.bodies; ++i) {
    const Joint& joint = skeleton.joints[i];
    const bool root = joint.type == JointType::kFree;
    const T strength = strength_of(i);
    for (int k = 0; k < tree.dof_count(i); ++k) {
      const int dof = tree.first_dof[i] + k;
      T minus = scaled(joint.dofs[k].torque_minus, strength),
        plus = scaled(joint.dofs[k].torque_plus, strength);
      if (root) {
        const bool assisted = settings.root == RootDrive::kAssisted && !is_prop;
        minus = plus = assisted ? T(k < 3 ? settings.root_force : settings.root_torque) : T(0);
        if (grounded()) {
          const Vec3<T>& hand = k < 3 ? grounding.hand.force : grounding.hand.moment;
          const double given = grounding.has_hand ? double(hand.norm()) : 0;
          minus = plus = scaled(help_at_most(k < 3) + given, root_strength());
        }
        if (grounded() && grounding.leads) minus = plus = std::numeric_limits<T>::infinity();
      }
      problem.law.torque_minus[dof] = minus;
      problem.law.torque_plus[dof] = plus;
    }
  }
  for (std::size_t m = 0; m < skeleton.muscles.size(); ++m) {
    const Muscle& muscle = skeleton.muscles[m];
    const int dof = tree.first_dof[muscle.joint] + muscle.dof;
    problem.law.torque_minus[dof] += muscle_limit(static_cast<int>(m), muscle.torque_minus);
    problem.law.torque_plus[dof] += muscle_limit(static_cast<int>(m), muscle.torque_plus);
  }
  problem.law.refresh_presence();
  driven = !is_prop;
  const int first = root_is_kinematic() && tree.type[0] == JointType::kFree ? tree.dof_count(0) : 0;
  for (int dof = first; dof < tree.dofs; ++dof)
    driven = driven && problem.law.torque_minus[dof] > T(0) && problem.law.torque_plus[dof] > T(0);
  limited = false;
  for (int i = first > 0 ? 1 : 0; i < tree.bodies; ++i) limited = limited || joint_is_limited(i);
}

template <class T>
bool CharacterState<T>::joint_is_limited(int body) const {
  bool muscle = false, boundless = true;
  for (int dof = tree.first_dof[body]; dof < tree.first_dof[body + 1]; ++dof) {
    muscle = muscle || problem.law.has_muscle(dof);
    boundless =
        boundless && std::isinf(problem.law.torque_minus[dof]) && std::isinf(problem.law.torque_plus[dof]);
  }
  return muscle && !boundless;
}

template <class T>
void CharacterState<T>::keep_loads() {
  for (int dof = 0; deferred.loads && dof < tree.dofs; ++dof) {
    limit[dof] = problem.law.limit(dof, torque[dof]);
    load[dof] = problem.law.load(tree, tree.dof_body[dof], dof, torque);
  }
  deferred.loads = false;
}

template <class T>
void CharacterState<T>::keep_record() {
  keep_loads();
  for (int i = 0; deferred.rates && i < tree.bodies; ++i) {
    rate[i] = joint_offset_value<T>(tree, i, played_from[i], local[i]);
    for (T& r : rate[i]) r /= deferred.h;
  }
  deferred.rates = false;
  if (!deferred.history || deferred.motion) return;
  deferred.history = false;
  // Once more: a check that failed since has left the motion of another target.
  const Vec3<T>& origin = last_target()[0].translation;
  inertial_wrenches<T>(tree, last_target(), Vec3<T>::Zero(), origin, problem.kinematics, motion,
                       problem.force, problem.moment);
  advance_exactly<T>(tree, problem.kinematics, motion, deferred.h, Vec3<T>::Zero(),
                     origin.template cast<double>(), history);
}

template <class T>
void CharacterState<T>::compute_totals() {
  if (!deferred.totals) return;
  report_totals(totals<T>(tree, last_target(), deferred.gravity, problem.kinematics, motion));
}

template <class T>
void CharacterState<T>::read_root_rate() {
  if (!floats) return;
  const Mat3<T>& r = history.rotation[0];
  const Vec3<T> spin = tree.inverse_inertia[0] * (r.transpose() * history.momentum[0]);  // child's axes
  const Vec3<T> velocity = history.velocity[0] - Vec3<T>(r * spin).cross(history.center[0]);
  for (int a = 0; a < 3; ++a) {
    rate[0][a] = velocity[a];
    rate[0][3 + a] = spin[a];
  }
}

template <class T>
void CharacterState<T>::report_totals(const Vec3<double>& gravity) {
  report_totals(totals<T>(tree, history, gravity));
}

template <class T>
void CharacterState<T>::report_totals(const Totals& sum) {
  deferred.totals = false;
  report.kinetic_energy = sum.kinetic_energy;
  report.potential_energy = sum.potential_energy;
  report.momentum = sum.momentum;
  report.angular_momentum = sum.angular_momentum;
}

template <class T>
void CharacterState<T>::pose_changed() {
  model_deferred = true;
  if (is_particles) bound_particles();
}

template <class T>
void CharacterState<T>::update_model() {
  model_deferred = false;
  for (std::size_t i = 0; i < local.size(); ++i) {
    const int parent = skeleton.joints[i].parent;
    model_pose[i] = parent < 0 ? local[i] : model_pose[parent] * local[i];
    model_pose[i].rotation.normalize();
  }
}

/// Particles go anywhere: their bounding ball is that of the box around them.
template <class T>
void CharacterState<T>::bound_particles() {
  Vec3<T> least = model()[1].translation, most = least;
  for (std::size_t i = 2; i < model_pose.size(); ++i) {
    least = least.cwiseMin(model_pose[i].translation);
    most = most.cwiseMax(model_pose[i].translation);
  }
  particles_middle = T(0.5) * (least + most);
  radius = T(0.5) * (most - least).norm() + (bound_radius.empty() ? T(0) : bound_radius[0]);
}

template <class T>
T CharacterState<T>::pace() const {
  return is_particles ? fastest() : history.velocity[0].norm();
}

template <class T>
void CharacterState<T>::reset_to_target(const Vec3<T>& gravity) {
  keep_record();
  compute_totals();
  for (std::size_t i = 0; i < local.size(); ++i) local[i] = {target[i].rotation, target[i].translation};
  target_stands = true;
  pose_changed();
  const Vec3<T>& origin = target[0].translation;
  inertial_wrenches<T>(tree, target, gravity, origin, problem.kinematics, motion, problem.force,
                       problem.moment);
  advance_exactly<T>(tree, problem.kinematics, motion, T(0), gravity, origin.template cast<double>(),
                     history);
  history.step_before = T(0);
  history.accelerates = false;
  for (int i = 0; i < tree.bodies; ++i) {
    deviation[i] = {};
    const Vec3<T>& w = target[i].omega;
    const Vec3<T>& v = target[i].velocity;
    rate[i] = {};
    switch (tree.type[i]) {
      case JointType::kRevolute:
        rate[i][0] = tree.axis[i].dot(w);
        break;
      case JointType::kBall:
        rate[i] = {w.x(), w.y(), w.z()};
        break;
      case JointType::kFree:
        rate[i] = {v.x(), v.y(), v.z(), w.x(), w.y(), w.z()};
        break;
      case JointType::kTranslation:
        rate[i] = {v.x(), v.y(), v.z()};
        break;
      default:
        break;  // starts from rest: only the first guess of the first step
    }
  }
  clear_deviations();
  forget_contacts();
  levels.wake = levels.wake || levels.asleep;  // for those who slept with it
  levels.asleep = false;
  deferred = {};
  levels.still = 0;
  std::fill(unknown.begin(), unknown.end(), std::uint8_t{0});
}

template <class T>
void CharacterState<T>::forget_contacts() {
  rate_step = T(0);
  contact_signature = limit_signature = 0;
  steps_unchanged = 0;
  collision_suspended = 0;
  unsolved = 0;
  forget_energy();
}

namespace {

/// The part of a joint's offset (see joint_offset) that is a rotation vector or angle.
template <class T>
std::span<T> turn_of(JointType type, std::array<T, 6>& offset) {
  const std::size_t first = type == JointType::kFree ? 3 : 0;
  const bool ball = type == JointType::kBall || type == JointType::kFree;
  return std::span(offset).subspan(first, ball ? 3 : type == JointType::kRevolute ? 1 : 0);
}

/// Rates, with a rotation vector's by a matrix of that.
template <class T, class Matrix>
std::array<T, 6> turned_by(JointType type, std::array<T, 6> offset, std::array<T, 6> rate,
                           const Matrix& matrix_of) {
  const std::span<T> turn = turn_of(type, offset), turning = turn_of(type, rate);
  if (turn.size() < 3) return rate;
  const Vec3<T> turned = matrix_of({turn[0], turn[1], turn[2]}) * Vec3<T>(turning[0], turning[1], turning[2]);
  for (int a = 0; a < 3; ++a) turning[a] = turned[a];
  return rate;
}

template <class T>
T length(std::span<const T> v) {
  T squares = T(0);
  for (const T x : v) squares += x * x;
  return std::sqrt(squares);
}

/// An offset that goes on from `near`, by the turn that a rotation does not show: a limb that swings through
/// the far side of its animation does not leap to the other.
template <class T>
std::array<T, 6> continued(JointType type, std::array<T, 6> offset, std::array<T, 6> near) {
  const std::span<T> turn = turn_of(type, offset), last = turn_of(type, near);
  const T angle = length<T>(turn);
  if (!(angle > T(kHalfTurn) / 4)) return offset;
  const T other = 1 - T(2 * kHalfTurn) / angle;
  T way = T(0), other_way = T(0);
  for (std::size_t k = 0; k < turn.size(); ++k) {
    way += (turn[k] - last[k]) * (turn[k] - last[k]);
    other_way += (other * turn[k] - last[k]) * (other * turn[k] - last[k]);
  }
  if (other_way < way)
    for (T& x : turn) x *= other;
  return offset;
}

}  // namespace

template <class T>
std::array<T, 6> spin_of_rate(JointType type, const std::array<T, 6>& offset, std::array<T, 6> rate) {
  return turned_by(type, offset, rate, [](const Vec3<T>& v) { return right_jacobian<T>(v); });
}

template <class T>
std::array<T, 6> rate_of_spin(JointType type, const std::array<T, 6>& offset, std::array<T, 6> spin) {
  return turned_by(type, offset, spin, [](const Vec3<T>& v) { return right_jacobian_inverse<T>(v); });
}

template <class T>
void CharacterState<T>::update_deviation(int i, const std::array<T, 6>& measured, T h, T return_time) {
  Deviation<T>& d = deviation[i];
  std::array<T, 6> from_animation = continued(tree.type[i], measured, d.offset);
  // The return is no longer than three quarters of a turn, nor than need be where no muscle has begun it.
  const bool around =
      !joint_is_driven(i) || length<T>(turn_of(tree.type[i], from_animation)) > T(1.5 * kHalfTurn);
  const T time = tree.scale.time;
  return_time *= time;
  const T decay = portable::exp(-h / return_time), same = T(kSamePath) * (h / time);
  T offset = T(0), speed = T(0);
  d.on_path = true;
  for (int k = 0; k < tree.dof_count(i); ++k) {
    // On the return (no saturated muscle is) the rate is the path's at its end; its mean over the step
    // would start the next part of the path too fast or too slow by an error of first order.
    const T pull = d.rate[k] + d.offset[k] / return_time;
    const T unit = slides(tree, tree.first_dof[i] + k) ? tree.scale.length : T(1);
    const bool on_path = !d.on_animation && load[tree.first_dof[i] + k] < T(0.99) &&
                         std::abs(from_animation[k] - (d.offset[k] + pull * h) * decay) < same * unit;
    d.rate[k] =
        on_path ? (d.rate[k] - pull * h / return_time) * decay : (from_animation[k] - d.offset[k]) / h;
    d.on_path = d.on_path && on_path;
    offset = std::max(offset, std::abs(measured[k]) / unit);
    speed = std::max(speed, time * std::abs(d.rate[k]) / unit);
  }
  if (around && from_animation != measured)
    d.rate = rate_of_spin<T>(tree.type[i], measured, spin_of_rate<T>(tree.type[i], from_animation, d.rate));
  d.offset = around ? measured : from_animation;
  const T fine = std::min(60 * (h / time), T(1));
  const T snap = std::max(T(kSnapAngle) * fine * fine, 16 * std::numeric_limits<T>::epsilon());
  d.on_animation = !d.released && offset < snap && speed < T(kSnapRate) * fine;
  if (!d.on_animation) return;
  d.offset = {};
  d.rate = {};
}

template <class T>
void CharacterState<T>::keep_deviations(T h) {
  if (!deferred.deviations || only_falls()) return;
  deferred.deviations = false;
  for (int i = 0; i < tree.bodies; ++i) {
    const JointJet<T>& jet = target[i];
    const Transform<T> ago = a_step_ago(jet, h), before = in_solve(i, ago, history.place),
                       after = in_solve(i, {jet.rotation, jet.translation}, history.place);
    if (tree.dof_count(i) > 0) restart(ago, jet, own_last_target()[i]);
    Transform<T> now = local[i];
    if (i == 0 && floats) now.translation.setZero();
    std::array<T, 6> coasting = rate[i];
    for (T& r : coasting) r *= h;
    Deviation<T>& d = deviation[i];
    d = {};
    d.offset = joint_offset_value<T>(tree, i, before, now);
    d.rate = continued(tree.type[i],
                       joint_offset_value<T>(tree, i, after, at_offset<T>(tree, i, now, coasting)), d.offset);
    for (int k = 0; k < 6; ++k) d.rate[k] = (d.rate[k] - d.offset[k]) / h;
    d.released = tree.dof_count(i) > 0;
    d.on_animation = !d.released;
  }
  clear_deviations();
}

template <class T>
void CharacterState<T>::clear_deviations() {
  calm = std::all_of(deviation.begin(), deviation.end(),
                     [](const Deviation<T>& d) { return d.on_animation && !d.released; });
}

template <class T>
bool CharacterState<T>::joint_is_driven(int body) const {
  bool all = problem.law.present.muscles || tree.dof_count(body) == 0;
  for (int dof = tree.first_dof[body]; all && dof < tree.first_dof[body + 1]; ++dof)
    all = problem.law.torque_minus[dof] > T(0) && problem.law.torque_plus[dof] > T(0);
  return all;
}

template <class T>
bool CharacterState<T>::joint_has_tone(int body) const {
  const JointLaw<T>& law = problem.law;
  for (int dof = tree.first_dof[body]; law.present.tone && dof < tree.first_dof[body + 1]; ++dof)
    if (law.has_tone(dof)) return joint_is_driven(body);
  return false;
}

template <class T>
void CharacterState<T>::set_tone(int joint, Tone tone) {
  if (tone != Tone::kRigid) reserve_for_tone(*this);
  if (problem.law.tone.empty()) return;
  for (int i = joint; i < tree.bodies; ++i) {
    int ancestor = i;
    while (ancestor > joint) ancestor = tree.parent[ancestor];
    for (int k = 0; ancestor == joint && k < tree.dof_count(i); ++k) set_tone(i, k, tone);
  }
  problem.law.refresh_presence();
}

template <class T>
void CharacterState<T>::set_tone(int joint, int dof, Tone tone) {
  const Scale<double> scale{double(tree.scale.length), double(tree.scale.time), double(tree.scale.energy),
                            double(tree.scale.load)};
  const Stiffness of = stiffness_of(skeleton, scale, joint, dof, tone);
  ToneOfDof<T>& mine = problem.law.tone[tree.first_dof[joint] + dof];
  mine.stiffness = T(of.stiffness);
  mine.damping_ratio = T(of.damping_ratio);
}

template <class T>
T CharacterState<T>::fastest() const {
  T square = T(0);
  for (const Vec3<T>& v : history.velocity) square = std::max(square, v.squaredNorm());
  return std::sqrt(square);
}

template <class T>
bool CharacterState<T>::is_struck(T return_time) const {
  if (impulses.empty()) return false;
  if (passive()) return true;
  const auto moves = [&](const ExternalForce<T>& impulse) {
    return impulse.force.norm() * return_time * tree.scale.time >
           T(kFelt) * tree.scale.length * tree.mass[impulse.body];
  };
  return std::any_of(impulses.begin(), impulses.end(), moves);
}

template <class T>
bool CharacterState<T>::passive() const {
  return !root_is_kinematic() && !problem.law.present.muscles;
}

template <class T>
int CharacterState<T>::body_of(int joint) const {
  while (joint >= skeleton.body_count) joint = skeleton.joints[joint].parent;
  return joint;
}

SINEW_RATE_INSTANCES(template, float)
SINEW_RATE_INSTANCES(template, double)
template struct Rig<float>;
template struct Rig<double>;
template struct CharacterState<float>;
template struct CharacterState<double>;

}  // namespace sinew
