// Draws a line as a quad of its width in pixels, clipped at the plane of the eye; `strength` is lower for hidden
// parts.
#ifdef LAMBENT_VERTEX
#include "view_block.glsl"

struct Line {
  vec4 from_and_width;  // world position; w: width in pixels
  vec4 to;
  vec4 color;
};
layout(std430, binding = 1) readonly buffer Lines { Line lines[]; };
layout(location = 0) uniform vec2 size_px;
layout(location = 0) out vec4 line_color;

void main() {
  const vec2 kCorners[6] = vec2[6](vec2(0, -1), vec2(1, -1), vec2(0, 1), vec2(0, 1), vec2(1, -1), vec2(1, 1));
  Line line = lines[gl_VertexID / 6];
  vec2 corner = kCorners[gl_VertexID % 6];
  line_color = line.color;
  vec4 a = clip_from_view * (view_from_world * vec4(line.from_and_width.xyz, 1.0));
  vec4 b = clip_from_view * (view_from_world * vec4(line.to.xyz, 1.0));
  // It is not clipped at the near plane, which fits only the scene; depth is clamped instead.
  float least = 1e-3 * max(a.w, b.w), a_in = a.w - least, b_in = b.w - least;
  if (least <= 0.0) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  if (a_in < 0.0) a = mix(a, b, a_in / (a_in - b_in));
  if (b_in < 0.0) b = mix(b, a, b_in / (b_in - a_in));
  vec2 along = 0.5 * size_px * (b.xy / b.w - a.xy / a.w);
  float length_px = length(along);
  along = length_px > 1e-4 ? along / length_px : vec2(1.0, 0.0);
  vec4 end = corner.x == 0.0 ? a : b;
  vec2 aside = 0.5 * line.from_and_width.w * (corner.y * vec2(-along.y, along.x) + (2.0 * corner.x - 1.0) * along);
  gl_Position = end + vec4(2.0 * aside / size_px * end.w, 0.0, 0.0);
}
#else
#include "overlay_colors.glsl"

layout(location = 1) uniform float strength;
layout(location = 0) in vec4 line_color;
layout(location = 0) out vec4 color;

void main() {
  float alpha = strength * line_color.a;
  color = vec4(alpha * shownColor(line_color.rgb), alpha);
}
#endif
