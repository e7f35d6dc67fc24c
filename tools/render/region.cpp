#include "render/region.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace sinew::render {
namespace {

/// Pixels. Smaller ones fit more closely, but every row of them is a draw call or more of each pass.
constexpr int kTile = 32;
/// Reach of the ambient occlusion (shaders.h: 0.26) with what perspective adds at the picture's edge, in
/// units.
constexpr float kOcclusionReach = 0.3f;
/// Half width of a shadow's soft edge on the floor with the map's texels, in units.
constexpr float kShadowEdge = 0.08f;

struct Span {
  float left, bottom, right, top;  ///< pixels
};

/// Which tiles of the picture are touched.
class Tiles {
 public:
  explicit Tiles(const Projection& p)
      : width_(p.width),
        height_(p.height),
        across_((p.width + kTile - 1) / kTile),
        up_((p.height + kTile - 1) / kTile),
        marks_(std::size_t(across_) * std::size_t(up_), 0) {}

  void mark(const Span& s) {
    const int left = std::max(0, tile(s.left)), right = std::min(across_ - 1, tile(s.right)),
              top = std::min(up_ - 1, tile(s.top));
    for (int y = std::max(0, tile(s.bottom)); y <= top; ++y)
      for (int x = left; x <= right; ++x) at(x, y) = 1;
  }
  void mark_all() { std::fill(marks_.begin(), marks_.end(), 1); }
  void add(const Tiles& other) {
    std::transform(marks_.begin(), marks_.end(), other.marks_.begin(), marks_.begin(), std::bit_or<>());
  }
  void take_away(const Tiles& other) {
    std::transform(marks_.begin(), marks_.end(), other.marks_.begin(), marks_.begin(), std::greater<>());
  }
  /// Marks what `other` has within `margin` pixels, too.
  void mark_around(const Tiles& other, float margin) {
    for (int y = 0; y < up_; ++y)
      for (int x = 0; x < across_; ++x)
        if (other.marks_[other.index(x, y)])
          mark({float(x * kTile) - margin, float(y * kTile) - margin, float((x + 1) * kTile) - 1 + margin,
                float((y + 1) * kTile) - 1 + margin});
  }

  /// Rows of tiles with that mark; equal ones above each other are one area.
  std::vector<Area> areas(std::uint8_t marked) const {
    std::vector<Area> all;
    std::vector<std::size_t> below, row;  // areas that end at this row
    for (int y = 0; y < up_; ++y) {
      row.clear();
      for (int x = 0; x < across_; ++x) {
        const int first = x;
        while (x < across_ && marks_[index(x, y)] == marked) ++x;
        if (x == first) continue;
        const Area box{first * kTile, y * kTile, std::min(width_, x * kTile),
                       std::min(height_, (y + 1) * kTile)};
        const auto same = std::find_if(below.begin(), below.end(), [&](std::size_t k) {
          return all[k].left == box.left && all[k].right == box.right;
        });
        if (same != below.end()) {
          all[*same].top = box.top;
          row.push_back(*same);
        } else {
          row.push_back(all.size());
          all.push_back(box);
        }
      }
      std::swap(below, row);
    }
    return all;
  }

 private:
  static int tile(float pixel) {
    return static_cast<int>(std::floor(std::clamp(pixel, -1e6f, 1e6f) / kTile));
  }
  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(across_) + std::size_t(x); }
  std::uint8_t& at(int x, int y) { return marks_[index(x, y)]; }

  int width_, height_, across_, up_;
  std::vector<std::uint8_t> marks_;
};

/// Vertices on the screen.
struct Shown {
  std::vector<Vec3<float>>
      at;  ///< x, y in pixels, distance along the view in m; where that is small, x and y say nothing
};

Shown project(const Geometry& geometry, const Projection& p, const Vec3<float>& slant) {
  Shown shown;
  shown.at.reserve(geometry.vertices.size());
  for (const Vertex& vertex : geometry.vertices) {
    Vec3<float> place(vertex.position[0], vertex.position[1], vertex.position[2]);
    place -= (place.z() - p.ground) * slant;
    const Eigen::Vector4f clip = p.view_projection * place.homogeneous();
    shown.at.emplace_back((clip.x() / clip.w() + 1) * 0.5f * float(p.width),
                          (clip.y() / clip.w() + 1) * 0.5f * float(p.height), clip.w());
  }
  return shown;
}

/// What marking triangles has found.
struct Marked {
  bool anywhere = false;  ///< one reaches from before the camera to behind it
  float nearest = 1e30f;  ///< m, of what is in the picture
};

/// Marks triangles, but not those behind the camera, with `wide` (m) and a pixel for antialiasing around
/// them.
Marked mark_triangles(const Geometry& geometry, const Shown& shown, const Projection& p, float wide,
                      Tiles& tiles) {
  const float least = 1e-3f * p.unit;
  Marked marked;
  for (std::size_t i = 0; i + 2 < geometry.indices.size(); i += 3) {
    const Vec3<float>&a = shown.at[geometry.indices[i]], &b = shown.at[geometry.indices[i + 1]],
          &c = shown.at[geometry.indices[i + 2]];
    const float nearest = std::min({a.z(), b.z(), c.z()});
    if (nearest <= least) {
      marked.anywhere = marked.anywhere || std::max({a.z(), b.z(), c.z()}) > least;
      continue;
    }
    const Vec3<float> low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    const float margin = 1 + wide * p.focal / nearest;
    tiles.mark({low.x() - margin, low.y() - margin, high.x() + margin, high.y() + margin});
    if (high.x() >= -margin && low.x() <= float(p.width) + margin && high.y() >= -margin &&
        low.y() <= float(p.height) + margin)
      marked.nearest = std::min(marked.nearest, nearest);
  }
  return marked;
}

}  // namespace

Regions find_regions(const Geometry& geometry, const Projection& p) {
  Tiles figure(p), near(p), dark(p);
  const Vec3<float> slant = p.light_direction / p.light_direction.z();
  const Marked seen = mark_triangles(geometry, project(geometry, p, Vec3<float>::Zero()), p, 0, figure);
  const Marked shadow = mark_triangles(geometry, project(geometry, p, slant), p, kShadowEdge * p.unit, dark);
  if (seen.anywhere) figure.mark_all();
  if (shadow.anywhere) dark.mark_all();
  near.mark_around(figure, kOcclusionReach * p.unit * p.focal / seen.nearest);
  near.add(dark);
  Tiles only_near = near;
  only_near.take_away(dark);
  return {figure.areas(1), dark.areas(1), near.areas(1), only_near.areas(1), near.areas(0)};
}

}  // namespace sinew::render
