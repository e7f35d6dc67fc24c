// Shader sources. Every shader tone-maps its own output, so that buffers can stay 8 bits.
// Variants are made by #define (OCCLUSION, SHADOW_TAPS, SAMPLES, TEXTURED, UNSHADOWED, COLOR_KIND: flat where
// colours are ids): llvmpipe runs both sides of an `if`. Lengths are in metres times `unit`, the figure's
// size in adults of 1.75 m: a beetle is lit like a man.
#pragma once

namespace sinew::render {

inline constexpr const char* kUniforms = R"(
uniform mat4 view_projection, light_matrix;
uniform vec3 eye, target, light_direction, key_color, sky_color, ground_color, fog_color, rim_color;
uniform vec2 viewport; // pixels
uniform float unit, ground, shift; // shift: of the target, in half widths
)";

/// Before every fragment shader.
inline constexpr const char* kShading = R"(
uniform sampler2DShadow shadow_map;
vec3 tone(vec3 x) { // ACES fit by Narkowicz, then sRGB
  x = clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
  return pow(x, vec3(1.0 / 2.2));
}
float shadow(vec3 p, vec3 n, float softness) {
  vec4 q = light_matrix * vec4(p + n * 0.012 * unit, 1.0);
  vec3 s = q.xyz * 0.5 + 0.5;
  float sum = 0.0;
  for (int i = 0; i < SHADOW_TAPS; ++i) { // golden-angle disc
    float r = sqrt((float(i) + 0.5) / float(SHADOW_TAPS)) * softness, a = 2.39996 * float(i);
    sum += texture(shadow_map, vec3(s.xy + r * vec2(cos(a), sin(a)), s.z - 0.0012));
  }
  vec2 edge = smoothstep(vec2(0.5), vec2(0.42), abs(s.xy - 0.5));
  return mix(1.0, sum / float(SHADOW_TAPS), edge.x * edge.y);
}
vec3 unfold(vec2 f) {
  vec3 m = vec3(f, 1.0 - abs(f.x) - abs(f.y));
  float back = max(-m.z, 0.0);
  m.xy -= back * vec2(m.x < 0.0 ? -1.0 : 1.0, m.y < 0.0 ? -1.0 : 1.0);
  return normalize(m);
}
uniform vec2 near_far; // m
float distance_of(float depth) { // along the view, m, of a value of the depth map
  return 2.0 * near_far.x * near_far.y /
         (near_far.y + near_far.x - (depth * 2.0 - 1.0) * (near_far.y - near_far.x));
}
uniform float vignetting;
float vignette() {
  vec2 away = (gl_FragCoord.xy / viewport - 0.5 - vec2(0.5 * shift, 0.0)) * vec2(1.0, 0.8);
  return 1.0 - vignetting * dot(away, away);
}
#ifdef OCCLUSION
uniform sampler2D occlusion_map; // half resolution: openness, distance
float openness(float depth) { // of the four nearest texels, those at the same distance
  vec2 at = gl_FragCoord.xy * 0.5 - 0.5;
  ivec2 low = ivec2(floor(at)), last = textureSize(occlusion_map, 0) - 1;
  vec2 f = at - vec2(low);
  float weight = 1e-4;
  float open = 1e-4;
  for (int i = 0; i < 4; ++i) {
    ivec2 o = ivec2(i & 1, i >> 1);
    vec2 texel = texelFetch(occlusion_map, clamp(low + o, ivec2(0), last), 0).rg;
    vec2 b = mix(1.0 - f, f, vec2(o));
    float w = b.x * b.y / (0.02 * unit + abs(texel.g - depth));
    open += w * texel.r;
    weight += w;
  }
  return open / weight;
}
#else
float openness(float depth) { return 1.0; }
#endif
)";

inline constexpr const char* kFigureVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec4 color;
centroid out vec3 p, n;
centroid out vec2 t;
COLOR_KIND out vec4 c;
void main() { p = position; n = normal; t = uv; c = color; gl_Position = view_projection * vec4(position, 1.0); }
)";

