#include "scene/run.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "scene/ties.h"
#include "sinew/animation/crossfade.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/effects/continuous_detection.h"
#include "sinew/effects/restitution.h"

namespace sinew::scene {
namespace {

template <class Value>
Value value_at(const Timeline<Value>& line, double t, Value otherwise) {
  for (const auto& [time, value] : line)
    if (time <= t + 1e-9) otherwise = value;
  return otherwise;
}

/// Strengths are joined by straight lines.
double ramp_at(const Timeline<double>& line, double t) {
  if (t <= line.front().first) return line.front().second;
  for (std::size_t i = 1; i < line.size(); ++i)
    if (t < line[i].first) {
      const double u = (t - line[i - 1].first) / (line[i].first - line[i - 1].first);
      return line[i - 1].second + u * (line[i].second - line[i - 1].second);
    }
  return line.back().second;
}

Transform<double> upright(const Vec3<double>& position, double yaw) {
  return {Quat<double>(Eigen::AngleAxisd(yaw, Vec3<double>::UnitZ())), position};
}

double heading(const Quat<double>& rotation, const Quat<double>& rest) {
  const Vec3<double> forward = (rotation * rest.conjugate()) * Vec3<double>::UnitX();
  return std::atan2(forward.y(), forward.x());
}

/// Turn about the vertical that brings `from` nearest to `to`, also of bodies that lie: it maximises
/// tr(toᵀ·Rz·from).
double turn_between(const Quat<double>& from, const Quat<double>& to) {
  const Mat3<double> r = (to * from.conjugate()).toRotationMatrix();
  return std::atan2(r(1, 0) - r(0, 1), r(0, 0) + r(1, 1));
}

/// What one character's animation wants at a time: its clips one after the other, crossfaded, each placed in
/// the world.
template <class T>
class Player {
 public:
  explicit Player(const SceneCharacter& c)
      : c_(c), places_(c.clips.size()), a_(c.asset->skeleton.joints.size()), b_(a_.size()) {
    for (auto& place : places_) place = upright(c.position, c.yaw);
    for (const ClipUse& use : c.clips) chosen_.push_back(use.clip);
  }

  /// `now`: local pose of the character, root in the world.
  const std::vector<JointJet<T>>& at(double t, std::span<const Transform<T>> now) {
    rest(a_);
    bool any = false;
    for (std::size_t i = 0; i < c_.clips.size(); ++i) {
      const ClipUse& use = c_.clips[i];
      if (t < use.start - 1e-9) break;
      if (i >= begun_) begin(i, now);
      const bool over = i + 1 < c_.clips.size() && t >= c_.clips[i + 1].start + c_.clips[i + 1].blend;
      if (over) continue;
      if (use.from_pose) {
        for (std::size_t k = 0; k < a_.size(); ++k) {
          a_[k] = {};
          a_[k].rotation = held_[k].rotation;
          a_[k].translation = held_[k].translation;
        }
        any = true;
      }
      const SamplingJob<T> job{&c_.asset->clips[chosen_[i]], use.offset + (t - use.start) * use.rate,
                               use.rate, b_};
      job.Run();
      place_root<T>(places_[i].template cast<T>(), b_[0]);
      const EaseWeight<T> w =
          any ? EaseWeight<T>::at(T(t - use.start), T(use.blend)) : EaseWeight<T>{T(1), T(0), T(0)};
      if (any)
        crossfade<T>(a_, b_, w, a_);
      else
        a_.swap(b_);
      any = true;
    }
    return a_;
  }

 private:
  void rest(std::vector<JointJet<T>>& jets) const {
    for (std::size_t i = 0; i < jets.size(); ++i) {
      jets[i] = {};
      jets[i].rotation = c_.asset->skeleton.joints[i].rest.rotation.template cast<T>();
      jets[i].translation = c_.asset->skeleton.joints[i].rest.translation.template cast<T>();
    }
    place_root<T>(upright(c_.position, c_.yaw).template cast<T>(), jets[0]);
  }

