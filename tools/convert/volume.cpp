#include "convert/volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace sinew::convert {
namespace {

using Cell = std::array<int, 3>;

Vec3<double> position(const Mesh& mesh, std::size_t v) {
  return {mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]};
}

/// Cubic cells over a box, one cell of margin around the meshes.
struct Grid {
  Vec3<double> low = Vec3<double>::Constant(1e300);
  double step = 1;
  Cell size{1, 1, 1};

  explicit Grid(std::span<const Mesh> meshes) {
    Vec3<double> high = -low;
    for (const Mesh& mesh : meshes)
      for (std::size_t v = 0; v < mesh.positions.size() / 3; ++v) {
        low = low.cwiseMin(position(mesh, v));
        high = high.cwiseMax(position(mesh, v));
      }
    const Vec3<double> extent = (high - low).cwiseMax(1e-6);
    step = extent.maxCoeff() / 128;
    // Off the round numbers that vertices like to lie on.
    low -= Vec3<double>(1.013, 1.017, 1.019) * step;
    for (int k = 0; k < 3; ++k) size[k] = static_cast<int>(extent[k] / step) + 3;
  }
  std::size_t count() const { return std::size_t(size[0]) * std::size_t(size[1]) * std::size_t(size[2]); }
  std::size_t index(const Cell& c) const {
    return (std::size_t(c[0]) * std::size_t(size[1]) + std::size_t(c[1])) * std::size_t(size[2]) +
           std::size_t(c[2]);
  }
  /// Between the indices of neighbours along `axis`.
  std::size_t stride(int axis) const {
    return axis == 2 ? 1 : std::size_t(size[axis + 1]) * stride(axis + 1);
  }
  Vec3<double> center(const Cell& c) const {
    return low + step * Vec3<double>(c[0] + 0.5, c[1] + 0.5, c[2] + 0.5);
  }
  bool holds(const Cell& c) const {
    return c[0] >= 0 && c[1] >= 0 && c[2] >= 0 && c[0] < size[0] && c[1] < size[1] && c[2] < size[2];
  }
  Cell cell(const Vec3<double>& p) const {
    Cell c;
    for (int k = 0; k < 3; ++k) c[k] = std::clamp(static_cast<int>((p[k] - low[k]) / step), 0, size[k] - 1);
    return c;
  }
};

/// Counts, for each cell, along how many of the three axes its centre lies inside.
class Inside {
 public:
  Inside(const Grid& grid, std::span<const Mesh> meshes) : grid_(grid), votes_(grid.count(), 0) {
    for (int axis = 0; axis < 3; ++axis) vote(axis, meshes);
  }
  bool operator()(std::size_t cell) const { return votes_[cell] >= 2; }

  /// Whether a cell is inside or touches one that is, if only at a corner.
  std::vector<std::uint8_t> with_border() const {
    std::vector<std::uint8_t> near(grid_.count());
    for (std::size_t i = 0; i < near.size(); ++i) near[i] = (*this)(i) ? 1 : 0;
    for (int axis = 0; axis < 3; ++axis) {  // the grid's margin has none inside
      const std::vector<std::uint8_t> of = near;
      const std::size_t stride = grid_.stride(axis);
      for (std::size_t i = stride; i + stride < near.size(); ++i)
        near[i] = std::max({of[i - stride], of[i], of[i + stride]});
    }
    return near;
  }

 private:
  struct Crossing {
    std::size_t line;  ///< index of its first cell
    int cell, change;  ///< the first cell behind it, what the winding number changes by
  };

  /// Where lines through cell centres along `axis` cross triangles, line by line from their beginnings.
  std::vector<Crossing> crossings(int axis, std::span<const Mesh> meshes) const {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::vector<Crossing> found;
    for (const Mesh& mesh : meshes)
      for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        const Vec3<double> a = position(mesh, mesh.indices[t]), b = position(mesh, mesh.indices[t + 1]),
                           c = position(mesh, mesh.indices[t + 2]);
        const double area = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
        if (area == 0) continue;
        const Cell first = grid_.cell(a.cwiseMin(b).cwiseMin(c)),
                   last = grid_.cell(a.cwiseMax(b).cwiseMax(c));
        for (int i = first[u]; i <= last[u]; ++i)
          for (int j = first[v]; j <= last[v]; ++j) {
            const double x = grid_.low[u] + (i + 0.5) * grid_.step, y = grid_.low[v] + (j + 0.5) * grid_.step;
            const auto side = [&](const Vec3<double>& p, const Vec3<double>& q) {
              return ((q[u] - p[u]) * (y - p[v]) - (q[v] - p[v]) * (x - p[u])) / area;
            };
            const double wc = side(a, b), wa = side(b, c), wb = side(c, a);
            if (wa < 0 || wb < 0 || wc < 0) continue;
            const double height = wa * a[axis] + wb * b[axis] + wc * c[axis];
            Cell at;
            at[u] = i;
            at[v] = j;
            at[axis] = static_cast<int>(std::ceil((height - grid_.low[axis]) / grid_.step - 0.5));
            if (!grid_.holds(at)) continue;
            const int cell = std::exchange(at[axis], 0);
            found.push_back({grid_.index(at), cell, area > 0 ? 1 : -1});
          }
      }
    std::sort(found.begin(), found.end(), [](const Crossing& a, const Crossing& b) {
      return std::pair(a.line, a.cell) < std::pair(b.line, b.cell);
    });
    return found;
  }
  /// A line enters the solid and leaves it where it crosses triangles. One that never comes out again went
  /// through a hole: it has no say.
  void vote(int axis, std::span<const Mesh> meshes) {
    const std::vector<Crossing> all = crossings(axis, meshes);
    const std::size_t stride = grid_.stride(axis);
    for (auto line = all.begin(); line != all.end();) {
      int number = 0;
      auto end = line;
      for (; end != all.end() && end->line == line->line; ++end) number += end->change;
      if (number == 0)
        for (auto from = line; from + 1 != end; ++from) {
          number += from->change;
          for (int cell = from->cell; number != 0 && cell < from[1].cell; ++cell)
            ++votes_[line->line + std::size_t(cell) * stride];
        }
      line = end;
    }
  }

  const Grid& grid_;
  std::vector<std::uint8_t> votes_;
};

