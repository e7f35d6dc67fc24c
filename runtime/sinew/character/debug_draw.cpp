#include "sinew/character/debug_draw.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "sinew/character/debug_shapes.h"
#include "sinew/character/world_impl.h"
#include "sinew/effects/support.h"

namespace sinew {
namespace {

using namespace debug_colors;

constexpr double kMark = 0.015, kAxis = 0.08, kCross = 0.02;  ///< m of a figure of human size
constexpr double kOff = 1e-3;  ///< m, that a joint is from its target where that is drawn
constexpr std::array<const char*, kLevelCount> kLevelNames{"asleep",        "played", "on its animation",
                                                           "partly solved", "solved", "solved in parts"};

/// Green without a load, yellow at half of the limit, red at it.
DebugColor color_of_load(double load) {
  const double x = std::clamp(load, 0.0, 1.0);
  return {static_cast<std::uint8_t>(255 * std::min(1.0, 2 * x)),
          static_cast<std::uint8_t>(220 * std::min(1.0, 2 - 2 * x)), 40, 255};
}

template <class T>
class Drawing {
 public:
  using Impl = typename WorldInternals<T>::Impl;

  Drawing(const Impl& world, const DebugDrawSettings& settings, DebugRenderer& renderer)
      : world_(world), settings_(settings), renderer_(renderer) {}

  void draw_all() {
    for (const Collider& obstacle : world_.obstacles)
      if (settings_.colliders) draw_shape(obstacle, obstacle.local, kStatic, renderer_);
    for (const auto& state : world_.states)
      if (!state->parked) draw_state(*state);
    for (const int n : world_.characters)
      if (CharacterState<T>& s = *world_.states[static_cast<std::size_t>(n)]; !s.parked) draw_character(s);
    if (settings_.contacts && world_.reporter)
      for (const LoggedContact<T>& c : world_.reporter->contacts()) draw_contact(c);
    if (settings_.islands) draw_islands();
  }

 private:
  static Vec3<double> place_of(CharacterState<T>& s, int joint) {
    return s.model()[static_cast<std::size_t>(joint)].translation.template cast<double>();
  }

  /// Characters, props and particles.
  void draw_state(CharacterState<T>& s) {
    if (!settings_.colliders) return;
    const DebugColor color = s.levels.asleep                                  ? kAsleep
                             : s.is_prop || s.report.level >= Level::kPartial ? kSolved
                                                                              : kPlayed;
    for (const Collider& c : s.colliders)
      draw_shape(c, s.model()[static_cast<std::size_t>(c.joint)].template cast<double>() * c.local, color,
                 renderer_);
  }

  void draw_character(CharacterState<T>& s) {
    if (settings_.skeleton) draw_skeleton(s);
    if (settings_.muscles) draw_muscles(s);
    if (settings_.unknowns) draw_unknowns(s);
    if (settings_.support) draw_support(s);
    if (settings_.targets && !s.undisturbed() && !s.passive()) draw_targets(s);
  }

  void draw_skeleton(CharacterState<T>& s) {
    for (std::size_t j = 0; j < s.skeleton.joints.size(); ++j)
      if (const int parent = s.skeleton.joints[j].parent; parent >= 0)
        renderer_.line(place_of(s, parent), place_of(s, static_cast<int>(j)), kBone);
  }

  void draw_muscles(CharacterState<T>& s) {
    s.keep_loads();
    for (int i = 0; i < s.tree.bodies; ++i) {
      bool muscle = false;
      double load = 0;
      for (int dof = s.tree.first_dof[i]; dof < s.tree.first_dof[i + 1]; ++dof) {
        muscle = muscle || s.problem.law.has_muscle(dof);
        load = std::max(load, double(s.load[dof]));
      }
      if (muscle)
        draw_mark(place_of(s, i), kMark * double(s.tree.scale.length), color_of_load(load), renderer_);
    }
  }

  /// Where something was solved for, the kinematics are those of the solution.
  void draw_unknowns(CharacterState<T>& s) {
    for (int dof = 0; dof < s.tree.dofs; ++dof) {
      if (!s.unknown[dof]) continue;
      const Vec3<T> turns = s.problem.kinematics.w[dof], moves = s.problem.kinematics.v[dof];
      const Vec3<double> axis = (turns.squaredNorm() > T(0) ? turns : moves).template cast<double>();
      const Vec3<double> arm = kAxis * double(s.tree.scale.length) * axis.normalized(),
                         at = place_of(s, s.tree.dof_body[dof]);
      renderer_.line(at - arm, at + arm, kUnknown);
    }
  }

