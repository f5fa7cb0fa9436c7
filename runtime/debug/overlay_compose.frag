// Blends the layer over the picture; its colours are premultiplied by alpha.
#include "hdr_input.glsl"

layout(location = 0) out vec4 color;

void main() {
  vec4 sum = vec4(0.0);
  for (int i = 0; i < kSamples; ++i) sum += hdrAt(ivec2(gl_FragCoord.xy), i);
  color = sum / float(kSamples);
}
