// The shaders compute in linear light. The framebuffer stores the square root of the light (see resolve.h),
// which is cheaper than sRGB and equally accurate in dark areas.
#include "shaders.h"

namespace pliant::shaders {

const char* const kShared = R"(#version 330 core
layout(std140) uniform Frame {
  mat4 view_projection;
  mat4 shadow;
  mat4 contact;
  vec4 eye;
  vec4 to_key;
  vec4 key;
  vec4 sky;
  vec4 bounce;
  vec4 background_top;
  vec4 background_bottom;
  vec4 ground;
  vec4 ground_ambient;
  vec4 grid_color;
  vec4 grid;
  vec4 fade;
  vec4 viewport;
};

vec4 encode(vec3 light) { return vec4(sqrt(clamp(light, 0.0, 1.0)), 1.0); }

vec3 background(float y) {
  float t = clamp(y / viewport.y, 0.0, 1.0);
  return mix(background_bottom.rgb, background_top.rgb, t * t * (3.0 - 2.0 * t));
}

// Returns the unshadowed share of the key light, from a 4x4 grid of filtered comparisons. Each of the 2x2 samples of a
// pixel evaluates four of them, so that the mean of the samples covers the whole grid. A picture with at most one
// sample for each pixel makes one filtered comparison.
float key_light(sampler2DShadow map, vec3 place, vec2 sample_place) {
  float z = clamp(place.z, 0.0, 1.0);
  if (viewport.w < 1.0) return texture(map, vec3(place.xy, z));
  float step = 2.0 * viewport.z;
  vec2 corner = place.xy + (mod(floor(sample_place), 2.0) - 1.5) * step;
  return 0.25 * (texture(map, vec3(corner, z)) + texture(map, vec3(corner + vec2(2.0 * step, 0.0), z)) +
                 texture(map, vec3(corner + vec2(0.0, 2.0 * step), z)) +
                 texture(map, vec3(corner + vec2(2.0 * step), z)));
}
)";

const char* const kShadowVertex = R"(
layout(location = 0) in vec3 position;
void main() { gl_Position = vec4(2.0 * (shadow * vec4(position, 1.0)).xyz - 1.0, 1.0); }
)";

const char* const kHeightVertex = R"(
layout(location = 0) in vec3 position;
void main() { gl_Position = vec4(2.0 * (contact * vec4(position, 1.0)).xyz - 1.0, 1.0); }
)";

const char* const kDepthFragment = R"(
void main() {}
)";

const char* const kContactVertex = R"(
void main() { gl_Position = vec4(4.0 * float(gl_VertexID & 1) - 1.0, 2.0 * float(gl_VertexID & 2) - 1.0, 0.0, 1.0); }
)";

// Occlusion of the sky by rings of increasing radius around a point of the ground. A horizontal patch at
// height h that fills the ring from r0 to r1 blocks the share h^2/(r0^2 + h^2) - h^2/(r1^2 + h^2) of a
// uniform sky.
const char* const kContactFragment = R"(
uniform sampler2D heights;
out vec4 result;
float inside(float r, float h2) { return h2 / (r * r + h2); }
float blocked(vec2 at, float r0, float r1) {
  float depth = textureLod(heights, at, 0.0).r;
  float h = depth * fade.w + 0.25 * fade.z;
  return depth < 1.0 ? inside(r0, h * h) - inside(r1, h * h) : 0.0;
}
void main() {
  vec2 size = vec2(textureSize(heights, 0));
  vec2 at = gl_FragCoord.xy / size;
  float sum = blocked(at, 0.0, fade.z);
  float inner = 1.0;
  vec2 turn = vec2(1.0, 0.0);
  for (int ring = 0; ring < 6; ++ring) {
    float outer = inner * 1.85;
    float middle = sqrt(inner * outer);
    for (int sector = 0; sector < 12; ++sector) {
      sum += blocked(at + turn * middle / size, inner * fade.z, outer * fade.z) / 12.0;
      turn = vec2(0.8660254 * turn.x - 0.5 * turn.y, 0.5 * turn.x + 0.8660254 * turn.y);
    }
    turn = vec2(0.95106 * turn.x - 0.30902 * turn.y, 0.30902 * turn.x + 0.95106 * turn.y);
    inner = outer;
  }
  vec2 border = smoothstep(0.5, 0.4, abs(at - 0.5));
  result = vec4(1.0 - clamp(sum, 0.0, 1.0) * border.x * border.y);
}
)";

