// Writes the environment's radiance along the pixel's ray. Perspective rays start at the origin, so far -
// near is the ray for both kinds of camera.
layout(location = 1) uniform mat3 light_from_world;
layout(location = 2) uniform uint disc_count;
layout(location = 3) uniform float pixel_angle;  // radians spanned by a pixel
layout(location = 4) uniform vec2 shares;        // factors on the two sets of lights
layout(binding = 0) uniform samplerCube first_sky;
layout(binding = 1) uniform samplerCube second_sky;

struct Disc {
  vec4 direction_and_radius;  // lights' own frame; w: radius in radians
  vec3 radiance;
  float set;  // index of the set, 0 or 1
};
layout(std430, binding = 0) readonly buffer Discs { Disc discs[]; };

layout(location = 0) in vec4 near_ws;
layout(location = 1) in vec4 far_ws;
layout(location = 0) out vec4 color;

void main() {
  vec3 dir_ws = normalize(far_ws.xyz / far_ws.w - near_ws.xyz / near_ws.w);
  vec3 dir = light_from_world * dir_ws;
  vec3 radiance = shares.x * texture(first_sky, dir).rgb + shares.y * texture(second_sky, dir).rgb;
  for (uint i = 0u; i < disc_count; ++i) {
    vec3 to_disc = discs[i].direction_and_radius.xyz;
    // acos would lose its last digits for just the angles of small discs.
    float angle = atan(length(cross(dir, to_disc)), dot(dir, to_disc));
    // Derivatives are not used: they are unreliable in partly covered pixels.
    float inside = clamp((discs[i].direction_and_radius.w - angle) / pixel_angle + 0.5, 0.0, 1.0);
    radiance += inside * (discs[i].set > 0.5 ? shares.y : shares.x) * discs[i].radiance;
  }
  color = vec4(radiance, 0.0);
}
