#include "render/stage.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "render/shaders.h"

namespace sinew::render {
namespace {

constexpr int kShadowSize = 2048;
constexpr float kNoFigure = 9;        ///< no component of a folded normal is that large
constexpr float kShadowReach = 3.2f;  ///< times `unit`: m around the target that the shadow map covers

using Mat4 = Eigen::Matrix4f;

/// Light and colours: linear, except fog and zenith, which are as shown.
struct Theme {
  Vec3<float> key, sky, ground, line, rim, fog, zenith;
  float pool;  ///< how much the floor darkens away from the figure
};
const Theme kDark{
    {1.95f, 1.74f, 1.48f}, {0.24f, 0.30f, 0.40f},   {0.070f, 0.078f, 0.092f}, {0.30f, 0.35f, 0.42f},
    {0.34f, 0.46f, 0.62f}, {0.165f, 0.185f, 0.22f}, {0.055f, 0.062f, 0.080f}, 0.75f};
const Theme kLight{
    {1.75f, 1.64f, 1.50f}, {0.42f, 0.47f, 0.54f},  {0.36f, 0.37f, 0.39f}, {0.16f, 0.18f, 0.21f},
    {0.16f, 0.19f, 0.24f}, {0.86f, 0.875f, 0.90f}, {0.70f, 0.77f, 0.86f}, 0.12f};

Mat4 look_at(const Vec3<float>& eye, const Vec3<float>& target) {
  const Vec3<float> back = (eye - target).normalized();
  Vec3<float> side = Vec3<float>::UnitZ().cross(back);
  side = side.norm() > 1e-4f ? Vec3<float>(side.normalized()) : Vec3<float>(Vec3<float>::UnitX());
  const Vec3<float> up = back.cross(side);
  Mat4 m = Mat4::Identity();
  m.row(0) << side.transpose(), -side.dot(eye);
  m.row(1) << up.transpose(), -up.dot(eye);
  m.row(2) << back.transpose(), -back.dot(eye);
  return m;
}

Mat4 perspective(float fov, float aspect, float shift, float near, float far) {
  const float f = 1 / std::tan(fov / 2);
  Mat4 m = Mat4::Zero();
  m(0, 0) = f / aspect;
  m(0, 2) = -shift;
  m(1, 1) = f;
  m(2, 2) = (far + near) / (near - far);
  m(2, 3) = 2 * far * near / (near - far);
  m(3, 2) = -1;
  return m;
}

/// OpenGL takes places in a buffer, in bytes, as pointers.
const void* in_buffer(std::size_t offset) {
  return reinterpret_cast<const void*>(offset);  // NOLINT(performance-no-int-to-ptr)
}

}  // namespace

/// What a frame's passes share.
struct Stage::Matrices {
  Mat4 view_projection, light;
  Vec3<float> light_direction;
  float near, far;

