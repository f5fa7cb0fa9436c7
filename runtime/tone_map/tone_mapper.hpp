// From linear radiance to the picture that is looked at or written: meters the exposure, counts and clamps
// negative pixels, applies the tone curve and sRGB coding, or leaves values linear for EXR. Reads a colour
// texture with any number of samples a pixel; writes the framebuffer that is bound. Errors: shaders that do
// not compile.
#pragma once

#include <cstdint>
#include <optional>

#include "runtime/base/result.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/gpu/program.hpp"

namespace lambent::frame {

class ToneMapper {
 public:
  // linear: no exposure, no curve, alpha kept.
  static Result<ToneMapper> create(std::uint32_t samples, bool linear);

  // exposure_ev: stops above radiance 1 = white; none: metered from the picture. as_is: what is there are
  // colours, not light; they are coded and nothing else. Linear pictures are always so.
  void run(const gpu::Texture& hdr, std::optional<float> exposure_ev, gpu::Counters& counters,
           bool as_is = false);
  // What the last run multiplied radiance with, as Exposure of hdr_input.glsl.
  void bindExposure(GLuint binding) const { exposure_.bindStorage(binding); }

  // Of the last run; wait for the GPU.
  std::uint32_t negativePixels() const;
  float exposureEv() const;

 private:
  ToneMapper() = default;
  gpu::Program meter_, resolve_;
  gpu::Buffer exposure_;
  gpu::VertexArray no_vertices_;
};

}  // namespace lambent::frame
