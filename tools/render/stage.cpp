#include "render/stage.h"

#include <cmath>
#include <cstddef>
#include <cstring>

#include "render/shaders.h"

namespace sinew::render {
namespace {

constexpr int kShadowSize = 2048;

using Mat4 = Eigen::Matrix4f;

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

Mat4 perspective(float fov, float aspect, float near, float far) {
  const float f = 1 / std::tan(fov / 2);
  Mat4 m = Mat4::Zero();
  m(0, 0) = f / aspect;
  m(1, 1) = f;
  m(2, 2) = (far + near) / (near - far);
  m(2, 3) = 2 * far * near / (near - far);
  m(3, 2) = -1;
  return m;
}

}  // namespace

std::unique_ptr<Stage> Stage::create(int width, int height, int samples, bool dark, std::string& error) {
  std::unique_ptr<Stage> stage(new Stage);
  stage->context_ = Context::create(error);
  if (!stage->context_) return nullptr;
  stage->width_ = width;
  stage->height_ = height;
  stage->samples_ = samples;
  stage->dark_ = dark;
  return stage->set_up(error) ? std::move(stage) : nullptr;
}

GLuint Stage::program(const char* vertex, const char* fragment, std::string& error) {
  const Gl& gl = context_->gl();
  const GLuint made = gl.CreateProgram();
  for (const auto& [kind, source] :
       {std::pair<GLenum, const char*>{GL_VERTEX_SHADER, vertex}, {GL_FRAGMENT_SHADER, fragment}}) {
    const GLuint shader = gl.CreateShader(kind);
    const char* parts[] = {kCommon, source};
    gl.ShaderSource(shader, 2, parts, nullptr);
    gl.CompileShader(shader);
    GLint ok = 0;
    gl.GetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (!ok) {
      char log[512] = {};
      gl.GetShaderInfoLog(shader, sizeof log, nullptr, log);
      error = std::string("shader: ") + log;
      return 0;
    }
    gl.AttachShader(made, shader);
    gl.DeleteShader(shader);
  }
  gl.LinkProgram(made);
  GLint ok = 0;
  gl.GetProgramiv(made, GL_LINK_STATUS, &ok);
  if (!ok) error = "shaders do not link";
  return ok ? made : 0;
}

bool Stage::set_up(std::string& error) {
  const Gl& gl = context_->gl();
  figure_ = program(kFigureVertex, kFigureFragment, error);
  ground_ = program(kGroundVertex, kGroundFragment, error);
  sky_ = program(kSkyVertex, kSkyFragment, error);
  shadow_ = program(kShadowVertex, kShadowFragment, error);
  if (!figure_ || !ground_ || !sky_ || !shadow_) return false;

  gl.GenTextures(1, &shadow_map_);
  gl.BindTexture(GL_TEXTURE_2D, shadow_map_);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, kShadowSize, kShadowSize, 0, GL_DEPTH_COMPONENT,
                GL_UNSIGNED_INT, nullptr);
  for (const auto& [name, value] : {std::pair<GLenum, GLint>{GL_TEXTURE_MIN_FILTER, GL_LINEAR},
                                    {GL_TEXTURE_MAG_FILTER, GL_LINEAR},
                                    {GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER},
                                    {GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER},
                                    {GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE},
                                    {GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL}})
    gl.TexParameteri(GL_TEXTURE_2D, name, value);
  const float lit[4] = {1, 1, 1, 1};
  gl.TexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, lit);
  gl.GenFramebuffers(1, &shadow_target_);
  gl.BindFramebuffer(GL_FRAMEBUFFER, shadow_target_);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, shadow_map_, 0);
  gl.DrawBuffer(GL_NONE);
  gl.ReadBuffer(GL_NONE);

  const auto target = [&](GLuint& framebuffer, int samples) {
    GLuint buffers[2];
    gl.GenRenderbuffers(2, buffers);
    gl.GenFramebuffers(1, &framebuffer);
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    for (int k = 0; k < 2; ++k) {
      gl.BindRenderbuffer(GL_RENDERBUFFER, buffers[k]);
      const GLenum format = k == 0 ? GL_RGBA8 : GL_DEPTH_COMPONENT24;
      if (samples > 1)
        gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width_, height_);
      else
        gl.RenderbufferStorage(GL_RENDERBUFFER, format, width_, height_);
      gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, k == 0 ? GL_COLOR_ATTACHMENT0 : GL_DEPTH_ATTACHMENT,
                                 GL_RENDERBUFFER, buffers[k]);
    }
    return gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  };
  if (!target(multi_target_, samples_) || !target(single_target_, 1)) {
    error = "no framebuffer of that size";
    return false;
  }
  gl.GenVertexArrays(1, &empty_array_);
  gl.GenVertexArrays(1, &array_);
  gl.BindVertexArray(array_);
  gl.GenBuffers(1, &vertex_buffer_);
  gl.GenBuffers(1, &index_buffer_);
  gl.BindBuffer(GL_ARRAY_BUFFER, vertex_buffer_);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, index_buffer_);
  const auto attribute = [&](GLuint index, GLint size, std::size_t offset) {
    gl.EnableVertexAttribArray(index);
    gl.VertexAttribPointer(index, size, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                           reinterpret_cast<const void*>(offset));
  };
  attribute(0, 3, offsetof(Vertex, position));
  attribute(1, 3, offsetof(Vertex, normal));
  attribute(2, 2, offsetof(Vertex, uv));
  attribute(3, 4, offsetof(Vertex, color));
  const std::uint8_t white[4] = {255, 255, 255, 255};
  gl.GenTextures(1, &white_);
  gl.BindTexture(GL_TEXTURE_2D, white_);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 1, 1, 0, GL_RGBA, GL_UNSIGNED_BYTE, white);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  return true;
}

