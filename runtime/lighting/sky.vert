// Draws one triangle over the whole picture at the far plane, and passes on the ray through each pixel.
layout(location = 0) uniform mat4 world_from_clip;
layout(location = 0) out vec4 near_ws;
layout(location = 1) out vec4 far_ws;

void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  near_ws = world_from_clip * vec4(corner, -1.0, 1.0);
  far_ws = world_from_clip * vec4(corner, 1.0, 1.0);
  gl_Position = vec4(corner, 1.0, 1.0);
}