  /// Chooses the clip by how the character lies and places it: its first root pose comes to stand where the
  /// character's root is, turned the same way; heights stay.
  void begin(std::size_t i, std::span<const Transform<T>> pose) {
    begun_ = i + 1;
    const ClipUse& use = c_.clips[i];
    if (use.from_pose) held_.assign(pose.begin(), pose.end());
    const Transform<double> now = pose[0].template cast<double>();
    const Quat<double> from_rest = now.rotation * c_.asset->skeleton.joints[0].rest.rotation.conjugate();
    const bool prone = (from_rest * Vec3<double>::UnitX()).z() < 0;
    if (prone && use.clip_when_prone >= 0) chosen_[i] = use.clip_when_prone;
    if (!use.align) return;
    SamplingJob<T>{&c_.asset->clips[chosen_[i]], use.offset, 1, b_}.Run();
    const double turn = turn_between(b_[0].rotation.template cast<double>(), now.rotation);
    const Transform<double> turned = upright(Vec3<double>::Zero(), turn);
    Vec3<double> shift = now.translation - turned * b_[0].translation.template cast<double>();
    shift.z() = c_.position.z();
    places_[i] = upright(shift, turn);
  }

  const SceneCharacter& c_;
  std::vector<Transform<double>> places_;
  std::vector<int> chosen_;         ///< [use] clip
  std::size_t begun_ = 0;           ///< uses that have started
  std::vector<Transform<T>> held_;  ///< [joint] pose in which the last use with from_pose began
  std::vector<JointJet<T>> a_, b_;
};

template <class T>
class Runner {
 public:
  Runner(const Scene& scene, Recording& recording, Telemetry& telemetry)
      : s_(scene), recording_(recording), telemetry_(telemetry), world_(scene.world) {}

  convert::Error run(const std::function<void(int, int)>& progress) {
    if (convert::Error error = set_up()) return error;
    const int frames = static_cast<int>(std::ceil(s_.duration * s_.frame_rate - 1e-9));
    const T h = T(1 / s_.frame_rate);
    for (int f = 0; f <= frames; ++f) {
      const double t = f / s_.frame_rate;
      for (std::size_t c = 0; c < s_.characters.size(); ++c)
        if (convert::Error error = drive(static_cast<int>(c), t, f == 0)) return error;
      if (f == 0)
        for (int p = 0; p < world_.particles_count(); ++p) world_.reset_particles(p);
      double microseconds = 0;
      if (f > 0) {
        launch(t - 1 / s_.frame_rate);
        if (convert::Error error = push(t - 1 / s_.frame_rate)) return error;
        const auto begin = std::chrono::steady_clock::now();
        const Status status = world_.step(h);
        microseconds =
            std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
        if (!status) return {std::string("step at ") + std::to_string(t) + " s: " + status.reason};
      }
      record(t, microseconds);
      if (progress) progress(f, frames);
    }
    return {};
  }

 private:
  convert::Error set_up() {
    Status status;
    recording_.title = s_.title;
    recording_.frame_rate = s_.frame_rate;
    recording_.camera = s_.camera;
    recording_.obstacles = s_.obstacles;
    for (const SceneCharacter& c : s_.characters) {
      CharacterSettings settings = c.settings;
      settings.strength = ramp_at(c.strength, 0);
      settings.root = value_at(c.root, 0, RootDrive::kKinematic);
      if (world_.add_character(c.asset->skeleton, settings, status) < 0)
        return {"character '" + c.name + "': " + status.reason};
      recording_.characters.push_back(c.asset);
      recording_.names.push_back(c.name);
      players_.emplace_back(c);
    }
    for (const Collider& o : s_.obstacles)
      if (status = world_.add_obstacle(o); !status) return {std::string("obstacle: ") + status.reason};
    for (const SceneProp& p : s_.props) {
      const int prop = world_.add_prop(p.settings, status);
      if (prop < 0) return {"prop '" + p.name + "': " + status.reason};
      recording_.props.push_back(
          {p.name, p.settings.shape, p.settings.size.cast<float>(), static_cast<float>(p.settings.mass)});
      launched_.push_back(p.launch_time <= 0);
      if (!launched_.back()) world_.park_prop(prop);
    }
    if (convert::Error error = add_effects()) return error;
    if (convert::Error error = add_ties()) return error;
    telemetry_.plotted_joint = recording_.plotted_joint = s_.plotted_joint;
    if (s_.plotted_joint >= 0)
      telemetry_.plotted_name = s_.characters[0].asset->skeleton.joints[s_.plotted_joint].name;
    return {};
  }

