// Turns linear radiance into the picture that is shown or written: it meters the exposure, counts and clamps
// negative pixels, and applies the tone curve and sRGB coding, or leaves values linear for EXR. It reads a
// colour texture with any number of samples per pixel and writes the bound framebuffer. Render thread only.
// Fails if a shader does not compile.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/gpu/program.hpp"

namespace lambent::frame {

class ToneMapper {
 public:
  // `linear` pictures have no exposure and no curve, and keep alpha.
  ToneMapper(std::uint32_t samples, bool linear);

  // exposure_ev is in stops above "radiance 1 is white"; without it, exposure is metered from the picture. If
  // as_is is set, the texture holds colours instead of light, which are only sRGB coded. A linear picture
  // ignores both.
  Result<void> run(const gpu::Texture& hdr, std::optional<float> exposure_ev, gpu::Counters& counters,
                   bool as_is = false);
  // Binds the factor on radiance of the last run, as the block Exposure of hdr_input.glsl.
  void bindExposure(GLuint binding) const { exposure_.bindStorage(binding); }

  // Return values of the last run; both wait for the GPU.
  std::uint32_t negativePixels() const;
  float exposureEv() const;

 private:
  gpu::Programs kernels_;
  std::vector<gpu::Define> defines_;
  gpu::Buffer exposure_;
  gpu::VertexArray no_vertices_;
};

}  // namespace lambent::frame