  Matrices(const View& view, float aspect) {
    const float distance = (view.eye - view.target).norm();
    near = 0.04f * distance;
    far = 30 * distance + 60 * view.unit;
    view_projection =
        perspective(view.vertical_fov, aspect, view.shift, near, far) * look_at(view.eye, view.target);
    // The key light stands high to the left of the camera, as in a studio: also around a turntable.
    Vec3<float> toward = view.eye - view.target;
    toward.z() = 0;
    toward = toward.norm() > 1e-4f * distance ? Vec3<float>(toward.normalized()) : Vec3<float>::UnitX();
    const Vec3<float> left = toward.cross(Vec3<float>::UnitZ());
    light_direction = (0.45f * toward + 0.70f * left + 0.95f * Vec3<float>::UnitZ()).normalized();
    const float reach = kShadowReach * view.unit;
    Mat4 projection = Mat4::Identity();
    projection(0, 0) = projection(1, 1) = 1 / reach;
    projection(2, 2) = -1 / (5 * reach);
    projection(2, 3) = -1;
    light = projection * look_at(view.target + light_direction * (5 * reach), view.target);
  }
};

std::unique_ptr<Stage> Stage::create(const StageOptions& options, std::string& error) {
  std::unique_ptr<Stage> stage(new Stage);
  stage->context_ = Context::create(error);
  if (!stage->context_) return nullptr;
  stage->options_ = options;
  return stage->set_up(error) ? std::move(stage) : nullptr;
}

GLuint Stage::program(const char* vertex, const char* fragment, const std::string& defines,
                      std::string& error) {
  const Gl& gl = context_->gl();
  const GLuint made = gl.CreateProgram();
  const std::string head = "#version 330 core\n#define SHADOW_TAPS " +
                           std::string(options_.fine ? "16" : "6") + "\n#define SAMPLES " +
                           std::to_string(options_.samples) + "\n#define COLOR_KIND " +
                           (options_.pass == Pass::kId ? "flat" : "centroid") + "\n" + defines;
  for (const auto& [kind, source] :
       {std::pair<GLenum, const char*>{GL_VERTEX_SHADER, vertex}, {GL_FRAGMENT_SHADER, fragment}}) {
    const GLuint shader = gl.CreateShader(kind);
    const char* parts[] = {head.c_str(), kUniforms, kind == GL_FRAGMENT_SHADER ? kShading : "", source};
    gl.ShaderSource(shader, 4, parts, nullptr);
    gl.CompileShader(shader);
    GLint ok = 0;
    gl.GetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (!ok) {
      char log[512] = {};
      gl.GetShaderInfoLog(shader, sizeof log, nullptr, log);
      error = "shader: " + std::string(log, std::strcspn(log, "\n"));
      return 0;
    }
    gl.AttachShader(made, shader);
    gl.DeleteShader(shader);
  }
  gl.LinkProgram(made);
  GLint ok = 0;
  gl.GetProgramiv(made, GL_LINK_STATUS, &ok);
  if (!ok) {
    error = "shaders do not link";
    return 0;
  }
  gl.UseProgram(made);
  gl.Uniform1i(gl.GetUniformLocation(made, "shadow_map"), 0);
  gl.Uniform1i(gl.GetUniformLocation(made, "albedo_map"), 1);
  gl.Uniform1i(gl.GetUniformLocation(made, "occlusion_map"), 2);
  gl.Uniform1i(gl.GetUniformLocation(made, "depth_map"), 2);
  gl.Uniform1i(gl.GetUniformLocation(made, "surface_map"), 3);
  gl.Uniform1i(gl.GetUniformLocation(made, "normal_map"), 4);
  gl.Uniform1i(gl.GetUniformLocation(made, "distance_map"), 5);
  return made;
}

bool Stage::set_up(std::string& error) {
  const std::string open = options_.fine ? "#define OCCLUSION\n" : "";
  surface_ = program(kFigureVertex, kSurfaceFragment, "", error);
  textured_ = program(kFigureVertex, kSurfaceFragment, "#define TEXTURED\n", error);
  figure_ = program(kScreenVertex, kFigureFragment, open, error);
  shell_ = program(kFigureVertex, kShellFragment, "", error);
  ground_ = program(kGroundVertex, kGroundFragment, open, error);
  sky_ = program(kSkyVertex, kSkyFragment, "", error);
  near_ground_ = program(kGroundVertex, kGroundFragment, open + "#define UNSHADOWED\n", error);
  far_ground_ = program(kGroundVertex, kGroundFragment, "#define UNSHADOWED\n", error);
  resolve_ = program(kScreenVertex, kResolveFragment, "", error);
  depth_ = program(kDepthVertex, kDepthFragment, "", error);
  floor_depth_ = program(kGroundVertex, kDepthFragment, "", error);
  if (!surface_ || !textured_ || !figure_ || !shell_ || !ground_ || !near_ground_ || !far_ground_ || !sky_ ||
      !resolve_ || !depth_ || !floor_depth_)
    return false;
  if (options_.fine) {
    distance_ = program(kScreenVertex, kDistanceFragment, "", error);
    obscurance_ = program(kScreenVertex, kObscuranceFragment, "", error);
    blur_ = program(kScreenVertex, kBlurFragment, "", error);
    if (!distance_ || !obscurance_ || !blur_) return false;
  }
  if (options_.pass != Pass::kPicture) {
    const char* defines = options_.pass == Pass::kDepth    ? "#define DEPTH\n"
                          : options_.pass == Pass::kNormal ? "#define NORMAL\n"
                                                           : "";
    data_ = program(kScreenVertex, kDataFragment, defines, error);
    if (!data_) return false;
  }
  set_up_vertices();
  if (!set_up_shadow() || (options_.fine && !set_up_occlusion()) || !set_up_picture() || !set_up_figure()) {
    error = "no framebuffer of that size";
    return false;
  }
  return true;
}

GLuint Stage::map(GLint format, GLenum channels, int width, int height, GLint filter) {
  const Gl& gl = context_->gl();
  GLuint made = 0;
  gl.GenTextures(1, &made);
  gl.BindTexture(GL_TEXTURE_2D, made);
  gl.TexImage2D(GL_TEXTURE_2D, 0, format, width, height, 0, channels, GL_FLOAT, nullptr);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  return made;
}

bool Stage::set_up_shadow() {
  const Gl& gl = context_->gl();
  shadow_map_ = map(GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, kShadowSize, kShadowSize, GL_LINEAR);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  const float lit[4] = {1, 1, 1, 1};
  gl.TexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, lit);
  gl.GenFramebuffers(1, &shadow_target_);
  gl.BindFramebuffer(GL_FRAMEBUFFER, shadow_target_);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, shadow_map_, 0);
  gl.DrawBuffer(GL_NONE);
  gl.ReadBuffer(GL_NONE);
  return gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