  convert::Error add_ties() {
    Status status;
    for (const LoopSettings& loop : s_.loops)
      if (world_.add_loop(loop, status) < 0) return {std::string("loop: ") + status.reason};
    for (const ParticleBody& body : s_.particles) {
      if (world_.add_particles(body, status) < 0) return {"particles '" + body.name + "': " + status.reason};
      edges_.push_back(drawn_edges(body));
      for (const auto& [a, b] : edges_.back()) {
        const double length = (body.nodes[a].position - body.nodes[b].position).norm();
        // Strands as thick as they collide; in a net that would be a wall.
        const bool strand = edges_.back().size() < body.nodes.size();
        const auto radius = static_cast<float>(std::max((strand ? 1 : 0.3) * body.radius, 2e-3));
        recording_.props.push_back({body.name, Shape::kCapsule, {radius, radius, float(length / 2)}, 0});
      }
    }
    return {};
  }

  /// Capsules between the nodes, as long as they are at rest.
  void record_particles(Frame& frame) const {
    for (int p = 0; p < world_.particles_count(); ++p)
      for (const auto& [a, b] : edges_[static_cast<std::size_t>(p)]) {
        const Vec3<float> from = world_.particle(p, a).template cast<float>();
        const Vec3<float> to = world_.particle(p, b).template cast<float>();
        frame.props.push_back(
            {{Quat<float>::FromTwoVectors(Vec3<float>::UnitZ(), to - from), 0.5f * (from + to)}});
      }
  }

