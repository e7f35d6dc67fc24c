#include <algorithm>
#include <cmath>

#include "sinew/character/check_jet.h"
#include "sinew/character/grounding.h"
#include "sinew/character/state.h"
#include "sinew/character/tone.h"

namespace sinew {
namespace {

constexpr double kHardest = 1e5;  ///< N·s of a human

/// Of a handle that stands for nobody.
Status nobody() {
  return Status::error(Code::kInvalidArgument, "no such character");
}

template <class T>
bool same_pose(const JointJet<T>& a, const JointJet<T>& b) {
  return a.rotation.coeffs() == b.rotation.coeffs() && a.translation == b.translation;
}

/// Gives every joint's muscles that share of their strength.
template <class T, class ActivationOf>
Status activate(CharacterState<T>& s, const ActivationOf& activation_of) {
  bool changes = false;
  for (std::size_t i = 0; i < s.activation.size(); ++i) {
    const T share = activation_of(i);
    changes = changes || share != s.activation[i];
    if (!(share >= T(0) && share <= T(1)))
      return Status::error(Code::kInvalidArgument, "activation must be between 0 and 1", static_cast<int>(i));
  }
  if (!changes) return {};
  for (std::size_t i = 0; i < s.activation.size(); ++i) s.activation[i] = activation_of(i);
  s.refresh_limits();
  s.levels.wake = true;
  return {};
}

}  // namespace

template <class T>
Status Character<T>::set_target(std::span<const JointJet<T>> jets) {
  if (!state_) return nobody();
  if (jets.size() != state_->target.size())
    return Status::error(Code::kInvalidArgument, "target needs one jet per joint of the skeleton");
  for (std::size_t i = 0; i < jets.size(); ++i)
    if (Status status = check_jet(jets[i], static_cast<int>(i)); !status) return status;
  // What is limp has no use for a target, and sleeps on.
  const JointJet<T> root = displaced(state_->grounding.by, jets[0]);
  if (state_->levels.asleep && !state_->passive() &&
      !(same_pose<T>(root, state_->target[0]) &&
        std::equal(jets.begin() + 1, jets.end(), state_->target.begin() + 1, same_pose<T>)))
    state_->levels.wake = true;
  std::vector<JointJet<T>>& target = state_->new_target();
  std::copy(jets.begin(), jets.end(), target.begin());
  target[0] = root;
  return {};
}

template <class T>
Status Character<T>::reset() {
  if (!state_) return nobody();
  Grounding<T>& grounding = state_->grounding;
  if (grounding.by.any()) state_->target[0] = displaced(grounding.by.inverse(), state_->target[0]);
  grounding.by = {};
  grounding.rest = grounding.alone = T(0);
  grounding.level = Grounding<T>().level;
  grounding.returns = false;
  state_->reset_to_target(Vec3<T>::Zero());
  return {};
}

template <class T>
Status Character<T>::set_detail(const CharacterDetail& detail) {
  if (!state_) return nobody();
  if (Status status = validate(detail); !status) return status;
  state_->detail = detail;
  return {};
}

template <class T>
const CharacterDetail& Character<T>::detail() const {
  static const CharacterDetail none;
  if (!state_) return none;
  return state_->detail;
}

template <class T>
Status Character<T>::set_strength(T strength) {
  if (!state_) return nobody();
  if (std::isnan(strength) || strength < T(0))
    return Status::error(Code::kInvalidArgument, "strength must be ≥ 0");
  state_->settings.strength = double(strength);
  state_->refresh_limits();
  state_->levels.wake = true;
  return {};
}

template <class T>
T Character<T>::strength() const {
  return state_ ? T(state_->settings.strength) : T(0);
}

template <class T>
Status Character<T>::set_strength(int joint, T strength) {
  if (!state_) return nobody();
  if (joint < 0 || joint >= state_->tree.bodies)
    return Status::error(Code::kInvalidArgument, "no such simulated joint", joint);
  if (std::isnan(strength) || strength < T(0))
    return Status::error(Code::kInvalidArgument, "strength must be ≥ 0", joint);
  for (int i = joint; i < state_->tree.bodies; ++i) {
    int ancestor = i;
    while (ancestor > joint) ancestor = state_->tree.parent[ancestor];
    if (ancestor == joint) state_->joint_strength[i] = strength;
  }
  state_->refresh_limits();
  state_->levels.wake = true;
  return {};
}

template <class T>
Status Character<T>::set_activation(std::span<const T> activation) {
  if (!state_) return nobody();
  if (activation.size() != state_->skeleton.joints.size())
    return Status::error(Code::kInvalidArgument, "activation needs one number per joint of the skeleton");
  return activate(*state_, [&](std::size_t joint) { return activation[joint]; });
}

template <class T>
Status Character<T>::set_activation(T activation) {
  if (!state_) return nobody();
  return activate(*state_, [&](std::size_t) { return activation; });
}

template <class T>
Status Character<T>::set_self_collision(SelfCollision collision) {
  if (!state_) return nobody();
  if (collision > SelfCollision::kOff) return Status::error(Code::kInvalidArgument, "no such self collision");
  state_->self_collision = collision;
  return {};
}

template <class T>
Status Character<T>::set_muscle_strength(int muscle, T strength) {
  if (!state_) return nobody();
  if (muscle < 0 || muscle >= static_cast<int>(state_->muscle_strength.size()))
    return Status::error(Code::kInvalidArgument, "no such muscle", muscle);
  if (std::isnan(strength) || strength < T(0))
    return Status::error(Code::kInvalidArgument, "strength must be ≥ 0", muscle);
  state_->muscle_strength[muscle] = strength;
  state_->refresh_limits();
  state_->levels.wake = true;
  return {};
}

template <class T>
Status Character<T>::set_group_strength(const char* group, T strength) {
  if (!state_) return nobody();
  const std::vector<Muscle>& muscles = state_->skeleton.muscles;
  bool any = false;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    if (muscles[m].group.empty() || muscles[m].group != group) continue;
    if (Status status = set_muscle_strength(static_cast<int>(m), strength); !status) return status;
    any = true;
  }
  return any ? Status{} : Status::error(Code::kNotFound, "the skeleton has no muscle of that group");
}

