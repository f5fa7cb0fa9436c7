// The textures that a frame draws into: linear radiance and depth, and the picture that comes of them unless
// that goes to the window. Comes in: the kind and size of the picture. Goes out: framebuffers for passes, and
// the picture read back. Render thread only; reading waits for the GPU.
#pragma once

#include <cstdint>

#include <glm/mat4x4.hpp>

#include "runtime/frame/frame_options.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/size.hpp"

namespace lambent::frame {

// Samples a pixel of the textures that are drawn into; 0: plain textures.
std::uint32_t samplesOf(Output output);

class PictureTargets {
 public:
  PictureTargets(Output output, bool to_window) : output_(output), to_window_(to_window) {}

  // Makes the textures anew, unless they have that size.
  void resize(const spec::Size& size);
  const spec::Size& size() const { return size_; }
  // Rises when the textures are made anew.
  std::uint64_t version() const { return version_; }

  // Binds radiance and depth, cleared to `grey` without coverage and to the far end.
  void bindCleared(float grey);
  // Binds the picture, or the window.
  void bindPicture() const;

  const gpu::Texture& hdr() const { return hdr_; }
  const gpu::Texture& depth() const { return depth_; }
  // Radiance without depth, for passes that read the depth.
  const gpu::Framebuffer& hdrColor();
  // Not where it goes to the window; row 0 is the bottom.
  const gpu::Texture& picture() const { return picture_; }

  // Row 0 is the top. Linear pictures have depths, of what wrote to the depth buffer, which was seen so.
  spec::RgbaImage readLinear(const glm::mat4& clip_from_view) const;
  spec::Rgba8Image readDisplay() const;

 private:
  Output output_;
  bool to_window_;
  spec::Size size_{};
  std::uint64_t version_ = 0;
  gpu::Texture hdr_, depth_, picture_;
  gpu::Framebuffer hdr_target_, hdr_color_target_, picture_target_;
};

}  // namespace lambent::frame
