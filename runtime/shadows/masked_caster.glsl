// Passes on where the vertices of masked shadow casters look up the base colour texture. Include it after
// draws[] and geometry[].
layout(location = 1) flat out uint draw_of;
layout(location = 2) out vec3 looks_at;  // texture coordinates; z: the vertex colour's alpha

void lookUpMask(uint draw, uint vertex) {
  draw_of = draw;
  looks_at = vec3(0.0, 0.0, 1.0);
  if (draws[draw].base_color_texture.set != kAbsent) {
    uint word = draws[draw].base_color_texture.set == 1u ? draws[draw].texcoords1_word : draws[draw].texcoords0_word;
    vec2 coordinates = vec2(uintBitsToFloat(geometry[word + 2u * vertex]), uintBitsToFloat(geometry[word + 2u * vertex + 1u]));
    looks_at.xy = draws[draw].base_color_texture.texture_from_coordinates * vec3(coordinates, 1.0);
  }
  if (draws[draw].colors_word != kAbsent)
    looks_at.z = unpackUnorm2x16(geometry[draws[draw].colors_word + 2u * vertex + 1u]).y;
}