template <class T>
Status Character<T>::set_tone(Tone tone) {
  return set_tone(0, tone);
}

template <class T>
Status Character<T>::set_tone(int joint, Tone tone) {
  if (!state_) return nobody();
  if (joint < 0 || joint >= state_->tree.bodies)
    return Status::error(Code::kInvalidArgument, "no such simulated joint", joint);
  if (tone < Tone::kRigid || tone > Tone::kBraced)
    return Status::error(Code::kInvalidArgument, "no such tone", joint);
  state_->set_tone(joint, tone);
  state_->levels.wake = true;
  return {};
}

template <class T>
Status Character<T>::set_tone(int joint, const Stiffness& of) {
  if (!state_) return nobody();
  if (joint < 0 || joint >= state_->tree.bodies)
    return Status::error(Code::kInvalidArgument, "no such simulated joint", joint);
  if (!(of.stiffness > 0) || !(of.damping_ratio >= 0) || !std::isfinite(of.damping_ratio))
    return Status::error(Code::kInvalidArgument, "stiffness must be > 0, damping ratio ≥ 0 and finite",
                         joint);
  if (state_->tree.type[joint] == JointType::kFree)
    return Status::error(Code::kInvalidArgument, "a free joint has no tone", joint);
  reserve_for_tone(*state_);
  const bool muscles = !state_->problem.law.tone.empty();
  for (int dof = state_->tree.first_dof[joint]; muscles && dof < state_->tree.first_dof[joint + 1]; ++dof) {
    state_->problem.law.tone[dof].stiffness = T(of.stiffness);
    state_->problem.law.tone[dof].damping_ratio = T(of.damping_ratio);
  }
  state_->problem.law.refresh_presence();
  state_->levels.wake = true;
  return {};
}

