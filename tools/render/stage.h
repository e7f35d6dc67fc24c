// Draws one frame of geometry: sky, ground grid, soft shadow, ambient occlusion, lit figure; multisampled
// where the figure is, tone-mapped, read back.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "render/context.h"
#include "render/geometry.h"
#include "render/image.h"
#include "render/region.h"

namespace sinew::render {

struct View {
  Vec3<float> eye, target;
  float vertical_fov = 0.56f;  ///< rad
  float unit = 1;   ///< the figure's size in adults of 1.75 m: scales shadow, occlusion, grid and fog
  float shift = 0;  ///< of the target to the right of the picture's middle, in half widths
};

/// What a picture holds.
enum class Pass {
  kPicture,
  kDepth,  ///< of figures and things: distance along the view, mm; Channels::kNumber; 65535 where none is
  kNormal,  ///< unit vector in the world's axes, −1 … 1 as 0 … 255 in red, green, blue; alpha 0 where none is
  kId,  ///< Vertex::color as it is, of the vertices that glow; alpha 0 where none is
};

struct StageOptions {
  int width = 1280, height = 720;
  int samples = 4;  ///< multisampling, 1 or 4
  bool dark = true;
  bool fine = true;                            ///< ambient occlusion, softer shadows
  std::optional<Vec3<float>> background = {};  ///< sRGB 0 … 1, one colour; else the theme's sky
  bool transparent = false;                    ///< neither sky nor floor: Channels::kColorAlpha
  Pass pass = Pass::kPicture;
};

class Stage {
 public:
  static std::unique_ptr<Stage> create(const StageOptions& options, std::string& error);
  /// Renders into `out` (sized here). `ground` is the floor's height.
  void draw(const Geometry& geometry, const View& view, float ground, Image& out);

 private:
  struct Matrices;

  Stage() = default;
  bool set_up(std::string& error);
  bool set_up_shadow();
  bool set_up_occlusion();
  bool set_up_picture();
  bool set_up_figure();
  void set_up_vertices();
  GLuint program(const char* vertex, const char* fragment, const std::string& defines, std::string& error);
  /// A texture to draw into; bound afterwards.
  GLuint map(GLint format, GLenum channels, int width, int height, GLint filter);
  GLuint texture(const Material* material);
  void use(GLuint program, const Matrices& m, const View& view, float ground);
  void draw_triangles(const Draw& d);
  void draw_strip();
  void draw_strip(const std::vector<Area>& areas);
  void draw_shadow(const Geometry& geometry, const Matrices& m);
  void draw_surface(const Geometry& geometry, const Matrices& m, const View& view, float ground,
                    const Regions& regions);
  void draw_occlusion(const Matrices& m, const View& view, float ground, const std::vector<Area>& areas);
  /// What draw_surface() left of the pass, one sample of each pixel.
  void draw_data(const Matrices& m, const View& view, float ground, const std::vector<Area>& areas);
  void draw_background(const Matrices& m, const View& view, float ground, const Regions& regions);
  void light_figure(const Matrices& m, const View& view, float ground, const std::vector<Area>& areas);
  void draw_shells(const Geometry& geometry, const Matrices& m, const View& view, float ground,
                   const std::vector<Area>& areas);
  void clear(const std::vector<Area>& areas, GLbitfield what);
  int sky_bottom(const Matrices& m, const View& view, float ground) const;
  void draw_picture(const Geometry& geometry, const Matrices& m, const View& view, float ground,
                    const Regions& regions);
  void read(Image& out);
  int half_width() const { return (options_.width + 1) / 2; }
  int half_height() const { return (options_.height + 1) / 2; }

  std::unique_ptr<Context> context_;
  StageOptions options_;
  GLuint surface_ = 0, textured_ = 0, figure_ = 0, shell_ = 0, ground_ = 0, near_ground_ = 0, far_ground_ = 0,
         sky_ = 0, resolve_ = 0, depth_ = 0, floor_depth_ = 0, distance_ = 0, obscurance_ = 0, blur_ = 0,
         data_ = 0;
  GLuint shadow_map_ = 0, shadow_target_ = 0, picture_target_ = 0;
  GLuint figure_maps_[3] = {}, figure_target_ = 0, shell_target_ = 0;  ///< surface, normal, depth
  GLuint half_distance_ = 0, half_target_ = 0, open_map_[2] = {}, open_target_[2] = {};
  GLuint array_ = 0, vertex_buffer_ = 0, index_buffer_ = 0, empty_array_ = 0;
  std::map<const Material*, GLuint> textures_;
  std::vector<std::uint8_t> bottom_up_;  ///< the picture as OpenGL hands it over
};

}  // namespace sinew::render
