// Writes what mapped_normal.glsl reads of the vertices. Together with the light of normal-mapped surfaces and what a
// layer reads this uses all fifteen locations that OpenGL 4.5 promises.
layout(location = 3) out vec4 position_group;
layout(location = 4) out vec4 normal_group;
layout(location = 5) out vec4 tangent_group;

void writeTangentFrame(uint vertex, vec3 position, vec2 normal_at) {
  mat3 group_from_mesh = mat3(draws[draw_index].group_from_mesh);
  position_group = vec4(group_from_mesh * position, normal_at.x);
  normal_group = vec4(weightedNormal(vertex), normal_at.y);
  tangent_group = vec4(0.0);
  if (draws[draw_index].tangents_word != kAbsent) {
    uint at = draws[draw_index].tangents_word + 4u * vertex;
    // A mirrored node mirrors the bitangent, but a cross product of transformed vectors would not.
    float mirrored = determinant(group_from_mesh) < 0.0 ? -1.0 : 1.0;
    tangent_group = vec4(group_from_mesh * geometry3(at), mirrored * uintBitsToFloat(geometry[at + 3u]));
  }
}