/// What the figure is at every sample. Its light comes afterwards, once per pixel: llvmpipe shades 4x4 pixels
/// for every triangle that touches one of them, and triangles are smaller than that.
inline constexpr const char* kSurfaceFragment = R"(
centroid in vec3 n;
centroid in vec2 t;
COLOR_KIND in vec4 c;
uniform sampler2D albedo_map;
layout(location = 0) out vec4 surface; // square root of the albedo, for 8 bits; share of stress
layout(location = 1) out vec2 folded; // normal, octahedral
void main() {
  vec3 m = gl_FrontFacing ? n : -n;
  m /= abs(m.x) + abs(m.y) + abs(m.z);
  vec2 over = (1.0 - abs(m.yx)) * vec2(m.x < 0.0 ? -1.0 : 1.0, m.y < 0.0 ? -1.0 : 1.0);
  folded = m.z < 0.0 ? over : m.xy;
#ifdef TEXTURED
  vec3 albedo = mix(c.rgb * pow(texture(albedo_map, t).rgb, vec3(2.2)), c.rgb, c.a);
#else
  vec3 albedo = c.rgb;
#endif
  surface = vec4(sqrt(albedo), c.a);
}
)";

/// Lights the figure's samples and lays them over the background. Samples at one distance are one surface and
/// lit together; where a nearer part ends within a pixel, two surfaces are. The loop ends in its middle, not
/// at its head: llvmpipe runs a loop's body once more to find that no pixel of a block is left in it.
inline constexpr const char* kFigureFragment = R"(
uniform sampler2DMS surface_map, normal_map, distance_map;
uniform mat4 from_clip;
out vec4 result;
vec3 light(vec3 p, vec3 m, vec4 s, float away) {
  vec3 v = normalize(eye - p), albedo = s.rgb * s.rgb;
  float facing = max(dot(m, v), 0.0);
  float open = openness(away);
  float lit = max(dot(m, light_direction), 0.0) * shadow(p, m, 0.0016) * mix(0.6, 1.0, open);
  // Ambient from sky and floor; a surface that looks down close to the floor sees little of either.
  float near_floor = 1.0 - 0.6 * exp(-8.0 * max(p.z - ground, 0.0) / unit) * (0.5 - 0.5 * m.z);
  vec3 ambient = mix(ground_color * 1.3, sky_color, 0.5 + 0.5 * m.z) * near_floor * open;
  vec3 h = normalize(light_direction + v);
  float gloss = pow(max(dot(m, h), 0.0), 40.0) * 0.16 * lit;
  float back = max(dot(m, normalize(vec3(-light_direction.xy, 0.35))), 0.0);
  vec3 rim = rim_color * pow(1.0 - facing, 3.0) * (0.2 + 0.8 * back) * open;
  vec3 sum = albedo * (key_color * lit + ambient) + key_color * gloss + rim;
  return tone(sum + albedo * s.a * s.a * 0.35); // what is saturated glows
}
void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec2 folded[SAMPLES];
  float covered = 0.0;
  for (int i = 0; i < SAMPLES; ++i) {
    folded[i] = texelFetch(normal_map, here, i).rg;
    covered += folded[i].x < 2.0 ? 1.0 : 0.0;
  }
  result = vec4(0.0);
  float taken = 0.0, from = 0.0; // samples lit; m: those up to there are
  for (int k = 0;; ++k) {
    float away[SAMPLES], nearest = near_far.y;
    for (int i = 0; i < SAMPLES; ++i) {
      away[i] = distance_of(texelFetch(distance_map, here, i).r);
      if (folded[i].x < 2.0 && away[i] > from) nearest = min(nearest, away[i]);
    }
    float limit = nearest + 0.015 * unit, count = 0.0, far = 0.0;
    vec3 m = vec3(0.0);
    vec4 s = vec4(0.0);
    for (int i = 0; i < SAMPLES; ++i) {
      bool own = folded[i].x < 2.0 && away[i] > from && (away[i] <= limit || k == 1);
      float w = own ? 1.0 : 0.0;
      count += w;
      far += w * away[i];
      m += w * unfold(folded[i]);
      s += w * texelFetch(surface_map, here, i);
    }
    float share = count / float(SAMPLES);
    count = max(count, 1.0);
    far /= count;
    float z = (near_far.y + near_far.x - 2.0 * near_far.x * near_far.y / far) / (near_far.y - near_far.x);
    vec4 p = from_clip * vec4(gl_FragCoord.xy / viewport * 2.0 - 1.0, z, 1.0);
    vec4 lit = vec4(light(p.xyz / p.w, normalize(m), s / count, far), 1.0);
    if (share > 0.0) result += share * lit;
    taken += count;
    from = limit;
    if (taken >= covered || k == 1) break;
  }
}
)";