  convert::Error add_effects() {
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

  convert::Error drive(int c, double t, bool first) {
    const SceneCharacter& source = s_.characters[c];
    Character<T> character = world_.character(c);
    const Status status = character.set_target(players_[c].at(t, character.local()));
    if (!status) return {"character '" + source.name + "' at " + std::to_string(t) + " s: " + status.reason};
    if (first) {
      character.reset();
      return {};
    }
    character.set_strength(T(ramp_at(source.strength, t)));
    for (const auto& [joint, factor] : source.group_strength)
      character.set_strength(joint, T(ramp_at(factor, t)));
    character.set_root_drive(value_at(source.root, t, RootDrive::kKinematic));
    return {};
  }

  void launch(double t) {
    for (std::size_t p = 0; p < s_.props.size(); ++p) {
      const SceneProp& prop = s_.props[p];
      if (launched_[p] || t < prop.launch_time) continue;
      launched_[p] = true;
      Vec3<double> from = prop.settings.pose.translation, velocity = prop.settings.velocity;
      if (prop.target_character >= 0) aim(prop, t, from, velocity);
      world_.set_prop(static_cast<int>(p), {Quat<T>::Identity(), from.cast<T>()}, velocity.cast<T>(),
                      Vec3<T>::Zero());
    }
  }

  /// The share of every push that falls into the step from t.
  convert::Error push(double t) {
    const double end = t + 1 / s_.frame_rate;
    for (const Push& p : s_.pushes) {
      double share = p.time >= t - 1e-9 && p.time < end - 1e-9 ? 1 : 0;
      if (p.duration > 0)
        share = std::max(0.0, std::min(end, p.time + p.duration) - std::max(t, p.time)) / p.duration;
      if (share <= 0) continue;
      Character<T> c = world_.character(p.character);
      const Vec3<T> point = c.model()[p.joint] * Vec3<T>(p.point.cast<T>());
      const Status status = c.apply_impulse(p.joint, point, (share * p.impulse).cast<T>());
      if (!status) return {"push at " + std::to_string(p.time) + " s: " + status.reason};
    }
    return {};
  }

  /// The point of a joint, in the world, that things are thrown at, when the animation is at t.
  Vec3<double> target_of(const SceneProp& prop, double t) {
    const Skeleton& skeleton = s_.characters[prop.target_character].asset->skeleton;
    Player<T> ahead = players_[prop.target_character];
    const auto& jets = ahead.at(t, world_.character(prop.target_character).local());
    Vec3<double> point = 0.5 * skeleton.joints[prop.target_joint].center_of_mass;
    for (int j = prop.target_joint; j >= 0; j = skeleton.joints[j].parent)
      point = jets[j].rotation.template cast<double>() * point + jets[j].translation.template cast<double>();
    return point;
  }

  /// Ballistic launch at t that meets the moving joint, as long as it stays on its animation.
  void aim(const SceneProp& prop, double t, Vec3<double>& from, Vec3<double>& velocity) {
    const Transform<double> root = world_.character(prop.target_character).model()[0].template cast<double>();
    const Skeleton& skeleton = s_.characters[prop.target_character].asset->skeleton;
    const double yaw = heading(root.rotation, skeleton.joints[0].rest.rotation);
    from = upright({root.translation.x(), root.translation.y(), 0}, yaw) * prop.from;
    const double flight = (target_of(prop, t) - from).norm() / prop.speed;
    velocity = (target_of(prop, t + flight) - from) / flight - s_.world.gravity * (flight / 2);
  }

  void record(double t, double microseconds) {
    Frame frame;
    frame.time = t;
    frame.caption = value_at<std::string>(s_.captions, t, "");
    for (std::size_t n = 0; n < s_.characters.size(); ++n) {
      const Character<T> c = world_.character(static_cast<int>(n));
      const Skeleton& skeleton = c.skeleton();
      CharacterFrame made;
      for (const Transform<T>& x : c.model()) made.model.push_back(x.template cast<float>());
      made.load.assign(skeleton.joints.size(), 0);
      made.torque = made.limit = made.load;
      for (int i = 0; i < skeleton.body_count; ++i) {
        if (skeleton.joints[i].type == JointType::kFree) continue;
        const int dofs = dof_count(skeleton.joints[i].type);
        int most = c.first_dof(i);  // the axis that is closest to its limit speaks for the joint
        for (int k = 1; k < dofs; ++k)
          if (c.load()[c.first_dof(i) + k] > c.load()[most]) most = c.first_dof(i) + k;
        made.load[i] = float(c.load()[most]);
        made.limit[i] = float(c.limit()[most]);
        // Hinges show their sign, ball joints the size.
        made.torque[i] = dofs == 1 ? float(c.torque()[most]) : std::abs(float(c.torque()[most]));
      }
      for (std::size_t i = skeleton.body_count; i < skeleton.joints.size(); ++i)
        made.load[i] = made.load[skeleton.joints[i].parent];
      made.most_loaded_joint = static_cast<int>(
          std::max_element(made.load.begin(), made.load.begin() + skeleton.body_count) - made.load.begin());
      made.unknown_dofs = c.report().unknown_dofs;
      made.total_dofs = c.report().dofs;
      made.microseconds = static_cast<float>(microseconds);
      made.strength = static_cast<float>(ramp_at(s_.characters[n].strength, t));
      made.root_free = value_at(s_.characters[n].root, t, RootDrive::kKinematic) == RootDrive::kFree;
      TelemetryRow row;
      row.time = t;
      row.character = static_cast<int>(n);
      row.report = c.report();
      row.microseconds = microseconds;
      row.loaded_joint = made.most_loaded_joint;
      row.load = double(made.load[row.loaded_joint]);
      row.torque = double(made.torque[row.loaded_joint]);
      row.limit = double(made.limit[row.loaded_joint]);
      const int plotted = s_.plotted_joint >= 0 && n == 0 ? s_.plotted_joint : row.loaded_joint;
      row.plotted_torque = double(made.torque[plotted]);
      row.plotted_limit = double(made.limit[plotted]);
      row.loads.assign(made.load.begin(), made.load.begin() + skeleton.body_count);
      telemetry_.rows.push_back(std::move(row));
      frame.characters.push_back(std::move(made));
    }
    for (int p = 0; p < world_.prop_count(); ++p) {
      frame.props.push_back({world_.prop_pose(p).template cast<float>()});
      if (!launched_[p]) frame.props.back().world.translation.z() = kHidden;
    }
    record_particles(frame);
    recording_.frames.push_back(std::move(frame));
  }

  const Scene& s_;
  Recording& recording_;
  Telemetry& telemetry_;
  World<T> world_;
  std::vector<Player<T>> players_;
  std::vector<bool> launched_;
  std::vector<std::vector<std::array<int, 2>>> edges_;  ///< [particle body] drawn, after the props
};

}  // namespace

convert::Error run_scene(const Scene& scene, Recording& recording, Telemetry& telemetry,
                         const std::function<void(int, int)>& progress) {
  if (scene.double_precision) return Runner<double>(scene, recording, telemetry).run(progress);
  return Runner<float>(scene, recording, telemetry).run(progress);
}

}  // namespace sinew::scene