bool Stage::set_up_occlusion() {
  const Gl& gl = context_->gl();
  bool complete = true;
  const auto target = [&](GLuint& texture, GLuint& framebuffer, GLint format, GLenum channels) {
    texture = map(format, channels, half_width(), half_height(), GL_NEAREST);
    gl.GenFramebuffers(1, &framebuffer);
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    complete &= gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  };
  target(half_distance_, half_target_, GL_R32F, GL_RED);
  for (int k = 0; k < 2; ++k) target(open_map_[k], open_target_[k], GL_RG16F, GL_RG);
  return complete;
}

bool Stage::set_up_picture() {
  const Gl& gl = context_->gl();
  GLuint color = 0;
  gl.GenFramebuffers(1, &picture_target_);
  gl.BindFramebuffer(GL_FRAMEBUFFER, picture_target_);
  gl.GenRenderbuffers(1, &color);
  gl.BindRenderbuffer(GL_RENDERBUFFER, color);
  gl.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, options_.width, options_.height);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color);
  return gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

/// Multisampled textures of what the figure is, and a target that fills all of them; another for the skin
/// around muscles, which takes over the first one's colours when they have been lit.
bool Stage::set_up_figure() {
  const Gl& gl = context_->gl();
  const GLenum formats[] = {GL_RGBA8, GL_RG16F, GL_DEPTH_COMPONENT24},
               places[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_DEPTH_ATTACHMENT};
  gl.GenTextures(3, figure_maps_);
  gl.GenFramebuffers(1, &figure_target_);
  gl.GenFramebuffers(1, &shell_target_);
  for (int k = 0; k < 3; ++k) {
    gl.ActiveTexture(static_cast<GLenum>(GL_TEXTURE3 + k));
    gl.BindTexture(GL_TEXTURE_2D_MULTISAMPLE, figure_maps_[k]);
    gl.TexImage2DMultisample(GL_TEXTURE_2D_MULTISAMPLE, options_.samples, formats[k], options_.width,
                             options_.height, GL_TRUE);
    for (const GLuint target : {figure_target_, shell_target_}) {
      if (k == 1 && target == shell_target_) continue;
      gl.BindFramebuffer(GL_FRAMEBUFFER, target);
      gl.FramebufferTexture2D(GL_FRAMEBUFFER, places[k], GL_TEXTURE_2D_MULTISAMPLE, figure_maps_[k], 0);
    }
  }
  bool complete = gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  gl.BindFramebuffer(GL_FRAMEBUFFER, figure_target_);
  gl.DrawBuffers(2, places);
  complete &= gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  return complete;
}

