// Props and loops of the C interface.
#include <algorithm>
#include <cmath>

#include "sinew/c/anchor.h"
#include "sinew/c/call.h"
#include "sinew/c/fields.h"
#include "sinew/c/hull.h"
#include "sinew/c/report.h"

namespace sinew::c {

template <>
inline constexpr std::uint32_t kFirstSize<sinew_prop_settings> = 168;  // up to layers

namespace {

constexpr auto kProp = [](auto& c, auto& s, auto&& f) {
  f("no such shape", c.shape, s.shape);
  f("extent must be 0 to 1e6 m", c.extent, s.size, 0, 1e6);
  f("mass must be 1e-6 to 1e9 kg", c.mass, s.mass, 1e-6, 1e9);
  f("friction must be 0 to 1000", c.friction, s.friction, 0, 1000);
  f("restitution must be 0 to 1", c.restitution, s.restitution, 0, 1);
  f("a prop's rotation must be a unit quaternion, its place within 1e6 m", c.pose, s.pose);
  f("velocity must be below 1e5 m/s", c.velocity, s.velocity, -1e5, 1e5);
  f("angular_velocity must be below 1e5 rad/s", c.angular_velocity, s.angular_velocity, -1e5, 1e5);
  f("", c.layers, s.layers);
  f("", c.meets, s.meets);
};

constexpr auto kLoop = [](auto& c, auto& s, auto&& f) {
  f("no such kind of loop", c.kind, s.kind);
  f("an anchor's rotation must be a unit quaternion, its place within 1e6 m", c.a.pose, s.a.frame);
  f("an anchor's rotation must be a unit quaternion, its place within 1e6 m", c.b.pose, s.b.frame);
  f("length must be 0 to 1e6 m", c.length, s.length, 0, 1e6);
  f("stiffness must be 0 to 1e12 N/m", c.stiffness, s.stiffness, 0, 1e12);
  f("", c.collide, s.collide);
};

/// act(OwnedWorld&, index) of a prop.
template <class Act>
sinew_status with_prop(sinew_prop handle, Act&& act) noexcept {
  return in_world(handle, Kind::kProp, false, [&](OwnedWorld& world) {
    const int index = index_of(handle);
    return index < world.world.prop_count() ? act(world, index) : refuse(handle, Kind::kProp);
  });
}

/// act(OwnedWorld&, index) of a loop.
template <class Act>
sinew_status with_loop(sinew_loop handle, Act&& act) noexcept {
  return in_world(handle, Kind::kLoop, false, [&](OwnedWorld& world) {
    const int index = index_of(handle);
    return index < world.loops ? act(world, index) : refuse(handle, Kind::kLoop);
  });
}

void write(const Vec3<float>& from, float* to) {
  std::copy_n(from.data(), 3, to);
}

/// Whether finite and |x| at most `most`.
bool are_within(const float* x, int count, float most) {
  for (int k = 0; k < count; ++k)
    if (!(std::abs(x[k]) <= most)) return false;
  return true;
}

sinew_status check_state(const sinew_transform& pose, const float* velocity, const float* angular_velocity) {
  const Eigen::Map<const Eigen::Vector4f> rotation(pose.rotation);
  if (!(std::abs(rotation.norm() - 1) < 0.01f))
    return fail(SINEW_INVALID_ARGUMENT, "a prop's rotation must be a unit quaternion");
  if (!are_within(pose.translation, 3, 1e6f))
    return fail(SINEW_OUT_OF_RANGE, "a prop's place must be within 1e6 m");
  if (!are_within(velocity, 3, 1e5f) || !are_within(angular_velocity, 3, 1e5f))
    return fail(SINEW_OUT_OF_RANGE, "a prop's velocities must be below 1e5 m/s and rad/s");
  return SINEW_OK;
}

}  // namespace
}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_prop_settings_init(sinew_prop_settings* settings) {
  return init<PropSettings>(settings, kProp);
}

sinew_status sinew_world_add_prop(sinew_world world, const sinew_prop_settings* settings, sinew_prop* out) {
  return set_up(world, [&](OwnedWorld& w) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    PropSettings read;
    if (const sinew_status s = read_settings(settings, read, kProp); s != SINEW_OK) return s;
    Status status;
    const int index = w.world.add_prop(read, status);
    if (index >= 0) *out = handle_in(world, Kind::kProp, index);
    return answer(status);
  });
}

