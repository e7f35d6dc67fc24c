#include "sinew/effects/cloth.h"

#include <algorithm>
#include <map>
#include <utility>

namespace sinew {
namespace {

/// An edge and what lies beside it.
struct Edge {
  double area = 0;              ///< m², of its triangles
  std::array<int, 2> across{};  ///< their third corners
  int triangles = 0;
};

/// Cotangent of the angle at a between b and c.
double cotangent(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
  return (b - a).dot(c - a) / (b - a).cross(c - a).norm();
}

/// ½ (B / A) |Σ wᵢ xᵢ|² of the two triangles at an edge: the square of their bend. The paper's 3 B / A stores
/// 3/2 B/r² in a sheet rolled to the radius r, on equilateral and on right-angled triangles; a third is
/// meant.
void add_bend(const ClothSettings& s, int a, int b, const Edge& edge, ParticleBody& body) {
  const int nodes[] = {a, b, edge.across[0], edge.across[1]};
  const auto x = [&](int i) { return s.positions[nodes[i]]; };
  const double at_a[] = {cotangent(x(0), x(1), x(2)), cotangent(x(0), x(1), x(3))};
  const double at_b[] = {cotangent(x(1), x(0), x(2)), cotangent(x(1), x(0), x(3))};
  Stencil<double>& e = body.stencils.emplace_back();
  e.count = 4;
  std::copy_n(nodes, 4, e.node);
  e.weight[0] = at_b[0] + at_b[1];
  e.weight[1] = at_a[0] + at_a[1];
  e.weight[2] = -at_a[0] - at_b[0];
  e.weight[3] = -at_a[1] - at_b[1];
  e.stiffness = s.bending / edge.area;
}

}  // namespace

void make_grid(double width, double height, int columns, int rows, ClothSettings& out) {
  out.positions.clear();
  out.triangles.clear();
  for (int row = 0; row <= rows; ++row)
    for (int column = 0; column <= columns; ++column)
      out.positions.emplace_back(width * column / columns, 0, -height * row / rows);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const int a = row * (columns + 1) + column, b = a + 1, c = a + columns + 1, d = c + 1;
      // Diagonals alternate: none of the two directions is the softer one.
      if ((row + column) % 2 == 0) {
        out.triangles.push_back({a, c, d});
        out.triangles.push_back({a, d, b});
      } else {
        out.triangles.push_back({a, c, b});
        out.triangles.push_back({b, c, d});
      }
    }
}

ParticleBody make_cloth(const ClothSettings& s) {
  ParticleBody body;
  body.name = "cloth";
  body.frame = s.frame;
  body.radius = s.radius;
  body.friction = s.friction;
  body.damping = s.damping;
  for (const Vec3<double>& x : s.positions) body.nodes.push_back({x, 0, false});
  std::map<std::pair<int, int>, Edge> edges;
  const int count = static_cast<int>(s.positions.size());
  for (const std::array<int, 3>& t : s.triangles) {
    if (*std::min_element(t.begin(), t.end()) < 0 || *std::max_element(t.begin(), t.end()) >= count)
      return {};  // no nodes: refused
    const Vec3<double>& x = s.positions[t[0]];
    const double area = (s.positions[t[1]] - x).cross(s.positions[t[2]] - x).norm() / 2;
    for (int i = 0; i < 3; ++i) {
      body.nodes[t[i]].mass += s.density * area / 3;
      Edge& edge = edges[std::minmax(t[i], t[(i + 1) % 3])];
      edge.area += area;
      if (edge.triangles < 2) edge.across[edge.triangles] = t[(i + 2) % 3];
      ++edge.triangles;
    }
  }
  for (const int node : s.fixed) {
    if (node < 0 || node >= count) return {};
    body.nodes[node].fixed = true;
  }
  for (const auto& [ends, edge] : edges) {
    Stencil<double>& e = body.stencils.emplace_back();
    e.node[0] = ends.first;
    e.node[1] = ends.second;
    e.length = (s.positions[ends.second] - s.positions[ends.first]).norm();
    e.stiffness = s.stretch * edge.area / (e.length * e.length);
  }
  for (const auto& [ends, edge] : edges)
    if (edge.triangles == 2 && s.bending > 0) add_bend(s, ends.first, ends.second, edge, body);
  return body;
}

}  // namespace sinew