void Stage::set_up_vertices() {
  const Gl& gl = context_->gl();
  gl.GenVertexArrays(1, &empty_array_);
  gl.GenVertexArrays(1, &array_);
  gl.BindVertexArray(array_);
  gl.GenBuffers(1, &vertex_buffer_);
  gl.GenBuffers(1, &index_buffer_);
  gl.BindBuffer(GL_ARRAY_BUFFER, vertex_buffer_);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, index_buffer_);
  const auto attribute = [&](GLuint index, GLint size, std::size_t offset) {
    gl.EnableVertexAttribArray(index);
    gl.VertexAttribPointer(index, size, GL_FLOAT, GL_FALSE, sizeof(Vertex), in_buffer(offset));
  };
  attribute(0, 3, offsetof(Vertex, position));
  attribute(1, 3, offsetof(Vertex, normal));
  attribute(2, 2, offsetof(Vertex, uv));
  attribute(3, 4, offsetof(Vertex, color));
}

/// The material's texture; 0: it has none, or one that cannot be read.
GLuint Stage::texture(const Material* material) {
  if (!material || material->texture.empty()) return 0;
  const auto found = textures_.find(material);
  if (found != textures_.end()) return found->second;
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
  GLuint made = 0;
  if (decode_image(material->texture, width, height, rgba)) {
    const Gl& gl = context_->gl();
    gl.GenTextures(1, &made);
    gl.BindTexture(GL_TEXTURE_2D, made);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
    gl.GenerateMipmap(GL_TEXTURE_2D);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  }
  textures_[material] = made;
  return made;
}

void Stage::use(GLuint program, const Matrices& m, const View& view, float ground) {
  const Gl& gl = context_->gl();
  const Theme& theme = options_.dark ? kDark : kLight;
  gl.UseProgram(program);
  const auto place = [&](const char* name) { return gl.GetUniformLocation(program, name); };
  const auto vec = [&](const char* name, const Vec3<float>& v) {
    gl.Uniform3f(place(name), v.x(), v.y(), v.z());
  };
  gl.UniformMatrix4fv(place("view_projection"), 1, GL_FALSE, m.view_projection.data());
  const Mat4 from_clip = m.view_projection.inverse();
  gl.UniformMatrix4fv(place("from_clip"), 1, GL_FALSE, from_clip.data());
  gl.UniformMatrix4fv(place("light_matrix"), 1, GL_FALSE, m.light.data());
  vec("eye", view.eye);
  vec("target", view.target);
  vec("light_direction", m.light_direction);
  vec("key_color", theme.key);
  vec("sky_color", theme.sky);
  vec("ground_color", theme.ground);
  vec("line_color", theme.line);
  vec("rim_color", theme.rim);
  vec("fog_color", options_.background.value_or(theme.fog));
  vec("zenith", options_.background.value_or(theme.zenith));
  gl.Uniform1f(place("vignetting"), options_.background ? 0.f : 0.55f);
  gl.Uniform1f(place("pool"), theme.pool);
  gl.Uniform1f(place("shift"), view.shift);
  gl.Uniform1f(place("unit"), view.unit);
  gl.Uniform1f(place("ground"), ground);
  // Grid cells of half a metre around an adult, by tens for other sizes.
  gl.Uniform1f(place("cell"), 0.5f * std::pow(10.f, std::round(std::log10(view.unit))));
  gl.Uniform2f(place("viewport"), float(options_.width), float(options_.height));
  const float up = std::tan(view.vertical_fov / 2);
  gl.Uniform2f(place("slope"), up * float(options_.width) / float(options_.height), up);
  gl.Uniform2f(place("near_far"), m.near, m.far);
  const float pitch = std::asin((view.target - view.eye).normalized().z());
  gl.Uniform2f(place("view_up"), std::sin(pitch - view.vertical_fov / 2),
               std::sin(pitch + view.vertical_fov / 2));
}