template <class T>
Status Character<T>::set_group_tone(const char* group, Tone tone) {
  if (!state_) return nobody();
  if (tone < Tone::kRigid || tone > Tone::kBraced)
    return Status::error(Code::kInvalidArgument, "no such tone");
  reserve_for_tone(*state_);
  bool any = false;
  for (const Muscle& muscle : state_->skeleton.muscles) {
    if (muscle.group.empty() || muscle.group != group) continue;
    state_->set_tone(muscle.joint, muscle.dof, tone);
    any = true;
  }
  state_->problem.law.refresh_presence();
  state_->levels.wake = state_->levels.wake || any;
  return any ? Status{} : Status::error(Code::kNotFound, "the skeleton has no muscle of that group");
}

template <class T>
Stiffness Character<T>::tone(int dof) const {
  if (!state_ || dof < 0 || dof >= static_cast<int>(state_->problem.law.tone.size())) return {};
  const ToneOfDof<T>& of = state_->problem.law.tone[dof];
  return {double(of.stiffness), double(of.damping_ratio)};
}

template <class T>
T Character<T>::muscle_torque(int muscle) const {
  if (!state_ || muscle < 0 || muscle >= static_cast<int>(state_->muscle_strength.size())) return T(0);
  const Muscle& of = state_->skeleton.muscles[muscle];
  const int dof = state_->tree.first_dof[of.joint] + of.dof;
  const T torque = state_->torque[dof], all = state_->problem.law.limit(dof, torque);
  const T own = state_->muscle_limit(muscle, torque >= T(0) ? of.torque_plus : of.torque_minus);
  if (!(all > T(0))) return T(0);
  return std::isinf(own) ? torque : torque * (own / all);
}

template <class T>
Status Character<T>::set_root_drive(RootDrive drive) {
  if (!state_) return nobody();
  if (drive < RootDrive::kKinematic || drive > RootDrive::kGrounded)
    return Status::error(Code::kInvalidArgument, "no such root drive");
  state_->settings.root = drive;
  state_->refresh_limits();
  state_->levels.wake = true;
  return {};
}

template <class T>
Displacement Character<T>::displacement() const {
  return state_ ? state_->grounding.by : Displacement{};
}

template <class T>
Status Character<T>::take_displacement() {
  if (!state_) return nobody();
  state_->grounding.by = {};
  return {};
}

namespace {

Status check(const Displacement& further, const Displacement& all) {
  if (!std::isfinite(further.x) || !std::isfinite(further.y) || !std::isfinite(further.yaw) ||
      !std::isfinite(further.z))
    return Status::error(Code::kNotFinite, "displacement is not finite");
  constexpr double kFarthest = 1e6;  // m, or rad
  if (std::max({std::abs(all.x), std::abs(all.y), std::abs(all.yaw), std::abs(all.z)}) > kFarthest)
    return Status::error(Code::kOutOfRange, "displacement is beyond 1e6 m, or rad");
  return {};
}

}  // namespace

template <class T>
Status Character<T>::displace(const Displacement& further) {
  if (!state_) return nobody();
  const Status status = check(further, state_->grounding.by.then(further));
  if (status) displace_target(*state_, further);
  return status;
}

template <class T>
Status Character<T>::displace_led(const Displacement& further) {
  if (!state_) return nobody();
  const Displacement all = state_->grounding.by.then(further);
  const Status status = check(further, all);
  if (status) state_->grounding.by = all;
  return status;
}

template <class T>
Status Character<T>::ride(const Displacement& further) {
  const Status status = displace_led(further);
  if (status) state_->grounding.rides = true;
  return status;
}

template <class T>
Status Character<T>::come_back() {
  if (!state_) return nobody();
  state_->grounding.comes_back = true;
  return {};
}

template <class T>
Status Character<T>::give_hand() {
  if (!state_) return nobody();
  state_->grounding.has_hand = true;
  return {};
}

template <class T>
Status Character<T>::keep_out(double most) {
  if (!state_) return nobody();
  if (!(most >= 0)) return Status::error(Code::kInvalidArgument, "a depth that is negative or no number");
  state_->grounding.presses = most;
  return {};
}

template <class T>
Status Character<T>::set_help(double force, double torque) {
  if (!state_) return nobody();
  if (std::isnan(force) || std::isnan(torque)) return Status::error(Code::kNotFinite, "help is not a number");
  Grounding<T>& grounding = state_->grounding;
  if (grounding.help_force == force && grounding.help_torque == torque) return {};
  grounding.help_force = force;
  grounding.help_torque = torque;
  state_->refresh_limits();
  return {};
}