const char* const kBodyVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
out vec3 at;
out vec3 n_raw;
out vec3 on_map;
void main() {
  at = position;
  n_raw = normal;
  on_map = (shadow * vec4(position + to_key.w * normal, 1.0)).xyz;
  gl_Position = view_projection * vec4(position, 1.0);
}
)";

const char* const kLeveledVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float vertex_level;
out vec3 at;
out vec3 n_raw;
out vec3 on_map;
out float level;
void main() {
  at = position;
  n_raw = normal;
  on_map = (shadow * vec4(position + to_key.w * normal, 1.0)).xyz;
  level = vertex_level;
  gl_Position = view_projection * vec4(position, 1.0);
}
)";

const char* const kOwnColor = R"(
uniform vec3 own_color;
vec3 albedo() { return own_color; }
)";

// Interpolates the colours of color_map.h at a level.
const char* const kLevelColor = R"(
const int kColors = 11;
uniform vec3 color_map[kColors];
in float level;
vec3 albedo() {
  float place = clamp(level, 0.0, 1.0) * float(kColors - 1);
  int below = min(int(place), kColors - 2);
  return mix(color_map[below], color_map[below + 1], place - float(below));
}
)";

const char* const kBodyFragment = R"(
uniform sampler2DShadow shadow_map;
in vec3 at;
in vec3 n_raw;
in vec3 on_map;
out vec4 result;
void main() {
  vec3 n = n_raw * inversesqrt(max(dot(n_raw, n_raw), 1e-12));
  vec3 v = normalize(eye.xyz - at);
  float nl = dot(n, to_key.xyz);
  float nv = max(dot(n, v), 0.0);
  // The shadow map is unreliable near the terminator, so the light fades out smoothly there.
  float arrives = key_light(shadow_map, on_map, gl_FragCoord.xy) * smoothstep(0.0, 0.18, nl);
  float diffuse = max(nl, 0.0) * arrives;

  float near_ground = clamp((at.z - ground.w) / sky.w, 0.0, 1.0);
  vec3 below = bounce.rgb * (0.35 + 0.65 * near_ground * (2.0 - near_ground));
  vec3 ambient = mix(below, sky.rgb, 0.5 + 0.5 * n.z);

  vec3 h = normalize(v + to_key.xyz);
  float nh = max(dot(n, h), 0.0);
  float p2 = nh * nh, p4 = p2 * p2, p8 = p4 * p4, p16 = p8 * p8, p32 = p16 * p16;
  float gloss = 0.22 * p32 * p16;
  float grazing = 1.0 - nv;
  float g2 = grazing * grazing;
  float mirror = 0.03 + 0.55 * g2 * g2 * grazing;
  float up = clamp(0.5 + 0.9 * (2.0 * nv * n.z - v.z), 0.0, 1.0);

  result = encode(albedo() * (ambient + key.rgb * diffuse) + key.rgb * (gloss * arrives) +
                  mirror * mix(below, sky.rgb, up));
}
)";

const char* const kGroundVertex = R"(
out vec3 at;
void main() {
  vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1)) * 2.0 - 1.0;
  at = vec3(corner * fade.y, ground.w);
  gl_Position = view_projection * vec4(at, 1.0);
}
)";

const char* const kGroundFragment = R"(
uniform sampler2DShadow shadow_map;
uniform sampler2D contact_map;
in vec3 at;
out vec4 result;

// Returns the share of a sample that is covered by lines at the integers, `wide` samples wide. The lines fade out as
// the cells become narrow: from about 17 samples per cell (full) to 4.5 samples per cell (none).
vec2 lines(vec2 place, vec2 cell_per_sample, float wide) {
  vec2 off = abs(fract(place - 0.5) - 0.5) / cell_per_sample;
  return clamp(0.5 * wide + 0.5 - off, 0.0, 1.0) * (1.0 - smoothstep(0.06, 0.22, cell_per_sample));
}

