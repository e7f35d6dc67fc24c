// Strands, cloth and soft tissue of the C interface.
#include "sinew/effects/particles.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sinew/c/anchor.h"
#include "sinew/c/call.h"
#include "sinew/c/fields.h"
#include "sinew/c/report.h"
#include "sinew/effects/cloth.h"
#include "sinew/effects/soft_tissue.h"
#include "sinew/effects/strand.h"

namespace sinew::c {
namespace {

constexpr int kMostNodes = 1 << 16, kMostElements = 1 << 20;

void list_common(auto& c, auto& s, auto&& f) {
  f("a frame's rotation must be a unit quaternion, its place within 1e6 m", c.frame.pose, s.frame.frame);
  f("radius must be 0 to 1e3 m", c.radius, s.radius, 0, 1e3);
  f("friction must be 0 to 1000", c.friction, s.friction, 0, 1000);
  f("damping must be 0 to 1e6 N s/m", c.damping, s.damping, 0, 1e6);
}

void list_mesh(auto& c, auto& s, auto&& f) {
  f("node_count must be 0 to 65536", c.node_count, s.counts.nodes, 0, kMostNodes);
  f("fixed_count must be 0 to 65536", c.fixed_count, s.counts.fixed, 0, kMostNodes);
  list_common(c, s.settings, f);
}

constexpr auto kStrand = [](auto& c, auto& s, auto&& f) {
  f("particles must be 1 to 65536", c.particles, s.particles, 1, kMostNodes);
  list_common(c, s, f);
  f("root must be within 1e6 m", c.root, s.root, -1e6, 1e6);
  f("direction must be within 1e6", c.direction, s.direction, -1e6, 1e6);
  f("length must be 1e-6 to 1e4 m", c.length, s.length, 1e-6, 1e4);
  f("mass must be 1e-9 to 1e6 kg", c.mass, s.mass, 1e-9, 1e6);
  f("stretch must be 1e-9 to 1e3", c.stretch, s.stretch, 1e-9, 1e3);
  f("bending must be 0 to 1e9 N m2", c.bending, s.bending, 0, 1e9);
  f("", c.clamped, s.clamped);
};

/// Nodes and elements, as the C structs hold them.
struct Counts {
  int nodes = 0, elements = 0, fixed = 0;
};

struct Cloth {
  ClothSettings settings;
  Counts counts;
};

constexpr auto kCloth = [](auto& c, auto& s, auto&& f) {
  list_mesh(c, s, f);
  f("triangle_count must be 0 to 1048576", c.triangle_count, s.counts.elements, 0, kMostElements);
  f("density must be 1e-9 to 1e6 kg/m2", c.density, s.settings.density, 1e-9, 1e6);
  f("stretch must be 0 to 1e9 N/m", c.stretch, s.settings.stretch, 0, 1e9);
  f("bending must be 0 to 1e9 N m", c.bending, s.settings.bending, 0, 1e9);
};

struct Tissue {
  SoftTissueSettings settings;
  Counts counts;
};

constexpr auto kTissue = [](auto& c, auto& s, auto&& f) {
  list_mesh(c, s, f);
  f("tetrahedron_count must be 0 to 1048576", c.tetrahedron_count, s.counts.elements, 0, kMostElements);
  f("density must be 1e-9 to 1e9 kg/m3", c.density, s.settings.density, 1e-9, 1e9);
  f("young must be 1e-6 to 1e15 Pa", c.young, s.settings.young, 1e-6, 1e15);
  f("poisson must be -0.99 to 0.4999", c.poisson, s.settings.poisson, -0.99, 0.4999);
};

sinew_status read_positions(const double* from, int count, std::vector<Vec3<double>>& to) {
  if (!from && count > 0) return fail(SINEW_INVALID_ARGUMENT, kNull);
  for (int n = 0; n < count; ++n) {
    const Vec3<double> at(from + 3 * n);
    if (!at.allFinite()) return fail(SINEW_NOT_FINITE, "a node's position is not finite", n);
    if (at.norm() > 1e6) return fail(SINEW_OUT_OF_RANGE, "a node's position must be within 1e6 m", n);
    to.push_back(at);
  }
  return SINEW_OK;
}

/// Elements of N nodes each.
template <std::size_t N>
sinew_status read_elements(const int32_t* from, const Counts& counts, std::vector<std::array<int, N>>& to) {
  if (!from && counts.elements > 0) return fail(SINEW_INVALID_ARGUMENT, kNull);
  for (int n = 0; n < counts.elements; ++n) {
    std::array<int, N>& element = to.emplace_back();
    std::copy_n(from + std::size_t(n) * N, N, element.begin());
    if (!nodes_exist(element, std::size_t(counts.nodes)))
      return fail(SINEW_INVALID_ARGUMENT, "an element of a node that there is not", n);
  }
  return SINEW_OK;
}

sinew_status read_fixed(const int32_t* from, const Counts& counts, std::vector<int>& to) {
  if (!from && counts.fixed > 0) return fail(SINEW_INVALID_ARGUMENT, kNull);
  to.assign(from, from + counts.fixed);
  if (!nodes_exist(to, std::size_t(counts.nodes)))
    return fail(SINEW_INVALID_ARGUMENT, "a fixed node that there is not");
  return SINEW_OK;
}

/// What the lists do not read: arrays of what is made of nodes.
sinew_status read_arrays(const sinew_cloth& c, Cloth& s) {
  sinew_status status = read_positions(c.positions, s.counts.nodes, s.settings.positions);
  if (status == SINEW_OK) status = read_elements(c.triangles, s.counts, s.settings.triangles);
  return status == SINEW_OK ? read_fixed(c.fixed, s.counts, s.settings.fixed) : status;
}

sinew_status read_arrays(const sinew_soft_tissue& c, Tissue& s) {
  sinew_status status = read_positions(c.positions, s.counts.nodes, s.settings.positions);
  if (status == SINEW_OK) status = read_elements(c.tetrahedra, s.counts, s.settings.tetrahedra);
  return status == SINEW_OK ? read_fixed(c.fixed, s.counts, s.settings.fixed) : status;
}

sinew_status add(sinew_world world, OwnedWorld& w, const ParticleBody& body, sinew_particles* out) {
  if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
  w.nodes.push_back(static_cast<int>(body.nodes.size()));
  Status status;
  const int index = w.world.add_particles(body, status);
  if (index < 0) {
    w.nodes.pop_back();
    return answer(status);
  }
  *out = handle_in(world, Kind::kParticles, index);
  return SINEW_OK;
}

/// Of cloth and tissue: all that the caller set, then make(settings) → ParticleBody.
template <class S, class C, class List, class Make>
sinew_status add_made(sinew_world world, const C* settings, List&& list, sinew_particles* out,
                      Make&& make) noexcept {
  return set_up(world, [&](OwnedWorld& w) {
    if (!settings) return fail(SINEW_INVALID_ARGUMENT, kNull);
    S read;
    if (const sinew_status s = read_settings(settings, read, list); s != SINEW_OK) return s;
    if (const sinew_status s = find_anchor(world, settings->frame, read.settings.frame); s != SINEW_OK)
      return s;
    if (const sinew_status s = read_arrays(*settings, read); s != SINEW_OK) return s;
    return add(world, w, make(read.settings), out);
  });
}

/// act(OwnedWorld&, index) of a body of particles.
template <class Act>
sinew_status with_particles(sinew_particles handle, Act&& act) noexcept {
  return in_world(handle, Kind::kParticles, false, [&](OwnedWorld& world) {
    const int index = index_of(handle);
    return index < world.world.particles_count() ? act(world, index) : refuse(handle, Kind::kParticles);
  });
}

}  // namespace
}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_strand_init(sinew_strand* settings) {
  return init<StrandSettings>(settings, kStrand);
}

