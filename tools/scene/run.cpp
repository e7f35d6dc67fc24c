#include "scene/run.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "scene/play.h"
#include "scene/ties.h"
#include "sinew/character/contact_events.h"
#include "sinew/character/debug_draw.h"
#include "sinew/skeleton/rotation.h"

namespace sinew::scene {
namespace {

template <class T>
class Runner {
 public:
  Runner(const Scene& scene, Recording& recording, Telemetry& telemetry)
      : s_(scene), recording_(recording), telemetry_(telemetry), world_(scene.world), play_(scene, world_) {}

  convert::Error run(const std::function<void(int, int)>& progress) {
    if (convert::Error error = play_.set_up()) return error;
    list_actors();
    // Without contacts there is nothing to report, and nothing of them to draw.
    if (recording_.shows_inside) static_cast<void>(report_contacts(world_, &ring_));
    const int frames = static_cast<int>(std::ceil(s_.duration * s_.frame_rate - 1e-9));
    const T h = T(1 / s_.frame_rate);
    for (int f = 0; f <= frames; ++f) {
      double microseconds = 0;
      const double t = f / s_.frame_rate;
      if (f > 0) {
        const double before = (f - 1) / s_.frame_rate;
        if (convert::Error error = play_.prepare(before, t)) return error;
        if (convert::Error error = push(before, t)) return error;
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
  /// Who will be in every frame.
  void list_actors() {
    recording_.title = s_.title;
    recording_.frame_rate = s_.frame_rate;
    recording_.camera = s_.camera;
    recording_.obstacles = s_.obstacles;
    if (s_.world.ground)
      recording_.ground = static_cast<float>(s_.world.ground_height);
    else
      recording_.ground.reset();
    for (const SceneCharacter& c : s_.characters) {
      recording_.characters.push_back(c.asset);
      recording_.names.push_back(c.name);
    }
    for (const SceneProp& p : s_.props)
      recording_.props.push_back({p.name, p.settings.hull ? Shape::kConvex : p.settings.shape,
                                  p.settings.size.cast<float>(), static_cast<float>(p.settings.mass),
                                  p.settings.hull});
    for (const ParticleBody& body : s_.particles) {
      edges_.push_back(drawn_edges(body));
      for (const auto& [a, b] : edges_.back()) {
        const double length = (body.nodes[a].position - body.nodes[b].position).norm();
        // Strands as thick as they collide; in a net that would be a wall.
        const bool strand = edges_.back().size() < body.nodes.size();
        const auto radius = static_cast<float>(std::max((strand ? 1 : 0.3) * body.radius, 2e-3));
        recording_.props.push_back(
            {body.name, Shape::kCapsule, {radius, radius, float(length / 2)}, 0, nullptr});
      }
    }
    telemetry_.plotted_joint = recording_.plotted_joint = s_.plotted_joint;
    if (s_.plotted_joint >= 0)
      telemetry_.plotted_name = s_.characters[0].asset->skeleton.joints[s_.plotted_joint].name;
  }

  convert::Error push(double from, double to) {
    for (const Impulse& p : play_.pushes(from, to)) {
      const Status status = apply(p, T(to - from), world_);
      if (!status) return {"push at " + std::to_string(from) + " s: " + status.reason};
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
            {{rotation_between<float>(Vec3<float>::UnitZ(), to - from), 0.5f * (from + to)}});
      }
  }

  /// What a joint's muscle could do at full strength in the direction in which it pulls, N·m.
  static T full_limit(const Skeleton& skeleton, int joint, int axis, T torque) {
    const bool plus = torque > T(0);
    const DofLimits& own = skeleton.joints[joint].dofs[axis];
    double limit = plus ? own.torque_plus : own.torque_minus;
    for (const Muscle& muscle : skeleton.muscles)
      if (muscle.joint == joint && muscle.dof == axis)
        limit += plus ? muscle.torque_plus : muscle.torque_minus;
    return T(limit);
  }

  void record_muscles(const Character<T>& c, CharacterFrame& made) const {
    const Skeleton& skeleton = c.skeleton();
    made.load.assign(skeleton.joints.size(), 0);
    made.torque = made.limit = made.effort = made.load;
    for (int i = 0; i < skeleton.body_count; ++i) {
      const int dofs = dof_count(skeleton.joints[i].type);
      if (skeleton.joints[i].type == JointType::kFree || dofs == 0) continue;
      int most = c.first_dof(i);  // the axis that is closest to its limit speaks for the joint
      for (int k = 1; k < dofs; ++k)
        if (c.load()[c.first_dof(i) + k] > c.load()[most]) most = c.first_dof(i) + k;
      made.load[i] = float(c.load()[most]);
      made.limit[i] = float(c.limit()[most]);
      // Hinges show their sign, ball joints the size.
      made.torque[i] = dofs == 1 ? float(c.torque()[most]) : std::abs(float(c.torque()[most]));
      const T full = full_limit(skeleton, i, most - c.first_dof(i), c.torque()[most]);
      if (!std::isfinite(full) || !(full > T(0))) continue;
      const T limit = c.limit()[most];
      made.effort[i] = std::isfinite(limit) ? made.load[i] * float(limit / full)
                                            : float(std::abs(c.torque()[most]) / full);
    }
    for (std::size_t i = skeleton.body_count; i < skeleton.joints.size(); ++i) {
      made.load[i] = made.load[skeleton.joints[i].parent];
      made.effort[i] = made.effort[skeleton.joints[i].parent];
    }
  }

  /// Colours rise at once and fade: an effort of one frame is seen, and one that comes and goes does not
  /// flicker.
  void calm(const std::vector<float>& before, std::vector<float>& now) const {
    constexpr double kFade = 0.1;  // s
    const auto left = static_cast<float>(std::exp(-1 / (s_.frame_rate * kFade)));
    for (std::size_t i = 0; i < now.size(); ++i) now[i] = std::max(now[i], left * before[i]);
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
      for (const TimeJet<T>& curve : play_.curves(static_cast<int>(n)))
        made.curves.push_back(static_cast<float>(curve.value));
      record_muscles(c, made);
      if (!recording_.frames.empty()) calm(recording_.frames.back().characters[n].effort, made.effort);
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
      row.asked = play_.asked_acceleration(static_cast<int>(n));
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
      if (!play_.launched(p)) frame.props.back().world.translation.z() = kHidden;
    }
    record_particles(frame);
    if (recording_.shows_inside) {
      ring_.clear();
      draw(world_, {}, frame.inside);
    }
    recording_.frames.push_back(std::move(frame));
  }

  const Scene& s_;
  Recording& recording_;
  Telemetry& telemetry_;
  World<T> world_;
  Play<T> play_;
  std::vector<ContactEvent> contacts_{1024};
  ContactRing ring_{contacts_};                         ///< drawn contacts are those that are reported
  std::vector<std::vector<std::array<int, 2>>> edges_;  ///< [particle body] drawn, after the props
};

}  // namespace

convert::Error run_scene(const Scene& scene, Recording& recording, Telemetry& telemetry,
                         const std::function<void(int, int)>& progress) {
  if (scene.double_precision) return Runner<double>(scene, recording, telemetry).run(progress);
  return Runner<float>(scene, recording, telemetry).run(progress);
}

}  // namespace sinew::scene
