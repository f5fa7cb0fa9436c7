// Blends the layer over the picture; its colours are premultiplied by alpha.
#ifdef LAMBENT_SAMPLES
layout(binding = 0) uniform sampler2DMS layer;
const int kSamples = LAMBENT_SAMPLES;
vec4 layerAt(ivec2 pixel, int index) { return texelFetch(layer, pixel, index); }
#else
layout(binding = 0) uniform sampler2D layer;
const int kSamples = 1;
vec4 layerAt(ivec2 pixel, int index) { return texelFetch(layer, pixel, 0); }
#endif
layout(location = 0) out vec4 color;

void main() {
  vec4 sum = vec4(0.0);
  for (int i = 0; i < kSamples; ++i) sum += layerAt(ivec2(gl_FragCoord.xy), i);
  color = sum / float(kSamples);
}
