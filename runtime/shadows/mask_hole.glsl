// Tells whether a fragment of a masked shadow caster is a hole. Include it after draws[].
layout(binding = kUnitBaseColor) uniform sampler2D base_color_texture;
layout(location = 1) flat in uint draw_of;
layout(location = 2) in vec3 looks_at;

bool inHole() {
  float alpha = draws[draw_of].base_color.a * looks_at.z;
  if (draws[draw_of].base_color_texture.set != kAbsent) alpha *= texture(base_color_texture, looks_at.xy).a;
  return alpha < draws[draw_of].alpha_cutoff;
}
