// Which parts of the picture a frame's figures can change: everything else needs neither shadow nor
// occlusion.
#pragma once

#include "render/geometry.h"

namespace sinew::render {

/// Pixels from (left, bottom) up to but without (right, top); rows count from the bottom, as OpenGL does.
struct Area {
  int left = 0, bottom = 0, right = 0, top = 0;
  int width() const { return right - left; }
  int height() const { return top - bottom; }
  bool empty() const { return left >= right || bottom >= top; }
};

/// Lists of areas made of whole tiles; within a list none overlap.
struct Regions {
  std::vector<Area> figure;     ///< cover every triangle
  std::vector<Area> shadow;     ///< cover its shadow on the floor, and may cover more
  std::vector<Area> near;       ///< cover the figure, its shadow and what it occludes
  std::vector<Area> only_near;  ///< `near` without `shadow`
  std::vector<Area> rest;       ///< the picture without `near`
};

/// What `find_regions` has to know about a picture.
struct Projection {
  Eigen::Matrix4f view_projection;
  Vec3<float> light_direction;  ///< towards the light, above the horizon
  float ground = 0;             ///< m, height of the floor
  float unit = 1;               ///< the figure's size in adults
  float focal = 1;              ///< pixels that 1 m takes at a distance of 1 m
  int width = 0, height = 0;    ///< pixels
};

/// What is behind the camera is in no list; a triangle that reaches there from before it makes `figure` and
/// `near`, its shadow `shadow`, the whole picture. Cost: one pass over the triangles.
Regions find_regions(const Geometry& geometry, const Projection& projection);

}  // namespace sinew::render
