#include "sinew/effects/soft_tissue.h"

#include <algorithm>

namespace sinew {

void make_block(const Vec3<double>& size, const std::array<int, 3>& cells, SoftTissueSettings& out) {
  out.positions.clear();
  out.tetrahedra.clear();
  for (int k = 0; k <= cells[2]; ++k)
    for (int j = 0; j <= cells[1]; ++j)
      for (int i = 0; i <= cells[0]; ++i)
        out.positions.emplace_back(size.x() * i / cells[0], size.y() * j / cells[1], size.z() * k / cells[2]);
  const auto node = [&](int i, int j, int k) { return (k * (cells[1] + 1) + j) * (cells[0] + 1) + i; };
  // Kuhn's six tetrahedra of a cube: one for each order in which the axes can be walked from corner to
  // corner.
  constexpr int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i)
        for (int n = 0; n < 6; ++n) {
          int at[3] = {i, j, k};
          std::array<int, 4> t{};
          t[0] = node(i, j, k);
          for (int step = 0; step < 3; ++step) {
            ++at[orders[n][step]];
            t[step + 1] = node(at[0], at[1], at[2]);
          }
          if (n >= 3) std::swap(t[2], t[3]);  // odd orders are left-handed
          out.tetrahedra.push_back(t);
        }
}

ParticleBody make_soft_tissue(const SoftTissueSettings& s) {
  ParticleBody body;
  body.name = "tissue";
  body.frame = s.frame;
  body.radius = s.radius;
  body.friction = s.friction;
  body.damping = s.damping;
  for (const Vec3<double>& x : s.positions) body.nodes.push_back({x, 0, false});
  const int count = static_cast<int>(s.positions.size());
  for (const std::array<int, 4>& t : s.tetrahedra) {
    if (*std::min_element(t.begin(), t.end()) < 0 || *std::max_element(t.begin(), t.end()) >= count)
      return {};  // no nodes: refused
    Tetrahedron<double>& e = body.tetrahedra.emplace_back();
    Vec3<double> corners[4];
    for (int i = 0; i < 4; ++i) {
      e.node[i] = t[i];
      corners[i] = s.positions[t[i]];
    }
    if (!set_rest_shape(corners, e)) return {};
    set_material(s.young, s.poisson, e);
    for (const int i : t) body.nodes[i].mass += s.density * e.volume / 4;
  }
  for (const int node : s.fixed) {
    if (node < 0 || node >= count) return {};
    body.nodes[node].fixed = true;
  }
  return body;
}

}  // namespace sinew
