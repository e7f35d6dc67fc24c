#include "render/region.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew::render {
namespace {

/// Reach of the ambient occlusion (shaders.h: 0.26) with what perspective adds at the picture's edge, in
/// units.
constexpr float kOcclusionReach = 0.3f;
/// Half width of a shadow's soft edge on the floor with the map's texels, in units.
constexpr float kShadowEdge = 0.08f;
/// Of antialiasing, pixels.
constexpr float kEdge = 2;

/// The smallest box around what was added.
class Cover {
 public:
  explicit Cover(const Projection& p) : p_(p) {}

  /// A ball in the world.
  void add(const Vec3<float>& middle, float radius) {
    const Eigen::Vector4f clip = p_.view_projection * middle.homogeneous();
    behind_ |= clip.w() <= 1e-3f * p_.unit;
    const float x = (clip.x() / clip.w() + 1) * 0.5f * float(p_.width),
                y = (clip.y() / clip.w() + 1) * 0.5f * float(p_.height),
                margin = radius * p_.focal / clip.w() + kEdge;
    left_ = std::min(left_, x - margin);
    right_ = std::max(right_, x + margin);
    bottom_ = std::min(bottom_, y - margin);
    top_ = std::max(top_, y + margin);
  }

  Box box() const {
    if (behind_) return {0, 0, p_.width, p_.height};
    const auto pixel = [](float at, int last) {
      return static_cast<int>(std::clamp(at, 0.f, static_cast<float>(last)));
    };
    return {pixel(left_, p_.width), pixel(bottom_, p_.height), pixel(std::ceil(right_), p_.width),
            pixel(std::ceil(top_), p_.height)};
  }

 private:
  const Projection& p_;
  float left_ = std::numeric_limits<float>::max(), right_ = std::numeric_limits<float>::lowest();
  float bottom_ = left_, top_ = right_;
  bool behind_ = false;
};

}  // namespace

Regions find_regions(const Geometry& geometry, const Projection& projection) {
  Cover figure(projection), near(projection);
  const Vec3<float> slant = projection.light_direction / projection.light_direction.z();
  for (const Vertex& vertex : geometry.vertices) {
    const Vec3<float> p(vertex.position[0], vertex.position[1], vertex.position[2]);
    figure.add(p, 0);
    near.add(p, kOcclusionReach * projection.unit);
    near.add(p - (p.z() - projection.ground) * slant, kShadowEdge * projection.unit);
  }
  return {figure.box(), near.box()};
}

}  // namespace sinew::render
