#include "runtime/frame/picture_targets.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace lambent::frame {

namespace {

constexpr float kFar = 1.0f;

// Reverses the order of rows, because the first row of GL's pictures is at the bottom.
template <typename Texel>
std::vector<Texel> flipped(const std::vector<Texel>& texels, std::size_t row_length) {
  std::vector<Texel> result(texels.size());
  for (std::size_t begin = 0; begin < texels.size(); begin += row_length)
    std::copy_n(texels.begin() + static_cast<std::ptrdiff_t>(begin), row_length,
                result.end() - static_cast<std::ptrdiff_t>(begin + row_length));
  return result;
}

// Converts depths to distances along the view axis. All projections map z to (a z + b) / (c z + d).
std::vector<float> linearDepths(std::vector<float> window_depths, const glm::mat4& clip_from_view) {
  const double a = clip_from_view[2][2], b = clip_from_view[3][2], c = clip_from_view[2][3],
               d = clip_from_view[3][3];
  for (float& depth : window_depths) {
    const double clip_z = 2.0 * double{depth} - 1.0;
    depth = depth < kFar ? static_cast<float>((b - d * clip_z) / (a - c * clip_z))
                         : std::numeric_limits<float>::infinity();
  }
  return window_depths;
}

}  // namespace

std::uint32_t samplesOf(Output output) {
  constexpr std::uint32_t kDisplaySamples = 4;  // OpenGL 4.5 promises four
  return output == Output::Display ? kDisplaySamples : 0;
}

void PictureTargets::resize(const spec::Size& size) {
  if (destination_ == Destination::Shared || (hdr_ && size == size_)) return;
  size_ = size;
  ++version_;
  const std::uint32_t samples = samplesOf(output_);
  const bool linear = output_ == Output::Linear;
  hdr_ = gpu::Texture("hdr", {.format = linear ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA16F},
                              .width = size.width,
                              .height = size.height,
                              .samples = samples});
  depth_ = gpu::Texture(
      "depth",
      {.format = GL_DEPTH_COMPONENT32F, .width = size.width, .height = size.height, .samples = samples});
  hdr_target_ = gpu::Framebuffer("hdr", hdr_, &depth_);
  hdr_color_target_ = {};
  if (destination_ == Destination::Window) return;
  picture_ = gpu::Texture(
      "picture",
      {.format = linear ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA8}, .width = size.width, .height = size.height});
  picture_target_ = gpu::Framebuffer("picture", picture_, nullptr);
}

void PictureTargets::share(gpu::Texture hdr, gpu::Texture depth) {
  size_ = {.width = hdr.desc().width, .height = hdr.desc().height};
  ++version_;
  hdr_ = std::move(hdr);
  depth_ = std::move(depth);
  hdr_target_ = gpu::Framebuffer("hdr", hdr_, &depth_);
  hdr_color_target_ = {};
}

void PictureTargets::bindCleared(float grey) {
  glBindFramebuffer(GL_FRAMEBUFFER, hdr_target_.id());
  glViewport(0, 0, static_cast<GLsizei>(size_.width), static_cast<GLsizei>(size_.height));
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  if (destination_ == Destination::Shared) return;
  const float background[] = {grey, grey, grey, 0.0f};
  glClearNamedFramebufferfv(hdr_target_.id(), GL_COLOR, 0, background);
  glClearNamedFramebufferfv(hdr_target_.id(), GL_DEPTH, 0, &kFar);
}

void PictureTargets::bindPicture() const {
  glBindFramebuffer(GL_FRAMEBUFFER, destination_ == Destination::Window ? 0 : picture_target_.id());
}

const gpu::Framebuffer& PictureTargets::hdrColor() {
  if (!hdr_color_target_) hdr_color_target_ = gpu::Framebuffer("hdr color", hdr_, nullptr);
  return hdr_color_target_;
}

spec::RgbaImage PictureTargets::readLinear(const glm::mat4& clip_from_view) const {
  std::vector<glm::vec4> texels(std::size_t{size_.width} * size_.height);
  glGetTextureImage(picture_.id(), 0, GL_RGBA, GL_FLOAT,
                    static_cast<GLsizei>(texels.size() * sizeof(glm::vec4)), texels.data());
  spec::RgbaImage image{.width = size_.width, .height = size_.height, .texels = flipped(texels, size_.width)};
  if (output_ != Output::Linear) return image;  // the depth buffer has several samples per pixel
  std::vector<float> depths(texels.size());
  glGetTextureImage(depth_.id(), 0, GL_DEPTH_COMPONENT, GL_FLOAT,
                    static_cast<GLsizei>(depths.size() * sizeof(float)), depths.data());
  image.depths = linearDepths(flipped(depths, size_.width), clip_from_view);
  return image;
}

spec::Rgba8Image PictureTargets::readDisplay() const {
  std::vector<std::uint8_t> texels(std::size_t{size_.width} * size_.height * 4);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureImage(picture_.id(), 0, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(texels.size()),
                    texels.data());
  return {
      .width = size_.width, .height = size_.height, .texels = flipped(texels, std::size_t{size_.width} * 4)};
}

}  // namespace lambent::frame