/// One sample of what the figure is: its distance (DEPTH), its normal (NORMAL) or its colour.
inline constexpr const char* kDataFragment = R"(
uniform sampler2DMS surface_map, normal_map, distance_map;
out vec4 result;
void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec2 folded = texelFetch(normal_map, here, 0).rg;
  if (!(folded.x < 2.0)) discard;
#if defined(DEPTH)
  float mm = min(floor(distance_of(texelFetch(distance_map, here, 0).r) * 1000.0 + 0.5), 65534.0);
  result = vec4(floor(mm / 256.0) / 255.0, mod(mm, 256.0) / 255.0, 0.0, 1.0);
#elif defined(NORMAL)
  result = vec4(unfold(folded) * 0.5 + 0.5, 1.0);
#else
  result = vec4(texelFetch(surface_map, here, 0).rgb, 1.0);
#endif
}
)";

/// Skin around muscles: clear where one looks straight through, an outline at the rim.
inline constexpr const char* kShellFragment = R"(
centroid in vec3 p, n;
COLOR_KIND in vec4 c;
out vec4 result;
void main() {
  vec3 v = normalize(eye - p), m = normalize(n) * (gl_FrontFacing ? 1.0 : -1.0);
  float edge = pow(1.0 - max(dot(m, v), 0.0), 2.5);
  result = vec4(mix(tone(rim_color), tone(c.rgb * 1.4), 0.8 * c.a), 1.0) * (0.05 + 0.62 * edge);
}
)";

inline constexpr const char* kDepthVertex = R"(
layout(location = 0) in vec3 position;
uniform mat4 to_clip;
void main() { gl_Position = to_clip * vec4(position, 1.0); }
)";

inline constexpr const char* kDepthFragment = "void main() {}\n";

inline constexpr const char* kGroundVertex = R"(
out vec3 p;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  p = vec3(eye.xy + corner * 120.0 * unit, ground);
  gl_Position = view_projection * vec4(p, 1.0);
}
)";

inline constexpr const char* kGroundFragment = R"(
in vec3 p;
uniform float pool, cell; // darkening away from the figure; m between grid lines
uniform vec3 line_color;
out vec4 result;
float line(float x, float half_width) { // analytic coverage of a line at every integer
  float w = max(fwidth(x), 1e-6), d = abs(fract(x - 0.5) - 0.5);
  return clamp((half_width + 0.5 * w - d) / w, 0.0, 1.0) * min(1.0, 2.0 * half_width / w + 0.12);
}
void main() {
  vec2 g = p.xy / cell;
  float away = length(p.xy - eye.xy) / unit, off = length(p.xy - target.xy) / unit;
  float fine = max(line(g.x, 0.006), line(g.y, 0.006)) * 0.4 * exp(-0.02 * off * off);
  float coarse = max(line(g.x * 0.25, 0.0028), line(g.y * 0.25, 0.0028));
  float spot = mix(1.0, exp(-0.045 * off * off), pool);
#ifdef UNSHADOWED // nothing throws a shadow here
  float lit = 1.0;
#else
  float lit = shadow(p, vec3(0, 0, 1), 0.0030);
#endif
  float open = openness(1.0 / gl_FragCoord.w);
  vec3 light = ground_color * (key_color * light_direction.z * mix(0.16, 1.0, lit) * mix(0.55, 1.0, open) * spot
                               + sky_color * 0.6 * mix(0.2, 1.0, open));
  light = mix(light, line_color * mix(0.45, 1.0, lit) * mix(0.35, 1.0, spot), max(fine, coarse) * 0.55);
  result = vec4(mix(fog_color, tone(light), exp(-away * away * 0.0024)) * vignette(), 1.0);
}
)";

inline constexpr const char* kSkyVertex = R"(
out float up;
uniform vec2 view_up; // height of the view ray at the bottom and at the top
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
  float dither = (fract(sin(dot(gl_FragCoord.xy, vec2(12.9898, 78.233))) * 43758.5453) - 0.5) * 0.998 / 255.0;
  result = vec4(mix(fog_color, zenith, smoothstep(0.0, 0.42, up)) * vignette() + dither, 1.0);
}
)";

