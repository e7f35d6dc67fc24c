// Draws one frame of geometry: sky, ground grid, soft shadow, lit figure; 4x multisampled, tone-mapped, read
// back.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "render/context.h"
#include "render/geometry.h"
#include "render/image.h"

namespace sinew::render {

struct View {
  Vec3<float> eye, target;
  float vertical_fov = 0.56f;  ///< rad
  float light_radius = 4;      ///< m around `target` that the shadow map covers
};

class Stage {
 public:
  static std::unique_ptr<Stage> create(int width, int height, int samples, bool dark, std::string& error);
  /// Renders into `out` (sized here). `ground` is the floor's height.
  void draw(const Geometry& geometry, const View& view, float ground, Image& out);

 private:
  Stage() = default;
  bool set_up(std::string& error);
  GLuint program(const char* vertex, const char* fragment, std::string& error);
  GLuint texture(const Material* material);

  std::unique_ptr<Context> context_;
  int width_ = 0, height_ = 0, samples_ = 4;
  bool dark_ = true;
  GLuint figure_ = 0, ground_ = 0, sky_ = 0, shadow_ = 0;
  GLuint shadow_map_ = 0, shadow_target_ = 0, multi_target_ = 0, single_target_ = 0;
  GLuint array_ = 0, vertex_buffer_ = 0, index_buffer_ = 0, empty_array_ = 0, white_ = 0;
  std::map<const Material*, GLuint> textures_;
};

}  // namespace sinew::render
