#include "sinew/character/world.h"

#include <algorithm>
#include <cmath>

#include "sinew/character/couplings.h"
#include "sinew/character/cut.h"
#include "sinew/character/island.h"
#include "sinew/character/snapshot.h"
#include "sinew/effects/support.h"

namespace sinew {

namespace {

/// A particle body: its tree, its elements, and where its frame is fixed.
struct ParticleSet {
  ParticleBody body;
  std::vector<int> bodies;  ///< see bodies_of_nodes
  int state = 0, coupling = 0;
  Place place;
};

}  // namespace

template <class T>
struct World<T>::Impl {
  WorldSettings settings;
  std::vector<std::unique_ptr<CharacterState<T>>>
      states;                          ///< characters and props in the order they were added
  std::vector<int> characters, props;  ///< into states
  Couplings<T> couplings;
  std::vector<int> loops;  ///< into couplings
  std::vector<ParticleSet> particles;
  std::vector<Collider> obstacles;
  std::vector<HostObstacle> hosts;
  IslandStepper<T> stepper;
  std::vector<LaggedForce<T>> lagged, lagged_new;
  std::vector<int> group;  ///< [state] island, or -1 where the state is on its own animation
  std::vector<CharacterState<T>*> members;
  std::vector<int> member_indices;

  void reserve();
  Status add_effect(CharacterState<T>& state, std::unique_ptr<Effect<T>> effect);
  void add_effect_wrenches(CharacterState<T>& state, const Vec3<T>& origin, T h) const;
  bool play(CharacterState<T>& state, T h);
  bool near(const CharacterState<T>& a, const CharacterState<T>& b, T h) const;
  bool near_obstacle(const CharacterState<T>& state, T h) const;
  void step_once(T h);
  MovingParts<T> moving() { return {states, lagged, couplings.all()}; }
  Status find(const Anchor& anchor, Place& out) const;
  Transform<double> frame_of(const Place& place) const;
  double weight_of(const Place& place) const;
};

template <class T>
World<T>::World(const WorldSettings& settings) : impl_(std::make_unique<Impl>()) {
  impl_->settings = settings;
}

template <class T>
World<T>::~World() = default;

template <class T>
void World<T>::Impl::reserve() {
  SolveSize most;
  int points = 0, shapes = 0;
  for (const auto& s : states) {
    most.add(s->tree);
    points += static_cast<int>(s->points.size());
    shapes += static_cast<int>(s->skeleton.colliders.size());
    for (const auto& effect : s->effects) most.effect_rows += effect->most_rows();
  }
  // Every point may touch the floor, an obstacle, and a few shapes of others; what does not fit is dropped
  // furthest last.
  const int contacts = points * (2 + static_cast<int>(obstacles.size() + hosts.size())) +
                       std::min(points * shapes, 4 * points + 64);
  most.contacts = contacts;
  couplings.add_room(states, most);
  stepper.reserve(most, shapes);
  lagged.reserve(contacts);
  lagged_new.reserve(contacts);
  group.reserve(states.size());
  members.reserve(states.size());
  member_indices.reserve(states.size());
}

template <class T>
int World<T>::add_character(const Skeleton& skeleton, const CharacterSettings& settings, Status& status) {
  status = validate(skeleton);
  if (!status) return -1;
  if (std::isnan(settings.strength) || settings.strength < 0 || !(settings.root_force >= 0) ||
      !(settings.root_torque >= 0)) {
    status = Status::error(Code::kInvalidArgument, "strength and root drive limits must be ≥ 0");
    return -1;
  }
  impl_->states.push_back(std::make_unique<CharacterState<T>>(skeleton, settings));
  impl_->characters.push_back(static_cast<int>(impl_->states.size()) - 1);
  impl_->reserve();
  return static_cast<int>(impl_->characters.size()) - 1;
}

namespace {

/// Solid inertia of a shape about its centre, kg·m².
Mat3<double> solid_inertia(Shape shape, const Vec3<double>& size, double mass) {
  Vec3<double> diagonal = Vec3<double>::Zero();
  switch (shape) {
    case Shape::kSphere:
      diagonal.setConstant(0.4 * mass * size.x() * size.x());
      break;
    case Shape::kCapsule: {  // cylinder and two half balls by volume
      const double r = size.x(), l = 2 * size.z();
      const double cylinder = mass * l / (l + 4.0 / 3.0 * r), caps = mass - cylinder;
      const double along = cylinder * r * r / 2 + caps * 0.4 * r * r;
      const double across =
          cylinder * (r * r / 4 + l * l / 12) + caps * (0.4 * r * r + l * l / 4 + 0.375 * l * r);
      diagonal = {across, across, along};
      break;
    }
    case Shape::kBox: {
      const Vec3<double> square = size.cwiseProduct(size) * (mass / 3);
      diagonal = {square.y() + square.z(), square.x() + square.z(), square.x() + square.y()};
      break;
    }
  }
  return diagonal.asDiagonal();
}

}  // namespace

template <class T>
int World<T>::add_prop(const PropSettings& prop, Status& status) {
  Skeleton body;
  body.name = "prop";
  body.body_count = 1;
  Joint& joint = body.joints.emplace_back();
  joint.name = "prop";
  joint.type = JointType::kFree;
  joint.rest = prop.pose;
  joint.mass = prop.mass;
  joint.inertia = solid_inertia(prop.shape, prop.size, prop.mass);
  Collider collider;
  collider.shape = prop.shape;
  collider.size = prop.size;
  collider.friction = prop.friction;
  collider.restitution = prop.restitution;
  body.colliders.push_back(collider);
  status = prop.mass > 0 ? validate(body) : Status::error(Code::kInvalidArgument, "prop needs a mass");
  if (status && !(prop.velocity.allFinite() && prop.angular_velocity.allFinite()))
    status = Status::error(Code::kNotFinite, "prop velocity is not finite");
  if (!status) return -1;
  CharacterSettings limp;
  limp.root = RootDrive::kFree;
  impl_->states.push_back(std::make_unique<CharacterState<T>>(body, limp));
  impl_->states.back()->is_prop = true;
  impl_->states.back()->refresh_limits();
  impl_->props.push_back(static_cast<int>(impl_->states.size()) - 1);
  impl_->reserve();
  const int index = static_cast<int>(impl_->props.size()) - 1;
  set_prop(index, prop.pose.template cast<T>(), prop.velocity.template cast<T>(),
           prop.angular_velocity.template cast<T>());
  return index;
}

template <class T>
void World<T>::set_prop(int index, const Transform<T>& pose, const Vec3<T>& velocity,
                        const Vec3<T>& angular_velocity) {
  CharacterState<T>& s = *impl_->states[impl_->props[index]];
  s.parked = false;
  JointJet<T>& jet = s.target[0];
  jet = {};
  jet.rotation = pose.rotation;
  jet.translation = pose.translation;
  jet.velocity = velocity;
  jet.omega = pose.rotation.conjugate() * angular_velocity;
  s.reset_to_target(Vec3<T>::Zero());
}

template <class T>
Status World<T>::Impl::add_effect(CharacterState<T>& state, std::unique_ptr<Effect<T>> effect) {
  if (!effect) return Status::error(Code::kInvalidArgument, "no effect");
  if (Status status = effect->attach(state.skeleton, state.tree); !status) return status;
  state.problem.plan(*effect);
  state.effects.push_back(std::move(effect));
  reserve();
  return {};
}

template <class T>
Status World<T>::add_effect(int character, std::unique_ptr<Effect<T>> effect) {
  return impl_->add_effect(*impl_->states[impl_->characters[character]], std::move(effect));
}

template <class T>
Status World<T>::add_prop_effect(int prop, std::unique_ptr<Effect<T>> effect) {
  return impl_->add_effect(*impl_->states[impl_->props[prop]], std::move(effect));
}

template <class T>
void World<T>::remove_effects(int character) {
  CharacterState<T>& s = *impl_->states[impl_->characters[character]];
  s.problem.effects.clear();
  s.problem.effect_rows.clear();
  s.problem.stiff = false;
  s.effects.clear();
}

template <class T>
void World<T>::park_prop(int index) {
  impl_->states[impl_->props[index]]->parked = true;
}

template <class T>
Status World<T>::add_obstacle(const Collider& obstacle) {
  if (!obstacle.size.allFinite() || obstacle.size.minCoeff() < 0 || !obstacle.local.translation.allFinite() ||
      !obstacle.local.rotation.coeffs().allFinite())
    return Status::error(Code::kInvalidArgument, "obstacle has no meaningful size or place");
  impl_->obstacles.push_back(obstacle);
  impl_->reserve();
  return {};
}

template <class T>
Status World<T>::add_obstacle(const StaticShape& shape, double friction, double restitution) {
  if (!(friction >= 0) || !(restitution >= 0 && restitution <= 1))
    return Status::error(Code::kInvalidArgument,
                         "obstacle's friction must be ≥ 0, its restitution in [0, 1]");
  const SignedDistance<double> probe = shape.distance(Vec3<double>::Zero());
  if (!std::isfinite(probe.distance) || std::abs(probe.normal.norm() - 1) > 1e-6)
    return Status::error(Code::kInvalidArgument, "obstacle's distance at the origin is no distance");
  impl_->hosts.push_back({&shape, friction, restitution});
  impl_->reserve();
  return {};
}

template <class T>
Status World<T>::Impl::find(const Anchor& anchor, Place& out) const {
  const auto state_of = [&](const std::vector<int>& list) {
    return anchor.index >= 0 && anchor.index < static_cast<int>(list.size()) ? list[anchor.index] : -1;
  };
  out = {-1, 0, anchor.frame};
  switch (anchor.kind) {
    case AnchorKind::kWorld:
      return {};
    case AnchorKind::kProp:
      out.state = state_of(props);
      break;
    case AnchorKind::kCharacter: {
      out.state = state_of(characters);
      if (out.state < 0) break;
      const CharacterState<T>& s = *states[out.state];
      if (anchor.joint < 0 || anchor.joint >= static_cast<int>(s.skeleton.joints.size()))
        return Status::error(Code::kInvalidArgument, "no such joint to fix to", anchor.joint);
      // A joint that rides along is part of the body above it.
      out.body = s.body_of(anchor.joint);
      for (int j = anchor.joint; j != out.body; j = s.skeleton.joints[j].parent)
        out.frame = s.skeleton.joints[j].rest * out.frame;
      break;
    }
    case AnchorKind::kParticles: {
      if (anchor.index < 0 || anchor.index >= static_cast<int>(particles.size())) break;
      const ParticleSet& set = particles[anchor.index];
      if (anchor.joint < 0 || anchor.joint >= static_cast<int>(set.body.nodes.size()))
        return Status::error(Code::kInvalidArgument, "no such particle to fix to", anchor.joint);
      out.state = set.state;
      out.body = set.bodies[anchor.joint];
      if (out.body < 0) return Status::error(Code::kInvalidArgument, "the particle is fixed", anchor.joint);
      break;
    }
  }
  if (out.state < 0)
    return Status::error(Code::kInvalidArgument, "nothing with this index to fix to", anchor.index);
  return {};
}

template <class T>
Transform<double> World<T>::Impl::frame_of(const Place& place) const {
  if (place.state < 0) return place.frame;
  return states[place.state]->model[place.body].template cast<double>() * place.frame;
}

/// N, of all that hangs together with a place.
template <class T>
double World<T>::Impl::weight_of(const Place& place) const {
  const double mass = place.state < 0 ? 0 : states[place.state]->total_mass;
  return mass * std::max(1.0, settings.gravity.norm());
}

template <class T>
int World<T>::add_loop(const LoopSettings& loop, Status& status) {
  Place a, b;
  status = check(loop);
  if (status) status = impl_->find(loop.a, a);
  if (status) status = impl_->find(loop.b, b);
  if (status && a.state < 0 && b.state < 0)
    status = Status::error(Code::kInvalidArgument, "a loop from the world to the world");
  if (!status) return -1;
  const double weight = std::max(impl_->weight_of(a), impl_->weight_of(b));
  impl_->loops.push_back(impl_->couplings.add(make_loop<T>(loop, a, b, weight)));
  if (!loop.collide && a.state >= 0 && b.state >= 0)
    impl_->couplings.keep_apart({a.state, a.body, b.state, b.body});
  impl_->reserve();
  return static_cast<int>(impl_->loops.size()) - 1;
}

template <class T>
void World<T>::set_loop(int index, bool closed) {
  Coupling<T>& loop = impl_->couplings[impl_->loops[index]];
  loop.active = closed;
  for (CouplingNode<T>& node : loop.nodes) node.gradient.setZero();
}

template <class T>
double World<T>::loop_gap(int index) const {
  const Coupling<T>& loop = impl_->couplings[impl_->loops[index]];
  double gap = 0;
  for (const Stencil<T>& e : loop.stencils) {
    const double open = double((reach(loop, e) - e.offset).norm() - e.length);
    gap = std::max(gap, e.only_pulls ? open : std::abs(open));
  }
  return gap;
}

template <class T>
Vec3<T> World<T>::loop_force(int index) const {
  const Coupling<T>& loop = impl_->couplings[impl_->loops[index]];
  Vec3<T> force = Vec3<T>::Zero();
  for (std::size_t n = 0; n < loop.nodes.size(); n += 2) force -= loop.nodes[n].gradient;
  return force;
}

template <class T>
int World<T>::add_particles(const ParticleBody& body, Status& status) {
  ParticleSet set;
  set.body = body;
  set.bodies = bodies_of_nodes(body);
  status = check(body);
  if (status) status = impl_->find(body.frame, set.place);
  if (!status) return -1;
  const Skeleton skeleton = skeleton_of(body, impl_->frame_of(set.place));
  status = validate(skeleton);
  if (!status) return -1;
  CharacterSettings settings;
  settings.root = RootDrive::kFree;
  settings.ground_contact = body.radius > 0;
  settings.self_collision = body.meets_itself;
  impl_->states.push_back(std::make_unique<CharacterState<T>>(skeleton, settings));
  CharacterState<T>& s = *impl_->states.back();
  s.is_prop = s.is_particles = true;
  s.refresh_limits();
  s.update_model();
  set.state = static_cast<int>(impl_->states.size()) - 1;
  set.coupling = impl_->couplings.add(make_elements<T>(body, set.state, set.place));
  if (!body.meets_frame && set.place.state >= 0)
    impl_->couplings.keep_apart({set.state, -1, set.place.state, set.place.body});
  impl_->particles.push_back(std::move(set));
  impl_->reserve();
  return static_cast<int>(impl_->particles.size()) - 1;
}

template <class T>
void World<T>::reset_particles(int index, const Vec3<T>& velocity) {
  const ParticleSet& set = impl_->particles[index];
  CharacterState<T>& s = *impl_->states[set.state];
  const Transform<T> frame = impl_->frame_of(set.place).template cast<T>();
  s.target[0].translation = frame.translation;
  for (std::size_t n = 0; n < set.bodies.size(); ++n) {
    if (set.bodies[n] < 0) continue;
    JointJet<T>& jet = s.target[set.bodies[n]];
    jet.translation = frame.rotation * Vec3<T>(set.body.nodes[n].position.template cast<T>());
    jet.velocity = velocity;
  }
  s.reset_to_target(Vec3<T>::Zero());
}

template <class T>
Vec3<T> World<T>::particle(int index, int node) const {
  const ParticleSet& set = impl_->particles[index];
  if (set.bodies[node] >= 0) return impl_->states[set.state]->model[set.bodies[node]].translation;
  return Vec3<double>(impl_->frame_of(set.place) * set.body.nodes[node].position).template cast<T>();
}

template <class T>
Vec3<T> World<T>::particle_velocity(int index, int node) const {
  const ParticleSet& set = impl_->particles[index];
  if (set.bodies[node] < 0) return Vec3<T>::Zero();
  return impl_->states[set.state]->history.velocity[set.bodies[node]];
}

template <class T>
const CharacterReport& World<T>::particle_report(int index) const {
  return impl_->states[impl_->particles[index].state]->report;
}

template <class T>
int World<T>::particles_count() const {
  return static_cast<int>(impl_->particles.size());
}

template <class T>
Character<T> World<T>::character(int index) {
  return Character<T>(impl_->states[impl_->characters[index]].get());
}

template <class T>
int World<T>::character_count() const {
  return static_cast<int>(impl_->characters.size());
}

template <class T>
int World<T>::prop_count() const {
  return static_cast<int>(impl_->props.size());
}

template <class T>
Transform<T> World<T>::prop_pose(int index) const {
  return impl_->states[impl_->props[index]]->model[0];
}

template <class T>
Vec3<T> World<T>::prop_velocity(int index) const {
  return impl_->states[impl_->props[index]]->history.velocity[0];
}

template <class T>
const CharacterReport& World<T>::prop_report(int index) const {
  return impl_->states[impl_->props[index]]->report;
}

template <class T>
bool World<T>::Impl::near(const CharacterState<T>& a, const CharacterState<T>& b, T h) const {
  if (a.parked || b.parked || !settings.body_contact) return false;
  const T reach = a.radius + b.radius + T(0.1) + 2 * h * (a.fastest() + b.fastest());
  return (a.middle() - b.middle()).norm() < reach;
}

/// Whether an obstacle may be in the way of the animation.
template <class T>
bool World<T>::Impl::near_obstacle(const CharacterState<T>& s, T h) const {
  if (!s.settings.ground_contact) return false;
  const T reach = s.radius + T(0.1) + 2 * h * s.history.velocity[0].norm();
  const Vec3<double> center = s.model[0].translation.template cast<double>();
  const auto near = [&](double distance) { return distance < double(reach); };
  return std::any_of(
             obstacles.begin(), obstacles.end(),
             [&](const Collider& o) {
               return near(signed_distance<double>(o.shape, o.size, o.local.inverse() * center).distance);
             }) ||
         std::any_of(hosts.begin(), hosts.end(),
                     [&](const HostObstacle& o) { return near(o.shape->distance(center).distance); });
}

/// What the effects ask of a character on its animation: wrenches of the bodies, and rows of the joints.
template <class T>
void World<T>::Impl::add_effect_wrenches(CharacterState<T>& s, const Vec3<T>& origin, T h) const {
  TreeProblem<T>& p = s.problem;
  StepSettings<T> step;
  step.h = h;
  step.gravity = settings.gravity.template cast<T>();
  step.common_origin = origin.template cast<double>();
  for (int i = 0; i < s.tree.bodies; ++i) {
    p.start[i] = s.local[i];
    p.local[i] = {s.target[i].rotation, s.target[i].translation};
  }
  for (const Effect<T>* effect : p.effects)
    effect->add_load(effect_pose(step, p), s.motion, {p.force, p.moment});
  measure_effect_rows(step, p);
}

/// Plays the clip and asks the residual pass whether the muscles can do it. False, with nothing moved, where
/// they can't.
template <class T>
bool World<T>::Impl::play(CharacterState<T>& s, T h) {
  TreeProblem<T>& p = s.problem;
  const Vec3<T> origin = s.target[0].translation;
  inertial_wrenches<T>(s.tree, s.target, settings.gravity.template cast<T>(), origin, p.kinematics, s.motion,
                       p.force, p.moment);
  for (const ExternalForce<T>& j : s.impulses) {
    const Vec3<T> x = p.kinematics.origin[j.body] + p.kinematics.rotation[j.body] * j.local;
    p.force[j.body] -= j.force / h;
    p.moment[j.body] -= x.cross(j.force / h);
  }
  if (settings.ground && settings.ground_support && s.settings.ground_contact)
    share_support<T>(s.tree, p.kinematics, s.points, T(settings.ground_height) - origin.z(), {}, p.force,
                     p.moment);
  if (!p.effects.empty()) add_effect_wrenches(s, origin, h);
  project_wrenches<T>(s.tree, p.kinematics, p.force, p.moment, p.gradient);
  for (const JointRow<T>& row : p.effect_rows)
    for (int a = 0; a < row.count; ++a) p.gradient[row.dof + a] += row.slope(row.value) * row.gradient[a];
  const int root_dofs = s.tree.type[0] == JointType::kFree ? s.tree.dof_count(0) : 0;
  for (int i = s.root_is_kinematic() && root_dofs > 0 ? 1 : 0; i < s.tree.bodies; ++i)
    for (int dof = s.tree.first_dof[i]; dof < s.tree.first_dof[i + 1]; ++dof)
      if (p.law.overloaded(s.tree, i, dof, p.gradient)) return false;
  for (int i = 0; i < s.tree.bodies; ++i)
    for (int dof = s.tree.first_dof[i]; dof < s.tree.first_dof[i + 1]; ++dof) {
      s.torque[dof] = p.gradient[dof];
      s.limit[dof] = p.law.limit(dof, p.gradient[dof]);
      s.load[dof] = p.law.load(s.tree, i, dof, p.gradient);
      s.unknown[dof] = 0;
    }
  for (int i = 0; i < s.tree.bodies; ++i) {
    const Transform<T> before = s.local[i];
    s.local[i] = {s.target[i].rotation, s.target[i].translation};
    s.rate[i] = joint_offset_value<T>(s.tree, i, before, s.local[i]);
    for (T& r : s.rate[i]) r /= h;
  }
  for (std::size_t i = s.tree.bodies; i < s.local.size(); ++i)
    s.local[i] = {s.target[i].rotation, s.target[i].translation};
  s.update_model();
  advance_exactly<T>(s.tree, p.kinematics, s.motion, h, origin.template cast<double>(), s.history);
  s.rate_step = T(0);
  s.contact_signature = s.limit_signature = 0;
  s.steps_unchanged = 0;
  s.energy_ceiling = std::numeric_limits<double>::infinity();
  s.report = {};
  s.report.dofs = s.tree.dofs;
  s.report_totals(settings.gravity);
  return true;
}

template <class T>
void World<T>::Impl::step_once(T h) {
  const int count = static_cast<int>(states.size());
  for (auto& s : states) s->carried = carry_over(*s, h);
  group.assign(count, 0);
  for (int i = 0; i < count; ++i) group[i] = i;
  // Islands: whoever is near enough to touch. Few characters per world so far, so all pairs.
  for (int i = 0; i < count; ++i)
    for (int j = i + 1; j < count; ++j)
      if (near(*states[i], *states[j], h)) {
        const int from = std::max(group[i], group[j]), to = std::min(group[i], group[j]);
        for (int& g : group)
          if (g == from) g = to;
      }
  couplings.join(states, group);
  lagged_new.clear();
  for (int g = 0; g < count; ++g) {
    members.clear();
    member_indices.clear();
    for (int i = 0; i < count; ++i)
      if (group[i] == g && !states[i]->parked) {
        members.push_back(states[i].get());
        member_indices.push_back(i);
      }
    if (members.empty()) continue;
    CharacterState<T>& first = *members[0];
    const std::span<Coupling<T>* const> ties = couplings.of_island(states, group, g);
    if (members.size() == 1 && ties.empty() && first.fully_driven() && first.undisturbed() &&
        !near_obstacle(first, h) && play(first, h))
      continue;
    stepper.step(settings, {obstacles, hosts, couplings.apart()}, h, members, member_indices, ties, lagged,
                 lagged_new);
  }
  std::sort(lagged_new.begin(), lagged_new.end(),
            [](const LaggedForce<T>& a, const LaggedForce<T>& b) { return a.id < b.id; });
  lagged.swap(lagged_new);
  for (auto& s : states) {
    s->impulses.clear();
    s->target_before = s->target;
    s->report.carried = s->carried;
  }
}

template <class T>
Status World<T>::step(T h) {
  if (!std::isfinite(h)) return Status::error(Code::kNotFinite, "step is not finite");
  if (h <= T(0)) return Status::error(Code::kInvalidArgument, "step must be positive");
  if (h < T(1e-5)) return Status::error(Code::kOutOfRange, "step below 1e-5 s");
  if (h > T(0.25)) return Status::error(Code::kOutOfRange, "step above 0.25 s");
  impl_->step_once(h);
  return {};
}

template <class T>
std::size_t World<T>::snapshot_capacity() const {
  return bytes_at_most(impl_->moving(), Content::kState);
}

template <class T>
std::size_t World<T>::save(std::span<std::byte> out) const {
  return write_bytes(impl_->moving(), Content::kState, out);
}

template <class T>
Status World<T>::restore(std::span<const std::byte> snapshot) {
  return read_bytes(impl_->moving(), Content::kState, snapshot);
}

template <class T>
std::size_t World<T>::inputs_capacity() const {
  return bytes_at_most(impl_->moving(), Content::kInputs);
}

template <class T>
std::size_t World<T>::save_inputs(std::span<std::byte> out) const {
  return write_bytes(impl_->moving(), Content::kInputs, out);
}

template <class T>
Status World<T>::restore_inputs(std::span<const std::byte> inputs) {
  return read_bytes(impl_->moving(), Content::kInputs, inputs);
}

template <class T>
SnapshotField World<T>::snapshot_field(std::size_t byte) const {
  return field_at(impl_->moving(), byte);
}

template class World<float>;
template class World<double>;

}  // namespace sinew
