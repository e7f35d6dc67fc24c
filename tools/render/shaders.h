// Shader sources. Every shader tone-maps its own output, so that the multisampled buffer can stay 8 bits.
#pragma once

namespace sinew::render {

inline constexpr const char* kCommon = R"(#version 330 core
uniform mat4 view_projection, light_matrix;
uniform vec3 eye, light_direction, key_color, sky_color, ground_color, fog_color;
uniform sampler2DShadow shadow_map;
vec3 tone(vec3 x) { // ACES fit by Narkowicz, then sRGB
  x = clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
  return pow(x, vec3(1.0 / 2.2));
}
float shadow(vec3 p, vec3 n) {
  vec4 q = light_matrix * vec4(p + n * 0.012, 1.0);
  vec3 s = q.xyz * 0.5 + 0.5;
  float sum = 0.0;
  for (int i = 0; i < 12; ++i) { // golden-angle disc
    float r = sqrt((float(i) + 0.5) / 12.0) * 0.0022, a = 2.39996 * float(i);
    sum += texture(shadow_map, vec3(s.xy + r * vec2(cos(a), sin(a)), s.z - 0.0012));
  }
  vec2 edge = smoothstep(vec2(0.5), vec2(0.42), abs(s.xy - 0.5));
  return mix(1.0, sum / 12.0, edge.x * edge.y);
}
)";

inline constexpr const char* kFigureVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec4 color;
out vec3 p, n;
out vec2 t;
out vec4 c;
void main() { p = position; n = normal; t = uv; c = color; gl_Position = view_projection * vec4(position, 1.0); }
)";

inline constexpr const char* kFigureFragment = R"(
in vec3 p, n;
in vec2 t;
in vec4 c;
uniform sampler2D albedo_map;
uniform float alpha;
uniform float ground;
out vec4 result;
void main() {
  vec3 texel = pow(texture(albedo_map, t).rgb, vec3(2.2));
  vec3 albedo = mix(c.rgb * texel, c.rgb, c.a);
  vec3 v = normalize(eye - p), m = normalize(n);
  if (dot(m, v) < 0.0) m = -m;
  float lit = max(dot(m, light_direction), 0.0) * shadow(p, m);
  // Ambient from sky and floor, darker where a surface looks down close to the floor.
  float near_floor = 1.0 - 0.55 * exp(-5.0 * max(p.z - ground, 0.0)) * (0.5 - 0.5 * m.z);
  vec3 ambient = mix(ground_color, sky_color, 0.5 + 0.5 * m.z) * near_floor;
  vec3 h = normalize(light_direction + v);
  float gloss = pow(max(dot(m, h), 0.0), 48.0) * 0.22;
  float fresnel = pow(1.0 - max(dot(m, v), 0.0), 3.5);
  float back = max(dot(m, normalize(vec3(-light_direction.xy, 0.35))), 0.0);
  vec3 rim = vec3(0.55, 0.68, 0.85) * fresnel * (0.25 + 0.75 * back);
  vec3 light = albedo * (key_color * lit + ambient) + key_color * gloss * lit + rim * 0.32 + c.rgb * c.a * 0.30;
  float opacity = alpha < 1.0 ? mix(alpha * 0.6, 0.75, fresnel) : 1.0;
  result = vec4(tone(light), opacity);
}
)";

inline constexpr const char* kShadowFragment = "void main() {}\n";

inline constexpr const char* kShadowVertex = R"(
layout(location = 0) in vec3 position;
void main() { gl_Position = light_matrix * vec4(position, 1.0); }
)";

inline constexpr const char* kGroundVertex = R"(
uniform float ground;
out vec3 p;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  p = vec3(eye.xy + corner * 120.0, ground);
  gl_Position = view_projection * vec4(p, 1.0);
}
)";

inline constexpr const char* kGroundFragment = R"(
in vec3 p;
out vec4 result;
float line(float x, float half_width) { // analytic coverage of a line at every integer
  float w = fwidth(x), d = abs(fract(x - 0.5) - 0.5);
  return clamp((half_width + 0.5 * w - d) / max(w, 1e-6), 0.0, 1.0) * min(1.0, 2.0 * half_width / max(w, 1e-6) + 0.15);
}
void main() {
  float away = length(p.xy - eye.xy), fade = exp(-away * away * 0.0028);
  float fine = max(line(p.x * 2.0, 0.008), line(p.y * 2.0, 0.008)) * 0.35, coarse = max(line(p.x * 0.5, 0.006), line(p.y * 0.5, 0.006));
  vec3 base = ground_color;
  float lit = shadow(p, vec3(0, 0, 1));
  vec3 light = base * (key_color * light_direction.z * mix(0.22, 1.0, lit) + sky_color * 0.55);
  light += (max(fine, coarse) * 0.16 * sky_color) * mix(0.5, 1.0, lit);
  result = vec4(mix(fog_color, tone(light), clamp(fade, 0.0, 1.0)), 1.0);
}
)";

inline constexpr const char* kSkyVertex = R"(
out float up;
uniform vec3 view_up; // height of the view ray at the bottom, top; x bottom, y top
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  up = mix(view_up.x, view_up.y, corner.y * 0.5 + 0.5);
  gl_Position = vec4(corner, 0.9999, 1.0);
}
)";

inline constexpr const char* kSkyFragment = R"(
in float up;
uniform vec3 zenith;
out vec4 result;
void main() {
  float dither = fract(sin(dot(gl_FragCoord.xy, vec2(12.9898, 78.233))) * 43758.5453) / 255.0;
  result = vec4(mix(fog_color, zenith, smoothstep(0.0, 0.75, up)) + dither, 1.0);
}
)";

}  // namespace sinew::render
