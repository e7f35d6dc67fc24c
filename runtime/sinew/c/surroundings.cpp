// What stands in a world of the C interface: obstacles, height fields, convex solids, the host's own shapes.
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "sinew/c/call.h"
#include "sinew/c/fields.h"
#include "sinew/c/hull.h"

namespace sinew::c {
namespace {

/// Friction, restitution and layers of what is static.
struct Surface {
  double friction = 0.8, restitution = 0;  ///< as World::add_obstacle
  std::uint32_t layers = 1;
};

void list_surface(auto& c, auto& s, auto&& f) {
  f("friction must be 0 to 1000", c.friction, s.friction, 0, 1000);
  f("restitution must be 0 to 1", c.restitution, s.restitution, 0, 1);
  f("", c.layers, s.layers);
}

struct Obstacle {
  Collider collider;
  std::uint32_t layers = Surface().layers;
};

constexpr auto kObstacle = [](auto& c, auto& s, auto&& f) {
  f("no such shape", c.shape, s.collider.shape);
  f("extent must be 0 to 1e6 m", c.extent, s.collider.size, 0, 1e6);
  f("an obstacle's rotation must be a unit quaternion, its place within 1e6 m", c.pose, s.collider.local);
  f("friction must be 0 to 1000", c.friction, s.collider.friction, 0, 1000);
  f("restitution must be 0 to 1", c.restitution, s.collider.restitution, 0, 1);
  f("", c.layers, s.layers);
};

struct Field {
  Surface surface;
  int columns = 0, rows = 0;
  Vec3<double> corner = Vec3<double>::Zero();
  double spacing = 1;
};

constexpr int kMostSamples = 1 << 15;  ///< along either side

constexpr auto kField = [](auto& c, auto& s, auto&& f) {
  list_surface(c, s.surface, f);
  f("columns must be 1 to 32768", c.columns, s.columns, 1, kMostSamples);
  f("rows must be 1 to 32768", c.rows, s.rows, 1, kMostSamples);
  f("corner must be within 1e6 m", c.corner, s.corner, -1e6, 1e6);
  f("spacing must be 1e-3 to 1e4 m", c.spacing, s.spacing, 1e-3, 1e4);
};

struct HostSurface {
  Surface surface;
  double half_thickness = 1e9;  ///< as StaticShape::half_thickness
};

constexpr auto kHost = [](auto& c, auto& s, auto&& f) {
  list_surface(c, s.surface, f);
  f("half_thickness must be above 1e-6 m", c.half_thickness, s.half_thickness, 1e-6, 1e9);
};

struct Solid {
  Surface surface;
  double inner_radius = 0.1;
  int faces = 0;
};

constexpr int kMostFaces = 1 << 16;

constexpr auto kSolid = [](auto& c, auto& s, auto&& f) {
  list_surface(c, s.surface, f);
  f("face_count must be 0 to 65536", c.face_count, s.faces, 0, kMostFaces);
  f("inner_radius must be above 1e-6 m", c.inner_radius, s.inner_radius, 1e-6, 1e6);
};

/// Normals that are unit, within reach?
sinew_status read_faces(const sinew_convex_solid& from, std::vector<ConvexSolid::Face>& to) {
  if (!from.faces) return fail(SINEW_INVALID_ARGUMENT, kNull);
  if (from.face_count < 1) return fail(SINEW_INVALID_ARGUMENT, "a convex solid has a face at least");
  for (int k = 0; k < from.face_count; ++k) {
    const double* const face = from.faces + std::size_t(k) * 4;
    const Vec3<double> normal(face[0], face[1], face[2]);
    if (!normal.allFinite() || !std::isfinite(face[3]))
      return fail(SINEW_NOT_FINITE, "a face is not finite", k);
    if (!(std::abs(normal.norm() - 1) < 0.01))
      return fail(SINEW_INVALID_ARGUMENT, "a face's normal must be a unit vector", k);
    if (std::abs(face[3]) > 1e6) return fail(SINEW_OUT_OF_RANGE, "a face must be within 1e6 m", k);
    to.push_back({normal.normalized(), face[3]});
  }
  return SINEW_OK;
}

/// Asks the host. An answer that is none is far away: NaN would go through everything.
class HostShape final : public StaticShape {
 public:
  HostShape(sinew_distance ask, void* context, double half_thickness)
      : ask_(ask), context_(context), half_thickness_(half_thickness) {}

  SignedDistance<double> distance(const Vec3<double>& point) const noexcept override {
    SignedDistance<double> d;
    d.distance = ask_(context_, point.data(), d.normal.data());
    const double norm = d.normal.norm();
    if (std::isfinite(d.distance) && norm > 0.5 && norm < 2) {
      d.normal /= norm;
      return d;
    }
    return {.distance = 1e9};
  }
  double half_thickness() const noexcept override { return half_thickness_; }

