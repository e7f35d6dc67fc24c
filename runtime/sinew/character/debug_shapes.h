// Outlines of what debug_draw.h shows. Internal to the character layer.
#pragma once

#include <span>

#include "sinew/character/debug_draw.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew {

/// Wires on the surface of a collider's shape where that stands.
void draw_shape(const Collider& shape, const Transform<double>& pose, DebugColor color,
                DebugRenderer& renderer);
/// Three lines across each other, each twice `size` (m) long.
void draw_cross(const Vec3<double>& at, double size, DebugColor color, DebugRenderer& renderer);
/// Six corners about a place, as triangles.
void draw_mark(const Vec3<double>& at, double size, DebugColor color, DebugRenderer& renderer);
/// The convex hull of points of one height, filled and with its outline. Orders the points.
void draw_hull(std::span<Vec3<double>> points, DebugColor color, DebugRenderer& renderer);

}  // namespace sinew
