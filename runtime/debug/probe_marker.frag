// Shows the radiance that arrives at a light probe from the direction of the cube's or ball's surface point:
// on the cube what is captured there, on the ball the harmonics.
#include "overlay_colors.glsl"

struct Sign {
  vec4 place_and_radius;
  vec4 group_from_world;
  uint light;
  uint order;
  uint pad[2];
};
struct Disc {
  vec4 direction_and_radius;  // world axes; w: radius in radians
  vec4 radiance;
};
layout(std430, binding = 1) readonly buffer Signs { Sign signs[]; };
layout(std430, binding = 2) readonly buffer Lights { vec4 lights[]; };
layout(std430, binding = 3) readonly buffer Cubes { vec4 cubes[]; };
layout(std430, binding = 4) readonly buffer Discs { Disc discs[]; };
layout(binding = 0) uniform samplerCube first_sky;
layout(binding = 1) uniform samplerCube second_sky;
layout(location = 0) uniform mat3 light_from_world;
layout(location = 1) uniform vec2 shares;  // factors on the two sets of lights
layout(location = 2) uniform uint disc_count;
layout(location = 3) uniform int cube_size;  // 0 if there are no bodies

layout(location = 0) in vec3 direction;
layout(location = 1) in vec2 face_place;
layout(location = 2) flat in ivec2 face_and_sign;
layout(location = 0) out vec4 color;

vec3 turned(vec4 turn, vec3 v) { return v + 2.0 * cross(turn.xyz, cross(turn.xyz, v) + turn.w * v); }

// Returns the sum over i of l_i y_i(n), with the recurrences of unshadowedRadiance in diffuse_eval.glsl
// without its weights.
vec3 harmonics(vec3 n, uint light, int order) {
  vec3 sum = vec3(0.0);
  float c = 1.0, s = 0.0, sectoral = 0.28209479177387814;
  for (int m = 0; m < order; ++m) {
    if (m > 0) {
      float next_c = n.x * c - n.y * s;
      s = n.x * s + n.y * c;
      c = next_c;
      sectoral *= m == 1 ? sqrt(3.0) : sqrt(float(2 * m + 1) / float(2 * m));
    }
    float p = sectoral, before = 0.0;
    for (int l = m; l < order; ++l) {
      if (l > m) {
        float z_factor = sqrt(float(4 * l * l - 1) / float(l * l - m * m));
        float back = l == m + 1 ? 0.0
                                : z_factor * sqrt(float((l - 1) * (l - 1) - m * m) / float(4 * (l - 1) * (l - 1) - 1));
        float next = z_factor * n.z * p - back * before;
        before = p;
        p = next;
      }
      uint centre = light + uint(l * (l + 1));
      sum += p * (m == 0 ? lights[centre].rgb : c * lights[centre + uint(m)].rgb + s * lights[centre - uint(m)].rgb);
    }
  }
  return sum;
}

vec3 captured(vec3 dir) {
  vec3 sky = shares.x * texture(first_sky, light_from_world * dir).rgb + shares.y * texture(second_sky, light_from_world * dir).rgb;
  // Suns are smaller than such a cube can show; their edges are as soft as one of its pixels is wide.
  float soft = max(length(fwidth(dir)), 1e-3);
  for (uint i = 0u; i < disc_count; ++i) {
    vec3 to_disc = discs[i].direction_and_radius.xyz;
    float angle = atan(length(cross(dir, to_disc)), dot(dir, to_disc));
    sky += clamp((discs[i].direction_and_radius.w - angle) / soft + 0.5, 0.0, 1.0) * discs[i].radiance.rgb;
  }
  if (cube_size == 0) return sky;
  ivec2 texel = clamp(ivec2(0.5 * (face_place + 1.0) * float(cube_size)), ivec2(0), ivec2(cube_size - 1));
  vec4 bodies = cubes[((face_and_sign.y * 6 + face_and_sign.x) * cube_size + texel.y) * cube_size + texel.x];
  return bodies.rgb + (1.0 - bodies.a) * sky;
}

void main() {
  vec3 dir = normalize(direction);
  Sign sign_of = signs[face_and_sign.y];
  if (face_and_sign.x < 0) {
    color = vec4(shownLight(harmonics(turned(sign_of.group_from_world, dir), sign_of.light, int(sign_of.order))), 1.0);
    return;
  }
  vec3 radiance = shownLight(captured(dir));
  // Dark edges distinguish the cube from a sky that it shows itself.
  float edge = max(abs(face_place.x), abs(face_place.y));
  color = vec4(mix(radiance, vec3(0.0), 0.8 * smoothstep(0.9, 0.95, edge)), 1.0);
}