/// The quad of the vertex shaders that make their own vertices.
void Stage::draw_strip() {
  const Gl& gl = context_->gl();
  gl.BindVertexArray(empty_array_);
  gl.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

/// Only what of it lies in the areas.
void Stage::draw_strip(const std::vector<Area>& areas) {
  const Gl& gl = context_->gl();
  gl.Enable(GL_SCISSOR_TEST);
  for (const Area& area : areas) {
    gl.Scissor(area.left, area.bottom, area.width(), area.height());
    draw_strip();
  }
  gl.Disable(GL_SCISSOR_TEST);
}

void Stage::clear(const std::vector<Area>& areas, GLbitfield what) {
  const Gl& gl = context_->gl();
  gl.Enable(GL_SCISSOR_TEST);
  for (const Area& area : areas) {
    gl.Scissor(area.left, area.bottom, area.width(), area.height());
    gl.Clear(what);
  }
  gl.Disable(GL_SCISSOR_TEST);
}

void Stage::draw_shadow(const Geometry& geometry, const Matrices& m) {
  const Gl& gl = context_->gl();
  gl.BindFramebuffer(GL_FRAMEBUFFER, shadow_target_);
  gl.Viewport(0, 0, kShadowSize, kShadowSize);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  gl.BindVertexArray(array_);
  gl.UseProgram(depth_);
  gl.UniformMatrix4fv(gl.GetUniformLocation(depth_, "to_clip"), 1, GL_FALSE, m.light.data());
  for (const Draw& d : geometry.draws)
    if (!d.skin_shell) draw_triangles(d);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, shadow_map_);
}

/// What the figure is at every sample, and the floor's depth there.
void Stage::draw_surface(const Geometry& geometry, const Matrices& m, const View& view, float ground,
                         const Regions& regions) {
  const Gl& gl = context_->gl();
  gl.BindFramebuffer(GL_FRAMEBUFFER, figure_target_);
  gl.Viewport(0, 0, options_.width, options_.height);
  gl.ClearColor(kNoFigure, kNoFigure, kNoFigure, kNoFigure);
  clear(regions.figure, GL_COLOR_BUFFER_BIT);
  gl.Clear(GL_DEPTH_BUFFER_BIT);  // of everything: draw_occlusion() reads it around the figure, too
  gl.ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  use(floor_depth_, m, view, ground);
  draw_strip(regions.figure);
  gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl.BindVertexArray(array_);
  gl.ActiveTexture(GL_TEXTURE1);
  for (const Draw& d : geometry.draws) {
    if (d.skin_shell) continue;
    const GLuint albedo = texture(d.material);
    gl.BindTexture(GL_TEXTURE_2D, albedo);
    use(albedo == 0 ? surface_ : textured_, m, view, ground);
    draw_triangles(d);
  }
}

