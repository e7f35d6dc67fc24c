#include "scene/play.h"

#include <algorithm>
#include <cmath>

#include "sinew/character/physics_values.h"
#include "sinew/effects/continuous_detection.h"
#include "sinew/effects/restitution.h"

namespace sinew::scene {

template <class T>
convert::Error Play<T>::set_up() {
  if (convert::Error error = add_all()) return error;
  for (std::size_t c = 0; c < s_.characters.size(); ++c) {
    Character<T> character = world_.character(static_cast<int>(c));
    starts_.push_back(players_[c].start(character.local()));
    if (const Status status = character.set_target(starts_.back()); !status)
      return {"character '" + s_.characters[c].name + "' at the start: " + status.reason};
    (void)character.reset();
    CharacterDetail detail;
    detail.bake = s_.characters[c].bake;
    (void)character.set_detail(detail);
    for (const auto& [joint, factor] : s_.characters[c].group_strength)
      (void)character.set_strength(joint, T(asked_[c].groups.emplace_back(ramp_at(factor, 0))));
    set_tones(static_cast<int>(c), 0);
  }
  for (int p = 0; p < world_.particles_count(); ++p) (void)world_.reset_particles(p);
  return {};
}

template <class T>
convert::Error Play<T>::add_all() {
  Status status = study::declare_scheme(s_.scheme, world_);
  if (!status) return {std::string("scheme: ") + status.reason};
  for (const SceneCharacter& c : s_.characters) {
    CharacterSettings settings = c.settings;
    settings.strength = ramp_at(c.strength, 0);
    settings.root = value_at(c.root, 0, RootDrive::kKinematic);
    if (world_.add_character(c.asset->skeleton, settings, status) < 0)
      return {"character '" + c.name + "': " + status.reason};
    players_.emplace_back(c);
    timers_.push_back(c.graph.graph ? std::make_unique<FadeTimer<T>>(world_, static_cast<int>(timers_.size()))
                                    : nullptr);
    auto& behaviour = behaviours_.emplace_back();
    if (c.behaviour) {
      BehaviourSettings own = *c.behaviour;
      own.gravity = std::max(s_.world.gravity.norm(), 1e-3);
      behaviour = std::make_unique<Behaviour<T>>(c.asset->skeleton, own, status);
    }
    if (!status) return {"character '" + c.name + "' can't keep its balance: " + status.reason};
    if (behaviour)
      (void)behaviour->use_get_ups(c.asset->skeleton, c.asset->clips);  // without any it stays down
    asked_.push_back({settings.strength, {}, {}, settings.root});
  }
  for (const Collider& o : s_.obstacles)
    if (status = world_.add_obstacle(o); !status) return {std::string("obstacle: ") + status.reason};
  for (const SceneProp& p : s_.props) {
    const int prop = world_.add_prop(p.settings, status);
    if (prop < 0) return {"prop '" + p.name + "': " + status.reason};
    launched_.push_back(p.launch_time <= 0);
    if (!launched_.back()) (void)world_.park_prop(prop);
  }
  if (convert::Error error = add_effects()) return error;
  for (const LoopSettings& loop : s_.loops)
    if (world_.add_loop(loop, status) < 0) return {std::string("loop: ") + status.reason};
  for (const ParticleBody& body : s_.particles)
    if (world_.add_particles(body, status) < 0) return {"particles '" + body.name + "': " + status.reason};
  return {};
}

template <class T>
convert::Error Play<T>::add_effects() {
  if (s_.restitution)
    if (Status status = world_.template declare<Restitution>(); !status) return {status.reason};
  if (s_.continuous_detection)
    if (Status status = world_.template declare<ContinuousDetection>(); !status) return {status.reason};
  for (const SceneEffect& effect : s_.effects) {
    Status status;
    for (const int c : effect.characters)
      if (status) status = world_.add_effect(c, effect.make<T>(s_.characters[c].asset->skeleton));
    for (const int p : effect.props)
      if (status) status = world_.add_prop_effect(p, effect.make<T>({}));
    if (!status) return {"effect '" + effect.name + "': " + status.reason};
  }
  return {};
}

template <class T>
convert::Error Play<T>::prepare(double from, double to) {
  for (std::size_t c = 0; c < s_.characters.size(); ++c)
    if (convert::Error error = drive(static_cast<int>(c), to, to - from)) return error;
  launch(from);
  return {};
}

template <class T>
convert::Error Play<T>::drive(int c, double t, double h) {
  const SceneCharacter& source = s_.characters[c];
  Asked& asked = asked_[c];
  Character<T> character = world_.character(c);
  if (!asked.still) {
    Felt<T> felt{character.local()};
    if (players_[c].has_graph()) {  // loads are worked out when asked for
      loads_.resize(source.asset->skeleton.joints.size());
      felt.values = physics_values<T>(character, loads_);
      body_.resize(loads_.size());
      physical_motion<T>(character, body_);
      felt.motion = body_;
      felt.muscles = {FadeTimer<T>::answer, timers_[c].get()};
    }
    std::span<const JointJet<T>> wanted = players_[c].at(t, felt);
    if (behaviours_[c]) {
      jets_.assign(wanted.begin(), wanted.end());
      (void)behaviours_[c]->update(character, jets_, T(h));
      wanted = jets_;
    }
    asked.acceleration = 0;
    for (const JointJet<T>& jet : wanted)
      asked.acceleration = std::max(asked.acceleration, double(jet.alpha.norm()));
    Status status = character.set_target(wanted);
    if (!players_[c].fault()) status = players_[c].fault();
    if (!status) return {"character '" + source.name + "' at " + std::to_string(t) + " s: " + status.reason};
    asked.still = !players_[c].moves() && !behaviours_[c];
  }
  if (const double strength = ramp_at(source.strength, t); strength != asked.strength)
    (void)character.set_strength(T(asked.strength = strength));
  for (std::size_t g = 0; g < source.group_strength.size(); ++g)
    if (const double factor = ramp_at(source.group_strength[g].second, t); factor != asked.groups[g])
      (void)character.set_strength(source.group_strength[g].first, T(asked.groups[g] = factor));
  set_tones(c, t);
  if (const RootDrive root = value_at(source.root, t, RootDrive::kKinematic); root != asked.root)
    (void)character.set_root_drive(asked.root = root);
  return {};
}

/// Where one has changed, all anew: parts come after what they are parts of.
template <class T>
void Play<T>::set_tones(int c, double t) {
  const SceneCharacter& source = s_.characters[static_cast<std::size_t>(c)];
  std::vector<Tone> tones{value_at(source.tone, t, Tone::kRigid)};
  for (const PartTone& part : source.part_tones) tones.push_back(value_at(part.tone, t, Tone::kRigid));
  std::vector<Tone>& asked = asked_[static_cast<std::size_t>(c)].tones;
  if (tones == asked) return;
  asked = tones;
  Character<T> character = world_.character(c);
  (void)character.set_tone(tones[0]);
  for (std::size_t n = 0; n < source.part_tones.size(); ++n) {
    const PartTone& part = source.part_tones[n];
    if (part.joint < 0)
      (void)character.set_group_tone(part.group.c_str(), tones[n + 1]);
    else
      (void)character.set_tone(part.joint, tones[n + 1]);
  }
}

template <class T>
std::vector<Impulse> Play<T>::pushes(double from, double to) {
  std::vector<Impulse> out;
  for (const Push& p : s_.pushes) {
    Vec3<double> impulse = Vec3<double>::Zero();
    if (!p.force.empty()) {
      const bool acts =
          from >= p.force.front().first - 1e-9 && (p.force.size() < 2 || from < p.force.back().first - 1e-9);
      if (acts) impulse = ramp_at(p.force, from) * (to - from);
    } else {
      const double times = p.every > 0 ? std::max(0.0, std::floor((from - p.time) / p.every + 1e-6)) : 0;
      const double begin = p.time + times * p.every;
      double share = begin >= from - 1e-9 && begin < to - 1e-9 ? 1 : 0;
      if (p.duration > 0)
        share = std::max(0.0, std::min(to, begin + p.duration) - std::max(from, begin)) / p.duration;
      impulse = share * p.impulse;
    }
    if (impulse.isZero(0)) continue;
    const Transform<double> joint = world_.character(p.character).model()[p.joint].template cast<double>();
    const bool lasts = p.duration > 0 || !p.force.empty();
    out.push_back({p.character, p.joint, joint * p.point, impulse, lasts});
  }
  return out;
}

template <class T>
void Play<T>::launch(double t) {
  for (std::size_t p = 0; p < s_.props.size(); ++p) {
    const SceneProp& prop = s_.props[p];
    if (launched_[p] || t < prop.launch_time) continue;
    launched_[p] = true;
    Vec3<double> from = prop.settings.pose.translation, velocity = prop.settings.velocity;
    if (prop.target_character >= 0) aim(prop, t, from, velocity);
    (void)world_.set_prop(static_cast<int>(p), {Quat<T>::Identity(), from.cast<T>()}, velocity.cast<T>(),
                          Vec3<T>::Zero());
  }
}

/// The point of a joint, in the world, that things are thrown at, when the animation is at t.
template <class T>
Vec3<double> Play<T>::target_of(const SceneProp& prop, double t) {
  const Skeleton& skeleton = s_.characters[prop.target_character].asset->skeleton;
  Player<T> ahead = players_[prop.target_character];
  const auto& jets = ahead.at(t, world_.character(prop.target_character).local());
  Vec3<double> point = 0.5 * skeleton.joints[prop.target_joint].center_of_mass;
  for (int j = prop.target_joint; j >= 0; j = skeleton.joints[j].parent)
    point = jets[j].rotation.template cast<double>() * point + jets[j].translation.template cast<double>();
  return point;
}

/// Ballistic launch at t that meets the moving joint, as long as it stays on its animation.
template <class T>
void Play<T>::aim(const SceneProp& prop, double t, Vec3<double>& from, Vec3<double>& velocity) {
  const Transform<double> root = world_.character(prop.target_character).model()[0].template cast<double>();
  const Skeleton& skeleton = s_.characters[prop.target_character].asset->skeleton;
  const double yaw = heading(root.rotation, skeleton.joints[0].rest.rotation);
  from = upright({root.translation.x(), root.translation.y(), 0}, yaw) * prop.from;
  const double flight = (target_of(prop, t) - from).norm() / prop.speed;
  velocity = (target_of(prop, t + flight) - from) / flight - s_.world.gravity * (flight / 2);
}

template class Play<float>;
template class Play<double>;

}  // namespace sinew::scene
