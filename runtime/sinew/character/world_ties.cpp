// Loops and particle bodies of a world.
#include <algorithm>

#include "sinew/character/world_impl.h"
#include "sinew/optimizer/coupling_rows.h"

namespace sinew {
namespace {

Status no_such_loop(int index) {
  return Status::error(Code::kInvalidArgument, "no such loop", index);
}

Status no_such_particles(int index) {
  return Status::error(Code::kInvalidArgument, "no such particle body", index);
}

bool has_node(const ParticleSet* set, int node) {
  return set && node >= 0 && node < static_cast<int>(set->bodies.size());
}

}  // namespace

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
  return states[place.state]->model()[place.body].template cast<double>() * place.frame;
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
  const double of_a = impl_->weight_of(a), of_b = impl_->weight_of(b);
  const int heavier = of_a < of_b ? b.state : a.state;
  const double unit = heavier < 0 ? 1 : double(impl_->states[heavier]->tree.scale.length);
  impl_->declare(Ties<T>::declare);
  const int coupling = impl_->tie(make_loop<T>(loop, a, b, std::max(of_a, of_b), unit), status);
  if (!status) return -1;
  impl_->loops.push_back(coupling);
  if (!loop.collide && a.state >= 0 && b.state >= 0)
    impl_->couplings.keep_apart({a.state, a.body, b.state, b.body});
  return static_cast<int>(impl_->loops.size()) - 1;
}

template <class T>
Status World<T>::set_loop(int index, bool closed) {
  Coupling<T>* const loop = impl_->loop(index);
  if (!loop) return no_such_loop(index);
  loop->active = closed;
  for (CouplingNode<T>& node : loop->nodes) {
    node.gradient.setZero();
    if (node.state >= 0) impl_->states[node.state]->levels.wake = true;
  }
  return {};
}

template <class T>
double World<T>::loop_gap(int index) const {
  const Coupling<T>* const loop = impl_->loop(index);
  if (!loop) return 0;
  double gap = 0;
  for (const Stencil<T>& e : loop->stencils) {
    const double open = double((reach(*loop, e) - e.offset).norm() - e.length);
    gap = std::max(gap, e.only_pulls ? open : std::abs(open));
  }
  return gap;
}

template <class T>
Vec3<T> World<T>::loop_force(int index) const {
  const Coupling<T>* const loop = impl_->loop(index);
  Vec3<T> force = Vec3<T>::Zero();
  if (!loop) return force;
  for (std::size_t n = 0; n < loop->nodes.size(); n += 2) force -= loop->nodes[n].gradient;
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
  status = impl_->add(skeleton, settings);
  if (!status) return -1;
  CharacterState<T>& s = *impl_->states.back();
  s.is_prop = s.is_particles = true;
  s.refresh_limits();
  s.pose_changed();
  set.state = static_cast<int>(impl_->states.size()) - 1;
  impl_->declare(Ties<T>::declare);
  impl_->tie(make_elements<T>(body, set.state, set.place), status);
  if (!status) {
    impl_->drop_last();
    impl_->meet_surroundings();
    return -1;
  }
  if (!body.meets_frame && set.place.state >= 0)
    impl_->couplings.keep_apart({set.state, -1, set.place.state, set.place.body});
  impl_->particles.push_back(std::move(set));
  return static_cast<int>(impl_->particles.size()) - 1;
}

template <class T>
Status World<T>::reset_particles(int index, const Vec3<T>& velocity) {
  if (!impl_->particle_set(index)) return no_such_particles(index);
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
  return {};
}

template <class T>
Vec3<T> World<T>::particle(int index, int node) const {
  if (!has_node(impl_->particle_set(index), node)) return Vec3<T>::Zero();
  const ParticleSet& set = impl_->particles[index];
  if (set.bodies[node] >= 0) return impl_->states[set.state]->model()[set.bodies[node]].translation;
  return Vec3<double>(impl_->frame_of(set.place) * set.body.nodes[node].position).template cast<T>();
}

template <class T>
Vec3<T> World<T>::particle_velocity(int index, int node) const {
  if (!has_node(impl_->particle_set(index), node)) return Vec3<T>::Zero();
  const ParticleSet& set = impl_->particles[index];
  if (set.bodies[node] < 0) return Vec3<T>::Zero();
  return impl_->states[set.state]->history.velocity[set.bodies[node]];
}

template <class T>
const CharacterReport& World<T>::particle_report(int index) const {
  static const CharacterReport none;
  const ParticleSet* const set = impl_->particle_set(index);
  return set ? impl_->states[set->state]->report : none;
}

template <class T>
int World<T>::particles_count() const {
  return static_cast<int>(impl_->particles.size());
}

#define SINEW_TIE_INSTANCES(T)                                             \
  template Status World<T>::Impl::find(const Anchor&, Place&) const;       \
  template Transform<double> World<T>::Impl::frame_of(const Place&) const; \
  template double World<T>::Impl::weight_of(const Place&) const;           \
  template int World<T>::add_loop(const LoopSettings&, Status&);           \
  template Status World<T>::set_loop(int, bool);                           \
  template double World<T>::loop_gap(int) const;                           \
  template Vec3<T> World<T>::loop_force(int) const;                        \
  template int World<T>::add_particles(const ParticleBody&, Status&);      \
  template Status World<T>::reset_particles(int, const Vec3<T>&);          \
  template Vec3<T> World<T>::particle(int, int) const;                     \
  template Vec3<T> World<T>::particle_velocity(int, int) const;            \
  template const CharacterReport& World<T>::particle_report(int) const;    \
  template int World<T>::particles_count() const;
SINEW_TIE_INSTANCES(float)
SINEW_TIE_INSTANCES(double)

}  // namespace sinew