struct Site {
  Vec3<double> at;
  int part;
};

/// Index of the (nearly) nearest site for each cell that is inside: sites spread from cell to cell as long as
/// they come nearer. O(cells inside), each of which changes hands a few times.
class NearestSites {
 public:
  NearestSites(const Grid& grid, const Inside& inside, const std::vector<Site>& sites)
      : grid_(grid), sites_(sites), claim_of_cell_(grid.count(), -1) {
    for (std::size_t s = 0; s < sites.size(); ++s)
      claim(grid.cell(sites[s].at), static_cast<int>(s), sites[s].at);
    const std::vector<Cell> seeds = next_;
    const std::vector<std::uint8_t> near = inside.with_border();
    spread([&](std::size_t cell) { return near[cell] != 0; });
    // A piece that has no vertex near by is reached from outside.
    for (std::size_t i = 0; i < grid.count(); ++i)
      if (inside(i) && claim_of_cell_[i] < 0) {
        next_ = seeds;
        for (Claim& claim : claims_) claim.spread = -1;
        spread([](std::size_t) { return true; });
        break;
      }
  }
  int operator[](std::size_t cell) const { return claims_[claim_of_cell_[cell]].owner; }

 private:
  struct Claim {
    double distance = std::numeric_limits<double>::infinity();  ///< m², to the owner
    int owner = -1, spread = -1;                                ///< that it has, that it handed on
  };

  Claim& claim_of(const Cell& c) {
    int& index = claim_of_cell_[grid_.index(c)];
    if (index < 0) {
      index = static_cast<int>(claims_.size());
      claims_.emplace_back();
    }
    return claims_[index];
  }
  void claim(const Cell& c, int site, const Vec3<double>& at) {
    Claim& claim = claim_of(c);
    const double distance = (at - grid_.center(c)).squaredNorm();
    if (claim.distance <= distance) return;
    claim.distance = distance;
    claim.owner = site;
    next_.push_back(c);
  }
  template <class Within>
  void spread(const Within& within) {
    std::vector<Cell> front;
    while (!next_.empty()) {
      front.swap(next_);
      next_.clear();
      for (const Cell& c : front) {
        Claim& claimed = claim_of(c);
        if (claimed.spread == claimed.owner) continue;
        const int site = claimed.spread = claimed.owner;
        const Vec3<double> at = sites_[static_cast<std::size_t>(site)].at;
        for (int k = 0; k < 6; ++k) {
          Cell neighbour = c;
          neighbour[k / 2] += k % 2 ? 1 : -1;
          if (grid_.holds(neighbour) && within(grid_.index(neighbour))) claim(neighbour, site, at);
        }
      }
    }
  }

  const Grid& grid_;
  const std::vector<Site>& sites_;
  std::vector<int> claim_of_cell_;  ///< -1: none so far, as of most cells
  std::vector<Claim> claims_;
  std::vector<Cell> next_;
};

}  // namespace

Mat3<double> inertia_of(const Solid& solid, double mass) {
  const Mat3<double> p = solid.second_moment * (mass / solid.volume);
  return p.trace() * Mat3<double>::Identity() - p;
}

std::vector<Solid> part_solids(std::span<const Mesh> meshes,
                               const std::vector<std::vector<int>>& part_of_vertex, int parts) {
  std::vector<Solid> solids(static_cast<std::size_t>(parts));
  std::vector<Site> sites;
  for (std::size_t m = 0; m < meshes.size(); ++m)
    for (std::size_t v = 0; v < meshes[m].positions.size() / 3; ++v)
      sites.push_back({position(meshes[m], v), part_of_vertex[m][v]});
  if (sites.empty()) return solids;
  const Grid grid(meshes);
  const Inside inside(grid, meshes);
  const NearestSites owner(grid, inside, sites);
  const double cell = grid.step * grid.step * grid.step;
  const auto each_cell = [&](auto use) {
    Cell c;
    for (c[0] = 0; c[0] < grid.size[0]; ++c[0])
      for (c[1] = 0; c[1] < grid.size[1]; ++c[1])
        for (c[2] = 0; c[2] < grid.size[2]; ++c[2])
          if (const std::size_t i = grid.index(c); inside(i))
            use(solids[static_cast<std::size_t>(sites[static_cast<std::size_t>(owner[i])].part)],
                grid.center(c));
  };
  each_cell([&](Solid& solid, const Vec3<double>& at) {
    solid.volume += cell;
    solid.center += at;
    ++solid.cells;
  });
  for (Solid& solid : solids)
    if (solid.cells > 0) solid.center /= solid.cells;
  each_cell([&](Solid& solid, const Vec3<double>& at) {
    const Vec3<double> arm = at - solid.center;
    // A cube's own second moment is step²/12 along each axis.
    solid.second_moment +=
        cell * (arm * arm.transpose() + grid.step * grid.step / 12 * Mat3<double>::Identity());
  });
  return solids;
}

}  // namespace sinew::convert