namespace {

/// Appends an impulse or force at a world point on the body of a joint to those of a character.
template <class T>
Status push(CharacterState<T>& s, int joint, const Vec3<T>& point, const Vec3<T>& vector,
            std::vector<ExternalForce<T>>& pushes) {
  if (joint < 0 || joint >= static_cast<int>(s.local.size()))
    return Status::error(Code::kInvalidArgument, "no such joint", joint);
  if (pushes.capacity() == 0)
    return Status::error(Code::kInvalidArgument, "the world declares no Impulses", joint);
  if (pushes.size() == pushes.capacity())
    return Status::error(Code::kOutOfRange, "more than 64 impulses or forces in one step", joint);
  const int body = s.body_of(joint);
  pushes.push_back({body, s.model()[body].inverse() * point, vector});
  return {};
}

}  // namespace

template <class T>
Status Character<T>::apply_impulse(int joint, const Vec3<T>& point, const Vec3<T>& impulse) {
  if (!state_) return nobody();
  if (!point.allFinite() || !impulse.allFinite())
    return Status::error(Code::kNotFinite, "impulse is not finite", joint);
  const Scale<T>& scale = state_->tree.scale;
  if (impulse.norm() > T(kHardest) * std::max(T(1), scale.energy / scale.time))
    return Status::error(Code::kOutOfRange, "impulse above 1e5 N·s of a figure of human size", joint);
  return push(*state_, joint, point, impulse, state_->impulses);
}

template <class T>
Status Character<T>::apply_force(int joint, const Vec3<T>& point, const Vec3<T>& force) {
  if (!state_) return nobody();
  if (!point.allFinite() || !force.allFinite())
    return Status::error(Code::kNotFinite, "force is not finite", joint);
  const Scale<T>& scale = state_->tree.scale;
  if (force.norm() > T(60 * kHardest) * std::max(T(1), scale.energy / scale.length))
    return Status::error(Code::kOutOfRange, "force above 6e6 N of a figure of human size", joint);
  return push(*state_, joint, point, force, state_->forces);
}

template <class T>
const Skeleton& Character<T>::skeleton() const {
  static const Skeleton none;
  if (!state_) return none;
  return state_->skeleton;
}

template <class T>
std::span<const Transform<T>> Character<T>::local() const {
  if (!state_) return {};
  return state_->local;
}

template <class T>
std::span<const Transform<T>> Character<T>::model() const {
  if (!state_) return {};
  return state_->model();
}

template <class T>
Vec3<double> Character<T>::position() const {
  if (!state_) return Vec3<double>::Zero();
  return state_->history.place;
}

template <class T>
std::span<const T> Character<T>::torque() const {
  if (!state_) return {};
  return state_->torque;
}

template <class T>
std::span<const T> Character<T>::load() const {
  if (!state_) return {};
  state_->keep_loads();
  return state_->load;
}

template <class T>
std::span<const T> Character<T>::limit() const {
  if (!state_) return {};
  state_->keep_loads();
  return state_->limit;
}

template <class T>
int Character<T>::first_dof(int joint) const {
  if (!state_ || joint < 0 || joint >= state_->tree.bodies) return -1;
  return state_->tree.first_dof[joint];
}

template <class T>
std::span<const std::uint8_t> Character<T>::unknown() const {
  if (!state_) return {};
  return state_->unknown;
}

template <class T>
bool Character<T>::on_animation() const {
  return state_ && state_->undisturbed();
}

template <class T>
const CharacterReport& Character<T>::report() const {
  static const CharacterReport none;
  if (!state_) return none;
  state_->compute_totals();
  return state_->report;
}

template <class T>
const BearingGround& Character<T>::ground() const {
  static const BearingGround none;
  return state_ ? state_->report.ground : none;
}

template <class T>
std::optional<double> Character<T>::animation_ground() const {
  if (!state_ || state_->grounding.level == Grounding<T>().level) return {};
  return state_->grounding.level;
}

template class Character<float>;
template class Character<double>;

}  // namespace sinew
