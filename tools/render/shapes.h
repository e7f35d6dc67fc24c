// Tessellated solids, appended to a frame's triangles.
#pragma once

#include "render/geometry.h"
#include "sinew/skeleton/convex_hull.h"

namespace sinew::render {

inline const Vec3<float> kBone(0.62f, 0.59f, 0.53f);
inline const Vec3<float> kClay(0.50f, 0.47f, 0.44f);

/// Capsule along local z: `half` is half the distance of its cap centres (0: a sphere), m.
void append_capsule(const Transform<float>& world, float radius, float half, const Vec3<float>& color,
                    float glow, Geometry& out);
void append_box(const Transform<float>& world, const Vec3<float>& half, const Vec3<float>& color,
                Geometry& out);
void append_hull(const Transform<float>& world, const ConvexHull& hull, const Vec3<float>& color,
                 Geometry& out);
/// Muscle from a to b in world space: a full belly, pale tendons at the ends. Coloured by load.
void append_spindle(const Vec3<float>& a, const Vec3<float>& b, float radius, float load, Geometry& out);

/// Frame whose z runs from a to b, in their middle.
Transform<float> between(const Vec3<float>& a, const Vec3<float>& b);

}  // namespace sinew::render
