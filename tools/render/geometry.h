// Triangles of one frame: skinned meshes, shapes, muscle spindles, coloured by load.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "scene/recording.h"

namespace sinew::render {

struct Vertex {
  float position[3], normal[3], uv[2], color[3];
  float glow = 0;  ///< 0 … 1: how much of `color` is stress, shown brighter and without texture
};

/// A stretch of triangles with one material.
struct Draw {
  int first = 0, count = 0;
  const Material* material = nullptr;  ///< textured when it has one
  bool skin_shell = false;             ///< translucent skin around muscles
  bool closed = false;                 ///< seen from outside only: back faces need not be drawn
};

struct Geometry {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<Draw> draws;
  std::map<const Mesh*, bool> closed;  ///< what is_closed() found; clear() keeps it

  void clear();
  /// Makes one draw of all indices from `first` on; none when there are none.
  void close_draw(std::size_t first, const Draw& like);
};

/// Whether every edge joins exactly two triangles that agree about what is outside, and every part has its
/// outside where triangles wind counter-clockwise: then nothing is lost when back faces are not drawn.
bool is_closed(const Mesh& mesh);

/// Slate → teal → green → amber → red over load 0 … 1, brightness rising with it so that it reads without
/// colour vision. Linear RGB.
Vec3<float> stress_color(float load);

enum class Look { kSkin, kXray, kShapes };

/// Appends a character as it stands in `frame`. Without a mesh: its shapes, or sticks from joint to joint.
void append_character(const Asset& asset, const scene::CharacterFrame& frame, Look look, Geometry& out);
/// Appends a sphere, capsule, box or hull placed in the world.
void append_shape(Shape shape, const Vec3<float>& size, const Transform<float>& world,
                  const Vec3<float>& color, Geometry& out, const ConvexHull* hull = nullptr);

}  // namespace sinew::render
