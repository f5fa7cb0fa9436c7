// Takes E/pi from the texels of a draw that has some, and from its vertices where these are not shaded yet. What
// modules add at vertices stays.
layout(location = 7) in vec3 stored_radiance;  // at vertices, without what modules added
layout(location = 8) in vec2 irradiance_at;
layout(binding = kUnitIrradiance) uniform sampler2D irradiance_texture;

vec3 transferredLight(vec3 at_vertices) {
  if (!kHasTexels) return at_vertices;
  vec4 texel = look(irradiance_texture, irradiance_at);
  return at_vertices - texel.a * stored_radiance + texel.rgb;
}