sinew_status sinew_cloth_init(sinew_cloth* settings) {
  return init<Cloth>(settings, kCloth);
}

sinew_status sinew_soft_tissue_init(sinew_soft_tissue* settings) {
  return init<Tissue>(settings, kTissue);
}

sinew_status sinew_world_add_strand(sinew_world world, const sinew_strand* settings, sinew_particles* out) {
  return set_up(world, [&](OwnedWorld& w) {
    StrandSettings read;
    if (const sinew_status s = read_settings(settings, read, kStrand); s != SINEW_OK) return s;
    if (settings)
      if (const sinew_status s = find_anchor(world, settings->frame, read.frame); s != SINEW_OK) return s;
    if (!(read.direction.norm() > 1e-9)) return fail(SINEW_INVALID_ARGUMENT, "direction must not be zero");
    return add(world, w, make_strand(read), out);
  });
}

sinew_status sinew_world_add_cloth(sinew_world world, const sinew_cloth* settings, sinew_particles* out) {
  return add_made<Cloth>(world, settings, kCloth, out, make_cloth);
}

sinew_status sinew_world_add_soft_tissue(sinew_world world, const sinew_soft_tissue* settings,
                                         sinew_particles* out) {
  return add_made<Tissue>(world, settings, kTissue, out, make_soft_tissue);
}

sinew_status sinew_world_get_particles(sinew_world world, int32_t index, sinew_particles* out) {
  return with_world(world, [&](OwnedWorld& w) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (index < 0 || index >= w.world.particles_count())
      return fail(SINEW_INVALID_ARGUMENT, "no such body of particles in this world", index);
    *out = handle_in(world, Kind::kParticles, index);
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_particles_get_nodes(sinew_particles particles, sinew_particle* out, int32_t capacity,
                                       int32_t* count) {
  return with_particles(particles, [&](OwnedWorld& w, int index) {
    if (!count || (!out && capacity != 0)) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (capacity < 0) return fail(SINEW_INVALID_ARGUMENT, "the capacity is negative");
    *count = w.nodes[std::size_t(index)];
    if (capacity < *count) return fail(SINEW_TOO_SMALL, "room for fewer nodes than there are");
    for (int n = 0; n < *count; ++n) {
      const Vec3<float> position = w.world.particle(index, n), velocity = w.world.particle_velocity(index, n);
      std::copy_n(position.data(), 3, out[n].position);
      std::copy_n(velocity.data(), 3, out[n].velocity);
    }
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_particles_reset(sinew_particles particles, const float* velocity) {
  return with_particles(particles, [&](OwnedWorld& w, int index) {
    if (!velocity) return fail(SINEW_INVALID_ARGUMENT, kNull);
    const Vec3<float> moving(velocity);
    if (!moving.allFinite()) return fail(SINEW_NOT_FINITE, "a velocity is not finite");
    if (moving.norm() > 1e5f) return fail(SINEW_OUT_OF_RANGE, "a velocity must be below 1e5 m/s");
    return answer(w.world.reset_particles(index, moving));
  });
}

sinew_status sinew_particles_get_report(sinew_particles particles, sinew_character_report* out) {
  return with_particles(particles, [&](OwnedWorld& w, int index) {
    return fill_sized(out, [&](sinew_character_report& r) {
      fill_report(w.world.particle_report(index), r);
      Eigen::Map<Vec3<double>>(r.position) = w.world.particle(index, 0).cast<double>();
    });
  });
}
