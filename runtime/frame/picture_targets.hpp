// Owns the textures that a frame draws into: linear radiance and depth, and the picture that is made from
// them unless it goes elsewhere. Radiance and depth may be shared with other code. It takes the kind and size
// of the picture, and provides framebuffers for passes and the picture for reading. Render thread only;
// reading waits for the GPU.
#pragma once

#include <cstdint>

#include <glm/mat4x4.hpp>

#include "runtime/frame/frame_settings.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::frame {

// Returns the number of samples per pixel of the textures that are drawn into; 0 stands for plain textures.
std::uint32_t samplesOf(Output output);

class PictureTargets {
 public:
  PictureTargets(Output output, Destination destination) : output_(output), destination_(destination) {}

  // Makes the textures anew if their size differs.
  void resize(const spec::Size& size);
  const spec::Size& size() const { return size_; }
  // Draws into these from now on, which share their storage with other code. Both have the same size and
  // samples.
  void share(gpu::Texture hdr, gpu::Texture depth);
  // Rises when the textures are made anew.
  std::uint64_t version() const { return version_; }

  // Binds radiance and depth. Unless they are shared, radiance is cleared to `grey` with alpha 0, depth to
  // the far end.
  void bindCleared(float grey);
  // Binds the framebuffer of the picture, or the window's.
  void bindPicture() const;

  const gpu::Texture& hdr() const { return hdr_; }
  const gpu::Texture& depth() const { return depth_; }
  // Returns radiance without depth, for passes that read the depth.
  const gpu::Framebuffer& hdrColor();
  // Returns the picture, with row 0 at the bottom; empty if it goes to the window.
  const gpu::Texture& picture() const { return picture_; }

  // Return the picture, with row 0 at the top. Linear pictures have the depths of what wrote to the depth
  // buffer; clip_from_view is the projection with which they were drawn.
  spec::RgbaImage readLinear(const glm::mat4& clip_from_view) const;
  spec::Rgba8Image readDisplay() const;

 private:
  Output output_;
  Destination destination_;
  spec::Size size_{};
  std::uint64_t version_ = 0;
  gpu::Texture hdr_, depth_, picture_;
  gpu::Framebuffer hdr_target_, hdr_color_target_, picture_target_;
};

}  // namespace lambent::frame