/// Openness within areas of the picture; around them nothing occludes.
void Stage::draw_occlusion(const Matrices& m, const View& view, float ground,
                           const std::vector<Area>& areas) {
  const Gl& gl = context_->gl();
  std::vector<Area> halves;
  for (const Area& a : areas)
    halves.push_back({a.left / 2, a.bottom / 2, (a.right + 1) / 2, (a.top + 1) / 2});
  const GLuint targets[] = {half_target_, open_target_[0], open_target_[1]},
               programs[] = {distance_, obscurance_, blur_},
               results[] = {half_distance_, open_map_[0], open_map_[1]};
  gl.Viewport(0, 0, half_width(), half_height());
  gl.ActiveTexture(GL_TEXTURE2);
  for (int pass = 0; pass < 3; ++pass) {
    gl.BindFramebuffer(GL_FRAMEBUFFER, targets[pass]);
    gl.ClearColor(pass == 0 ? m.far : 1, m.far, 0, 0);
    gl.Clear(GL_COLOR_BUFFER_BIT);
    use(programs[pass], m, view, ground);
    draw_strip(halves);
    gl.BindTexture(GL_TEXTURE_2D, results[pass]);
  }
}

/// The lowest row of pixels that the floor may leave to the sky.
int Stage::sky_bottom(const Matrices& m, const View& view, float ground) const {
  const Vec3<float> ahead(view.target.x() - view.eye.x(), view.target.y() - view.eye.y(), 0);
  if (view.eye.z() <= ground || ahead.norm() < 1e-3f * view.unit) return 0;
  // The floor reaches 120 units in every direction; half of it is enough for what stands aside of `ahead`.
  Vec3<float> edge = view.eye + ahead.normalized() * (60 * view.unit);
  edge.z() = ground;
  const Eigen::Vector4f clip = m.view_projection * edge.homogeneous();
  if (clip.w() <= 0) return 0;
  const float row = (clip.y() / clip.w() + 1) * 0.5f * float(options_.height);
  return static_cast<int>(std::clamp(row - 2, 0.f, float(options_.height)));
}

/// Sky and floor, whose grid is antialiased by its shader: one sample is enough. Only the floor near a figure
/// is asked for shadow and occlusion.
void Stage::draw_background(const Matrices& m, const View& view, float ground, const Regions& regions) {
  const Gl& gl = context_->gl();
  gl.BindFramebuffer(GL_FRAMEBUFFER, picture_target_);
  gl.Viewport(0, 0, options_.width, options_.height);
  use(sky_, m, view, ground);
  draw_strip({{0, sky_bottom(m, view, ground), options_.width, options_.height}});
  use(far_ground_, m, view, ground);
  draw_strip(regions.rest);
  use(near_ground_, m, view, ground);
  draw_strip(regions.only_near);
  use(ground_, m, view, ground);
  draw_strip(regions.shadow);
}

void Stage::draw_data(const Matrices& m, const View& view, float ground, const std::vector<Area>& areas) {
  const Gl& gl = context_->gl();
  gl.BindFramebuffer(GL_FRAMEBUFFER, picture_target_);
  gl.Viewport(0, 0, options_.width, options_.height);
  const float none = options_.pass == Pass::kDepth ? 1.f : 0.f;
  gl.ClearColor(none, none, none, none);
  gl.Clear(GL_COLOR_BUFFER_BIT);
  use(data_, m, view, ground);
  draw_strip(areas);
}

void Stage::draw_triangles(const Draw& d) {
  const Gl& gl = context_->gl();
  if (d.closed) gl.Enable(GL_CULL_FACE);
  gl.DrawElements(GL_TRIANGLES, d.count, GL_UNSIGNED_INT,
                  in_buffer(std::size_t(d.first) * sizeof(std::uint32_t)));
  if (d.closed) gl.Disable(GL_CULL_FACE);
}

void Stage::light_figure(const Matrices& m, const View& view, float ground, const std::vector<Area>& areas) {
  const Gl& gl = context_->gl();
  gl.Enable(GL_BLEND);
  gl.BlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  use(figure_, m, view, ground);
  draw_strip(areas);
  gl.Disable(GL_BLEND);
}