 private:
  sinew_distance ask_;
  void* context_;
  double half_thickness_;
};

sinew_status add_shape(OwnedWorld& world, std::unique_ptr<StaticShape> shape, const Surface& surface) {
  world.shapes.push_back(std::move(shape));
  const Status status =
      world.world.add_obstacle(*world.shapes.back(), surface.friction, surface.restitution, surface.layers);
  if (!status) world.shapes.pop_back();
  return answer(status);
}

/// Set and finite?
sinew_status check_heights(const double* heights, std::size_t count) {
  if (!heights) return fail(SINEW_INVALID_ARGUMENT, kNull);
  for (std::size_t k = 0; k < count; ++k)
    if (!(std::abs(heights[k]) <= 1e6))
      return fail(std::isfinite(heights[k]) ? SINEW_OUT_OF_RANGE : SINEW_NOT_FINITE,
                  "heights must be finite and within 1e6 m", static_cast<int>(k));
  return SINEW_OK;
}

}  // namespace
}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_obstacle_init(sinew_obstacle* settings) {
  return init<Obstacle>(settings, kObstacle);
}

sinew_status sinew_height_field_init(sinew_height_field* settings) {
  return init<Field>(settings, kField);
}

sinew_status sinew_convex_solid_init(sinew_convex_solid* settings) {
  return init<Solid>(settings, kSolid);
}

sinew_status sinew_host_shape_init(sinew_host_shape* settings) {
  return init<HostSurface>(settings, kHost);
}

sinew_status sinew_world_add_obstacle(sinew_world world, const sinew_obstacle* settings) {
  return set_up(world, [&](OwnedWorld& w) {
    if (!settings) return fail(SINEW_INVALID_ARGUMENT, kNull);
    Obstacle obstacle;
    if (const sinew_status status = read_settings(settings, obstacle, kObstacle); status != SINEW_OK)
      return status;
    return answer(w.world.add_obstacle(obstacle.collider, obstacle.layers));
  });
}

sinew_status sinew_world_add_convex_obstacle(sinew_world world, const sinew_obstacle* settings,
                                             const double* points, int32_t count) {
  return set_up(world, [&](OwnedWorld& w) {
    if (!settings) return fail(SINEW_INVALID_ARGUMENT, kNull);
    Obstacle obstacle;
    if (const sinew_status status = read_settings(settings, obstacle, kObstacle); status != SINEW_OK)
      return status;
    const ConvexHull* hull = nullptr;
    if (const sinew_status status = add_hull(w, points, count, hull); status != SINEW_OK) return status;
    Collider convex = convex_collider(*hull);
    convex.local = obstacle.collider.local;
    convex.friction = obstacle.collider.friction;
    convex.restitution = obstacle.collider.restitution;
    return answer(w.world.add_obstacle(convex, obstacle.layers));
  });
}

sinew_status sinew_world_add_height_field(sinew_world world, const sinew_height_field* settings) {
  return set_up(world, [&](OwnedWorld& w) {
    if (!settings) return fail(SINEW_INVALID_ARGUMENT, kNull);
    Field field;
    if (const sinew_status status = read_settings(settings, field, kField); status != SINEW_OK) return status;
    const std::size_t count = std::size_t(field.columns) * std::size_t(field.rows);
    if (const sinew_status status = check_heights(settings->heights, count); status != SINEW_OK)
      return status;
    return add_shape(w,
                     std::make_unique<HeightField>(std::span(settings->heights, count),
                                                   std::size_t(field.columns), field.corner, field.spacing),
                     field.surface);
  });
}

sinew_status sinew_world_add_convex_solid(sinew_world world, const sinew_convex_solid* settings) {
  return set_up(world, [&](OwnedWorld& w) {
    if (!settings) return fail(SINEW_INVALID_ARGUMENT, kNull);
    Solid solid;
    if (const sinew_status status = read_settings(settings, solid, kSolid); status != SINEW_OK) return status;
    std::vector<ConvexSolid::Face> faces;
    if (const sinew_status status = read_faces(*settings, faces); status != SINEW_OK) return status;
    return add_shape(w, std::make_unique<ConvexSolid>(faces, solid.inner_radius), solid.surface);
  });
}

sinew_status sinew_world_add_host_shape(sinew_world world, const sinew_host_shape* settings) {
  return set_up(world, [&](OwnedWorld& w) {
    if (!settings) return fail(SINEW_INVALID_ARGUMENT, kNull);
    HostSurface host;
    if (const sinew_status status = read_settings(settings, host, kHost); status != SINEW_OK) return status;
    if (!settings->distance) return fail(SINEW_INVALID_ARGUMENT, kNull);
    return add_shape(w,
                     std::make_unique<HostShape>(settings->distance, settings->context, host.half_thickness),
                     host.surface);
  });
}