void main() {
  float arrives = key_light(shadow_map, (shadow * vec4(at, 1.0)).xyz, gl_FragCoord.xy);
  float open = texture(contact_map, (contact * vec4(at, 1.0)).xy).r;

  vec2 place = at.xy / grid.z + grid.xy;
  vec2 dx = dFdx(place), dy = dFdy(place);
  vec2 cell = sqrt(dx * dx + dy * dy);
  vec2 thin = lines(place, cell, 1.6 * viewport.w);
  vec2 strong = lines(0.2 * place, 0.2 * cell, 2.6 * viewport.w);
  float line = max(0.38 * max(thin.x, thin.y), 0.75 * max(strong.x, strong.y));

  float radius = length(at.xy);
  float t = clamp((radius - fade.x) / (fade.y - fade.x), 0.0, 1.0);
  float left = (1.0 - t) * (1.0 - t) * (1.0 + 2.0 * t);
  vec3 color = mix(ground.rgb, grid_color.rgb, line * left);
  vec3 light = ground_ambient.rgb * (0.2 + 0.8 * open) + (1.0 - ground_ambient.rgb) * (arrives * (0.75 + 0.25 * open));
  result = encode(mix(background(gl_FragCoord.y), color * light, left));
}
)";

const char* const kBackgroundVertex = R"(
void main() { gl_Position = vec4(4.0 * float(gl_VertexID & 1) - 1.0, 2.0 * float(gl_VertexID & 2) - 1.0, 1.0, 1.0); }
)";

const char* const kBackgroundFragment = R"(
out vec4 result;
void main() { result = encode(background(gl_FragCoord.y)); }
)";

// Computes a pixel from its samples: the mean of their light, as an sRGB colour (IEC 61966-2-1).
const char* const kPresentFragment = R"(
uniform sampler2D samples;
out vec4 result;
void main() {
  vec3 light = vec3(0.0);
  if (viewport.w < 1.0) {
    vec3 root = texture(samples, gl_FragCoord.xy * 2.0 * viewport.w / viewport.xy).rgb;
    light = root * root;
  } else {
    ivec2 corner = ivec2(gl_FragCoord.xy) * 2;
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 2; ++x) {
        vec3 root = texelFetch(samples, corner + ivec2(x, y), 0).rgb;
        light += 0.25 * root * root;
      }
  }
  vec3 high = 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055;
  result = vec4(mix(high, 12.92 * light, vec3(lessThanEqual(light, vec3(0.0031308)))), 1.0);
}
)";

// Each instance draws one segment as a rectangle on the screen. The rectangle extends half the line width
// plus one sample beyond the segment on each side. The segment is moved slightly towards the eye, so that a
// surface does not hide a track on it.
const char* const kTrackVertex = R"(
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
uniform float half_width;
noperspective out vec2 on_segment;
flat out float segment_length;
void main() {
  vec4 a = view_projection * vec4(mix(eye.xyz, from, 0.995), 1.0);
  vec4 b = view_projection * vec4(mix(eye.xyz, to, 0.995), 1.0);
  if (a.w < eye.w && b.w < eye.w) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    on_segment = vec2(0.0);
    segment_length = 0.0;
    return;
  }
  if (a.w < eye.w) a = mix(a, b, (eye.w - a.w) / (b.w - a.w));
  if (b.w < eye.w) b = mix(b, a, (eye.w - b.w) / (a.w - b.w));
  vec2 pa = a.xy / a.w * 0.5 * viewport.xy;
  vec2 pb = b.xy / b.w * 0.5 * viewport.xy;
  segment_length = distance(pa, pb);
  vec2 along = segment_length > 1e-3 ? (pb - pa) / segment_length : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  float reach = half_width + 1.0;
  bool at_end = (gl_VertexID & 1) == 1;
  float side = (gl_VertexID & 2) == 2 ? reach : -reach;
  float beyond = at_end ? segment_length + reach : -reach;
  on_segment = vec2(beyond, side);
  vec4 end = at_end ? b : a;
  vec2 p = pa + along * beyond + across * side;
  gl_Position = vec4(p / (0.5 * viewport.xy) * end.w, end.z, end.w);
}
)";

const char* const kTrackFragment = R"(
uniform vec3 color;
uniform float half_width;
noperspective in vec2 on_segment;
flat in float segment_length;
out vec4 result;
void main() {
  vec2 off = vec2(on_segment.x - clamp(on_segment.x, 0.0, segment_length), on_segment.y);
  result = vec4(encode(color).rgb, clamp(half_width + 0.5 - length(off), 0.0, 1.0));
}
)";

}  // namespace pliant::shaders