/// One skin after the other: its nearest part, over what is there.
void Stage::draw_shells(const Geometry& geometry, const Matrices& m, const View& view, float ground,
                        const std::vector<Area>& areas) {
  const Gl& gl = context_->gl();
  gl.ClearColor(0, 0, 0, 0);
  gl.BlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  for (const Draw& d : geometry.draws) {
    if (!d.skin_shell) continue;
    gl.BindFramebuffer(GL_FRAMEBUFFER, shell_target_);
    clear(areas, GL_COLOR_BUFFER_BIT);
    gl.Enable(GL_DEPTH_TEST);
    gl.BindVertexArray(array_);
    use(shell_, m, view, ground);
    draw_triangles(d);
    gl.Disable(GL_DEPTH_TEST);
    gl.BindFramebuffer(GL_FRAMEBUFFER, picture_target_);
    gl.UseProgram(resolve_);
    gl.Enable(GL_BLEND);
    draw_strip(areas);
    gl.Disable(GL_BLEND);
  }
}

void Stage::read(Image& out) {
  const Gl& gl = context_->gl();
  const int width = options_.width, height = options_.height;
  const std::size_t row = std::size_t(width) * 4;
  bottom_up_.resize(row * std::size_t(height));
  gl.BindFramebuffer(GL_FRAMEBUFFER, picture_target_);
  gl.ReadPixels(0, 0, width, height, GL_BGRA, GL_UNSIGNED_BYTE, bottom_up_.data());
  out.width = width;
  out.height = height;
  out.channels = options_.pass == Pass::kDepth                             ? Channels::kNumber
                 : options_.transparent || options_.pass != Pass::kPicture ? Channels::kColorAlpha
                                                                           : Channels::kColor;
  out.pixels.resize(bottom_up_.size());
  for (std::size_t y = 0; y < std::size_t(height); ++y)
    std::memcpy(&out.pixels[y * row], &bottom_up_[(std::size_t(height) - 1 - y) * row], row);
}

void Stage::draw_picture(const Geometry& geometry, const Matrices& m, const View& view, float ground,
                         const Regions& regions) {
  const Gl& gl = context_->gl();
  const auto has = [&](bool shell) {
    return std::any_of(geometry.draws.begin(), geometry.draws.end(),
                       [&](const Draw& d) { return d.skin_shell == shell; });
  };
  if (options_.fine) draw_occlusion(m, view, ground, regions.near);
  if (options_.transparent) {
    gl.BindFramebuffer(GL_FRAMEBUFFER, picture_target_);
    gl.Viewport(0, 0, options_.width, options_.height);
    gl.ClearColor(0, 0, 0, 0);
    gl.Clear(GL_COLOR_BUFFER_BIT);
  } else {
    draw_background(m, view, ground, regions);
  }
  if (has(false)) light_figure(m, view, ground, regions.figure);
  if (has(true)) draw_shells(geometry, m, view, ground, regions.figure);
}

void Stage::draw(const Geometry& geometry, const View& view, float ground, Image& out) {
  const Gl& gl = context_->gl();
  const Matrices m(view, float(options_.width) / float(options_.height));
  const Regions regions =
      find_regions(geometry, {m.view_projection, m.light_direction, ground, view.unit,
                              0.5f * float(options_.height) / std::tan(view.vertical_fov / 2), options_.width,
                              options_.height});
  gl.BindVertexArray(array_);
  gl.BindBuffer(GL_ARRAY_BUFFER, vertex_buffer_);
  gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(geometry.vertices.size() * sizeof(Vertex)),
                geometry.vertices.data(), GL_STREAM_DRAW);
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER,
                static_cast<GLsizeiptr>(geometry.indices.size() * sizeof(std::uint32_t)),
                geometry.indices.data(), GL_STREAM_DRAW);
  gl.Enable(GL_DEPTH_TEST);
  if (options_.pass == Pass::kPicture) draw_shadow(geometry, m);
  draw_surface(geometry, m, view, ground, regions);
  gl.Disable(GL_DEPTH_TEST);
  if (options_.pass == Pass::kPicture)
    draw_picture(geometry, m, view, ground, regions);
  else
    draw_data(m, view, ground, regions.figure);
  read(out);
}

}  // namespace sinew::render