sinew_status sinew_world_add_convex_prop(sinew_world world, const sinew_prop_settings* settings,
                                         const double* points, int32_t count, sinew_prop* out) {
  return set_up(world, [&](OwnedWorld& w) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    PropSettings read;
    if (const sinew_status s = read_settings(settings, read, kProp); s != SINEW_OK) return s;
    if (const sinew_status s = add_hull(w, points, count, read.hull); s != SINEW_OK) return s;
    Status status;
    const int index = w.world.add_prop(read, status);
    if (index >= 0) *out = handle_in(world, Kind::kProp, index);
    return answer(status);
  });
}

sinew_status sinew_world_get_prop(sinew_world world, int32_t index, sinew_prop* out) {
  return with_world(world, [&](OwnedWorld& w) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (index < 0 || index >= w.world.prop_count())
      return fail(SINEW_INVALID_ARGUMENT, "no such prop in this world", index);
    *out = handle_in(world, Kind::kProp, index);
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_prop_get_state(sinew_prop prop, sinew_transform* pose, float* velocity) {
  return with_prop(prop, [&](OwnedWorld& w, int index) {
    if (pose) {
      const Transform<float> at = w.world.prop_pose(index);
      Eigen::Map<Eigen::Vector4f>(pose->rotation) = at.rotation.coeffs();
      write(at.translation, pose->translation);
    }
    if (velocity) write(w.world.prop_velocity(index), velocity);
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_prop_set_state(sinew_prop prop, const sinew_transform* pose, const float* velocity,
                                  const float* angular_velocity) {
  if (!pose || !velocity || !angular_velocity) return fail(SINEW_INVALID_ARGUMENT, kNull);
  return with_prop(prop, [&](OwnedWorld& w, int index) {
    if (const sinew_status s = check_state(*pose, velocity, angular_velocity); s != SINEW_OK) return s;
    const Transform<float> to{Quat<float>(pose->rotation), Eigen::Map<const Vec3<float>>(pose->translation)};
    return answer(w.world.set_prop(index, to, Eigen::Map<const Vec3<float>>(velocity),
                                   Eigen::Map<const Vec3<float>>(angular_velocity)));
  });
}

sinew_status sinew_prop_park(sinew_prop prop) {
  return with_prop(prop, [&](OwnedWorld& w, int index) { return answer(w.world.park_prop(index)); });
}

sinew_status sinew_prop_get_report(sinew_prop prop, sinew_character_report* out) {
  return with_prop(prop, [&](OwnedWorld& w, int index) {
    return fill_sized(out, [&](sinew_character_report& r) {
      fill_report(w.world.prop_report(index), r);
      Eigen::Map<Vec3<double>>(r.position) = w.world.prop_pose(index).translation.cast<double>();
    });
  });
}

sinew_status sinew_loop_settings_init(sinew_loop_settings* settings) {
  return init<LoopSettings>(settings, kLoop);
}

sinew_status sinew_world_add_loop(sinew_world world, const sinew_loop_settings* settings, sinew_loop* out) {
  return set_up(world, [&](OwnedWorld& w) {
    if (!settings || !out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    LoopSettings read;
    if (const sinew_status s = read_settings(settings, read, kLoop); s != SINEW_OK) return s;
    if (const sinew_status s = find_anchor(world, settings->a, read.a); s != SINEW_OK) return s;
    if (const sinew_status s = find_anchor(world, settings->b, read.b); s != SINEW_OK) return s;
    Status status;
    const int index = w.world.add_loop(read, status);
    if (index < 0) return answer(status);
    w.loops = index + 1;
    *out = handle_in(world, Kind::kLoop, index);
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_loop_set_closed(sinew_loop loop, int32_t closed) {
  return with_loop(loop,
                   [&](OwnedWorld& w, int index) { return answer(w.world.set_loop(index, closed != 0)); });
}

sinew_status sinew_loop_get_state(sinew_loop loop, double* gap, float* force) {
  return with_loop(loop, [&](OwnedWorld& w, int index) {
    if (gap) *gap = w.world.loop_gap(index);
    if (force) write(w.world.loop_force(index), force);
    return sinew_status(SINEW_OK);
  });
}
