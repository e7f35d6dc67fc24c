// Convex hulls that come from C.
#pragma once

#include <vector>

#include "sinew/c/call.h"
#include "sinew/c/owned.h"

namespace sinew::c {

/// The hull of `count` points, three numbers each, which the world keeps.
inline sinew_status add_hull(OwnedWorld& world, const double* points, int32_t count, const ConvexHull*& out) {
  constexpr int32_t kMostPoints = 1 << 20;
  if (!points) return fail(SINEW_INVALID_ARGUMENT, kNull);
  if (count < 0 || count > kMostPoints) return fail(SINEW_INVALID_ARGUMENT, "count must be 4 to 1048576");
  std::vector<Vec3<double>> read;
  read.reserve(static_cast<std::size_t>(count));
  for (int32_t n = 0; n < count; ++n) read.emplace_back(points[3 * n], points[3 * n + 1], points[3 * n + 2]);
  auto hull = std::make_unique<ConvexHull>();
  if (const Status status = ConvexHull::make(read, *hull); !status) return answer(status);
  world.hulls.push_back(std::move(hull));
  out = world.hulls.back().get();
  return SINEW_OK;
}

}  // namespace sinew::c