  void draw_support(CharacterState<T>& s) {
    Vec3<double> center = Vec3<double>::Zero();
    for (int i = 0; i < s.tree.bodies; ++i)
      center += double(s.tree.mass[i]) *
                (s.model()[static_cast<std::size_t>(i)] * s.tree.center_of_mass[i]).template cast<double>();
    center /= s.total_mass;
    const double unit = double(s.tree.scale.length);
    draw_cross(center, kCross * unit, kCenter, renderer_);
    if (!world_.settings.ground) return;
    const double floor = world_.settings.ground_height, reach = SupportSettings().reach * unit;
    renderer_.line(center, {center.x(), center.y(), floor}, kCenter);
    std::vector<Vec3<double>> stands;
    for (const ContactPoint<T>& p : s.points) {
      if (!p.meets_plane()) continue;
      const Vec3<double> at = (s.model()[static_cast<std::size_t>(p.body)] * p.local).template cast<double>();
      if (at.z() - double(p.radius) - floor < reach) stands.emplace_back(at.x(), at.y(), floor);
    }
    draw_hull(stands, kSupport, renderer_);
  }

  void draw_targets(CharacterState<T>& s) {
    std::vector<Transform<T>> wanted;
    for (std::size_t j = 0; j < s.skeleton.joints.size(); ++j) {
      const JointJet<T>& jet = s.last_target()[j];
      const int parent = s.skeleton.joints[j].parent;
      const Transform<T> local{jet.rotation, jet.translation};
      wanted.push_back(parent < 0 ? local : wanted[static_cast<std::size_t>(parent)] * local);
      if (parent < 0) continue;
      const auto place = [&](std::size_t joint) {
        return Vec3<double>(wanted[joint].translation.template cast<double>());
      };
      const Vec3<double> at = place(j), is = place_of(s, static_cast<int>(j));
      if ((at - is).norm() < kOff * double(s.tree.scale.length)) continue;
      renderer_.line(place(static_cast<std::size_t>(parent)), at, kTarget);
      renderer_.line(is, at, kTarget);
    }
  }

  void draw_contact(const LoggedContact<T>& c) {
    draw_cross(c.point, kCross, kTouch, renderer_);
    const Vec3<double> force = double(c.force) * c.normal.template cast<double>(),
                       friction = c.friction.template cast<double>();
    if (c.force > T(0)) renderer_.line(c.point, c.point + settings_.force_scale * force, kForce);
    if (friction.norm() > 0) renderer_.line(c.point, c.point + settings_.force_scale * friction, kFriction);
  }

  /// Lines from the first of those who were solved together to the others, and what the step did with each.
  void draw_islands() {
    const auto root = [&](int n) { return place_of(*world_.states[static_cast<std::size_t>(n)], 0); };
    for (int i = 0; i < world_.islands.count(); ++i) {
      const std::span<const int> members = world_.islands.members(i);
      for (const int n : members.subspan(1)) renderer_.line(root(members[0]), root(n), kIsland);
    }
    for (std::size_t c = 0; c < world_.characters.size(); ++c) {
      CharacterState<T>& s = *world_.states[static_cast<std::size_t>(world_.characters[c])];
      if (s.parked) continue;
      const CharacterReport& r = s.report;
      std::array<char, 128> words{};
      std::snprintf(words.data(), words.size(), "character %zu: %s, %d of %d unknown", c,
                    kLevelNames[static_cast<std::size_t>(r.level)], r.unknown_dofs, r.dofs);
      renderer_.text(place_of(s, 0) + Vec3<double>(0, 0, double(s.radius)), words.data(), kIsland);
    }
  }

  const Impl& world_;
  const DebugDrawSettings& settings_;
  DebugRenderer& renderer_;
};

}  // namespace

template <class T>
void draw(const World<T>& world, const DebugDrawSettings& settings, DebugRenderer& renderer) {
  Drawing<T>(WorldInternals<T>::of(world), settings, renderer).draw_all();
}

template void draw<float>(const World<float>&, const DebugDrawSettings&, DebugRenderer&);
template void draw<double>(const World<double>&, const DebugDrawSettings&, DebugRenderer&);

}  // namespace sinew
