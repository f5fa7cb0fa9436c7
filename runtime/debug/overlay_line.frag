// Draws a line; `strength` is lower for hidden parts.
#include "overlay_colors.glsl"

layout(location = 1) uniform float strength;
layout(location = 0) in vec4 line_color;
layout(location = 0) out vec4 color;

void main() {
  float alpha = strength * line_color.a;
  color = vec4(alpha * shownColor(line_color.rgb), alpha);
}