GLuint Stage::texture(const Material* material) {
  if (!material || material->texture.empty()) return white_;
  const auto found = textures_.find(material);
  if (found != textures_.end()) return found->second;
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
  GLuint made = white_;
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

void Stage::draw(const Geometry& geometry, const View& view, float ground, Image& out) {
  const Gl& gl = context_->gl();
  gl.BindVertexArray(array_);
  gl.BindBuffer(GL_ARRAY_BUFFER, vertex_buffer_);
  gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(geometry.vertices.size() * sizeof(Vertex)),
                geometry.vertices.data(), GL_STREAM_DRAW);
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(geometry.indices.size() * 4),
                geometry.indices.data(), GL_STREAM_DRAW);

  const Vec3<float> light = Vec3<float>(0.42f, -0.55f, 0.95f).normalized();
  const Mat4 light_view = look_at(view.target + light * 20, view.target);
  Mat4 light_projection = Mat4::Identity();
  light_projection(0, 0) = light_projection(1, 1) = 1 / view.light_radius;
  light_projection(2, 2) = -1 / 20.f;
  light_projection(2, 3) = -1;
  const Mat4 light_matrix = light_projection * light_view;
  const float distance = (view.eye - view.target).norm();
  const Mat4 view_projection =
      perspective(view.vertical_fov, float(width_) / float(height_), 0.02f * distance, 60 * distance + 60) *
      look_at(view.eye, view.target);

  const auto use = [&](GLuint program) {
    gl.UseProgram(program);
    const auto vec = [&](const char* name, float x, float y, float z) {
      gl.Uniform3f(gl.GetUniformLocation(program, name), x, y, z);
    };
    gl.UniformMatrix4fv(gl.GetUniformLocation(program, "view_projection"), 1, GL_FALSE,
                        view_projection.data());
    gl.UniformMatrix4fv(gl.GetUniformLocation(program, "light_matrix"), 1, GL_FALSE, light_matrix.data());
    vec("eye", view.eye.x(), view.eye.y(), view.eye.z());
    vec("light_direction", light.x(), light.y(), light.z());
    vec("key_color", dark_ ? 1.75f : 1.7f, dark_ ? 1.6f : 1.6f, dark_ ? 1.4f : 1.45f);
    if (dark_) {
      vec("sky_color", 0.25f, 0.30f, 0.38f);
      vec("ground_color", 0.085f, 0.092f, 0.105f);
      vec("fog_color", 0.235f, 0.255f, 0.29f);
      vec("zenith", 0.105f, 0.12f, 0.15f);
    } else {
      vec("sky_color", 0.50f, 0.55f, 0.62f);
      vec("ground_color", 0.42f, 0.43f, 0.45f);
      vec("fog_color", 0.86f, 0.875f, 0.90f);
      vec("zenith", 0.66f, 0.74f, 0.85f);
    }
    gl.Uniform1f(gl.GetUniformLocation(program, "ground"), ground);
    gl.Uniform1i(gl.GetUniformLocation(program, "shadow_map"), 0);
    gl.Uniform1i(gl.GetUniformLocation(program, "albedo_map"), 1);
  };

  gl.BindFramebuffer(GL_FRAMEBUFFER, shadow_target_);
  gl.Viewport(0, 0, kShadowSize, kShadowSize);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthMask(GL_TRUE);
  gl.Disable(GL_BLEND);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  use(shadow_);
  for (const Draw& d : geometry.draws)
    if (d.alpha >= 1)
      gl.DrawElements(GL_TRIANGLES, d.count, GL_UNSIGNED_INT,
                      reinterpret_cast<const void*>(std::size_t(d.first) * 4));

  gl.BindFramebuffer(GL_FRAMEBUFFER, multi_target_);
  gl.Viewport(0, 0, width_, height_);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, shadow_map_);
  gl.ActiveTexture(GL_TEXTURE1);
  gl.BindTexture(GL_TEXTURE_2D, white_);

  use(sky_);
  const float pitch = std::asin((view.target - view.eye).normalized().z());
  gl.Uniform3f(gl.GetUniformLocation(sky_, "view_up"), std::sin(pitch - view.vertical_fov / 2),
               std::sin(pitch + view.vertical_fov / 2), 0);
  gl.Disable(GL_DEPTH_TEST);
  gl.BindVertexArray(empty_array_);
  gl.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  gl.Enable(GL_DEPTH_TEST);
  use(ground_);
  gl.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);

  gl.BindVertexArray(array_);
  use(figure_);
  for (const bool translucent : {false, true})
    for (const Draw& d : geometry.draws) {
      if ((d.alpha < 1) != translucent) continue;
      gl.BindTexture(GL_TEXTURE_2D, texture(d.material));
      gl.Uniform1f(gl.GetUniformLocation(figure_, "alpha"), d.alpha);
      const void* first = reinterpret_cast<const void*>(std::size_t(d.first) * 4);
      if (translucent) {  // depth first, so that only the nearest skin is blended
        gl.ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        gl.DrawElements(GL_TRIANGLES, d.count, GL_UNSIGNED_INT, first);
        gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        gl.DepthFunc(GL_LEQUAL);
        gl.Enable(GL_BLEND);
        gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
      }
      gl.DrawElements(GL_TRIANGLES, d.count, GL_UNSIGNED_INT, first);
      gl.DepthFunc(GL_LESS);
      gl.Disable(GL_BLEND);
    }

  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, multi_target_);
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, single_target_);
  gl.BlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, single_target_);
  std::vector<std::uint8_t> upside_down(std::size_t(width_) * std::size_t(height_) * 4);
  gl.ReadPixels(0, 0, width_, height_, GL_BGRA, GL_UNSIGNED_BYTE, upside_down.data());
  out.width = width_;
  out.height = height_;
  out.pixels.resize(upside_down.size());
  const std::size_t row = std::size_t(width_) * 4;
  for (std::size_t y = 0; y < std::size_t(height_); ++y)
    std::memcpy(&out.pixels[y * row], &upside_down[(std::size_t(height_) - 1 - y) * row], row);
}

}  // namespace sinew::render