inline constexpr const char* kScreenVertex = R"(
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0, 0.0, 1.0); }
)";

/// The skin's samples over the picture; they come multiplied by their coverage.
inline constexpr const char* kResolveFragment = R"(
uniform sampler2DMS surface_map;
out vec4 result;
void main() {
  result = vec4(0.0);
  for (int i = 0; i < SAMPLES; ++i) result += texelFetch(surface_map, ivec2(gl_FragCoord.xy), i) / float(SAMPLES);
}
)";

/// Distance along the view of figure or floor, m, at half resolution.
inline constexpr const char* kDistanceFragment = R"(
uniform sampler2DMS distance_map;
uniform mat4 from_clip;
out float result;
void main() {
  vec2 at = 2.0 * gl_FragCoord.xy;
  float away = distance_of(texelFetch(distance_map, min(ivec2(at), ivec2(viewport) - 1), 0).r);
  vec4 end = from_clip * vec4(at / viewport * 2.0 - 1.0, 1.0, 1.0);
  float down = (ground - eye.z) / (end.z / end.w - eye.z); // share of the view ray to the floor
  result = min(away, near_far.y * (down > 0.0 ? down : 1.0));
}
)";

/// Scalable ambient obscurance (McGuire, Mara & Luebke 2012, equation 10 without the bias table): a spiral of
/// taps around the pixel, turned by a 4x4 pattern that the blur takes out again.
inline constexpr const char* kObscuranceFragment = R"(
uniform sampler2D depth_map; // m
uniform vec2 slope; // half view size at distance 1
out vec2 result;
vec3 position(ivec2 at) {
  float z = texelFetch(depth_map, at, 0).r;
  return vec3(((vec2(at) + 0.5) / vec2(textureSize(depth_map, 0)) * 2.0 - 1.0 - vec2(shift, 0.0)) * slope * z, -z);
}
vec3 smaller(vec3 a, vec3 b) { return abs(a.z) < abs(b.z) ? a : b; }
void main() {
  ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(depth_map, 0) - 1;
  vec3 p = position(here);
  vec3 dx = smaller(position(min(here + ivec2(1, 0), last)) - p, p - position(max(here - ivec2(1, 0), ivec2(0))));
  vec3 dy = smaller(position(min(here + ivec2(0, 1), last)) - p, p - position(max(here - ivec2(0, 1), ivec2(0))));
  vec3 n = normalize(cross(dx, dy));
  float radius = 0.26 * unit, squared = radius * radius;
  float reach = min(radius / (slope.y * -p.z) * 0.5 * float(last.y + 1), 0.25 * float(last.y + 1)); // texels
  float turn = float((here.x & 3) * 4 + (here.y & 3)) * 0.3926991;
  const mat2 golden = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688); // by 2.39996 rad: no sine per tap
  vec2 along = reach / 14.0 * vec2(cos(turn), sin(turn));
  float sum = 0.0;
  for (int i = 0; i < 14; ++i) {
    ivec2 at = clamp(here + ivec2((float(i) + 0.5) * along), ivec2(0), last);
    along = golden * along;
    vec3 v = position(at) - p;
    float vv = dot(v, v), f = max(squared - vv, 0.0);
    sum += f * f * f * max((dot(v, n) - 0.006 * unit) / (vv + 1e-4 * unit * unit), 0.0);
  }
  float open = max(0.0, 1.0 - sum * 0.38 * unit / (squared * squared * squared * 14.0));
  result = vec2(open, -p.z);
}
)";

inline constexpr const char* kBlurFragment = R"(
uniform sampler2D depth_map; // openness, distance
out vec2 result;
void main() {
  ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(depth_map, 0) - 1;
  float depth = texelFetch(depth_map, here, 0).g, sum = 0.0, weight = 0.0;
  for (int y = -2; y < 2; ++y)
    for (int x = -2; x < 2; ++x) {
      vec2 texel = texelFetch(depth_map, clamp(here + ivec2(x, y), ivec2(0), last), 0).rg;
      float w = max(0.001, 1.0 - abs(texel.g - depth) / (0.08 * unit));
      sum += w * texel.r;
      weight += w;
    }
  result = vec2(sum / weight, depth);
}
)";

}  // namespace sinew::render
