// Reads the linear picture with LAMBENT_SAMPLES samples per pixel (0: a plain texture).
#ifdef LAMBENT_SAMPLES
layout(binding = 0) uniform sampler2DMS hdr;
const int kSamples = LAMBENT_SAMPLES;
ivec2 hdrSize() { return textureSize(hdr); }
vec4 hdrAt(ivec2 pixel, int index) { return texelFetch(hdr, pixel, index); }
#else
layout(binding = 0) uniform sampler2D hdr;
const int kSamples = 1;
ivec2 hdrSize() { return textureSize(hdr, 0); }
vec4 hdrAt(ivec2 pixel, int index) { return texelFetch(hdr, pixel, 0); }
#endif

struct Exposure {
  float scale;                // factor on radiance before the curve
  uint negative_pixels;       // covered pixels with a negative channel before clamping
};
layout(std430, binding = 0) buffer ExposureBuffer { Exposure exposure; };
