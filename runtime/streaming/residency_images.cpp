// Uploads textures of surfaces and drops their finest levels.
#include <algorithm>

#include <fmt/format.h>

#include "runtime/streaming/images.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::streaming {

namespace {

std::uint64_t bytesOfTexture(const gpu::Texture& texture) {
  return texture ? textureBytes({texture.desc().width, texture.desc().height}) : 0;
}

// Returns a copy of the texture from its level `from` on.
gpu::Texture coarser(const gpu::Texture& texture, std::uint32_t from, const std::string& label) {
  const gpu::TextureDesc& desc = texture.desc();
  const ImageSize size = sizeAt({desc.width, desc.height}, from);
  gpu::Texture result(
      label,
      {.format = desc.format, .width = size.width, .height = size.height, .levels = desc.levels - from});
  for (std::uint32_t level = 0; level < desc.levels - from; ++level) {
    const ImageSize here = sizeAt(size, level);
    glCopyImageSubData(texture.id(), GL_TEXTURE_2D, static_cast<GLint>(from + level), 0, 0, 0, result.id(),
                       GL_TEXTURE_2D, static_cast<GLint>(level), 0, 0, 0, static_cast<GLsizei>(here.width),
                       static_cast<GLsizei>(here.height), 1);
  }
  return result;
}

void writeRows(const gpu::Texture& texture, const std::vector<std::uint8_t>& rgba, std::uint32_t first,
               std::uint32_t count) {
  const std::uint32_t width = texture.desc().width;
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage2D(texture.id(), 0, 0, static_cast<GLint>(first), static_cast<GLsizei>(width),
                      static_cast<GLsizei>(count), GL_RGBA, GL_UNSIGNED_BYTE,
                      rgba.data() + std::size_t{4} * width * first);
}

std::string labelOf(std::uint32_t image) {
  return fmt::format("image {}", image);
}

}  // namespace

Residency::ImageUpload Residency::begin(const ResidentBundle& owner, const ImageChunk& item) {
  const ImageUse use = owner.image_uses[item.image];
  const ImageSize size{item.width, item.height};
  const auto make = [&](const std::string& label, GLenum format) {
    return gpu::Texture(
        label, {.format = format, .width = size.width, .height = size.height, .levels = levelCount(size)});
  };
  ImageUpload upload;
  if (use.color) upload.color = make(labelOf(item.image), GL_SRGB8_ALPHA8);
  if (use.linear) upload.linear = make(labelOf(item.image) + " linear", GL_RGBA8);
  return upload;
}

void Residency::write(ImageUpload& upload, const ImageChunk& item, std::uint32_t rows) {
  const auto& linear = item.linear.empty() ? item.rgba : item.linear;
  if (upload.color) writeRows(upload.color, item.rgba, upload.rows_done, rows);
  if (upload.linear) writeRows(upload.linear, linear, upload.rows_done, rows);
  upload.rows_done += rows;
}

void Residency::finish(ResidentBundle& owner, ImageUpload upload, std::uint32_t image) {
  const auto take = [&](gpu::Texture& made, gpu::Texture& shown) {
    if (!made) return;
    glGenerateTextureMipmap(made.id());
    owner.texture_bytes += bytesOfTexture(made) - bytesOfTexture(shown);
    shown = std::move(made);
  };
  take(upload.color, owner.images[image]);
  take(upload.linear, owner.linear_images[image]);
}

Result<void> Residency::put(At at, const ImageChunk& item) {
  ImageUpload upload = begin(at.bundle, item);
  write(upload, item, item.height);
  finish(at.bundle, std::move(upload), item.image);
  return {};
}

std::uint64_t Residency::proceed(ImageUpload& upload, std::uint64_t max_bytes) {
  const ImageChunk& item = upload.item;
  const std::uint64_t bytes = (item.rgba.size() + item.linear.size()) / item.height;
  const std::uint32_t left = item.height - upload.rows_done;
  const auto rows = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(max_bytes / bytes, 1, left));
  write(upload, item, rows);
  return rows * bytes;
}

void Residency::dropLevels(std::uint32_t bundle, std::uint32_t image, std::uint32_t levels) {
  ResidentBundle& owner = tables_.bundles[bundle];
  for (gpu::Texture* texture : {&owner.images[image], &owner.linear_images[image]}) {
    if (!*texture || texture->desc().levels <= levels) continue;
    ++version_;
    gpu::Texture rest = coarser(*texture, texture->desc().levels - levels, labelOf(image));
    owner.texture_bytes -= bytesOfTexture(*texture) - bytesOfTexture(rest);
    *texture = std::move(rest);
  }
}

std::uint64_t Residency::comingBytes() const {
  std::uint64_t bytes = 0;
  for (const auto& [bundle, coming] : coming_)
    if (const auto* upload = std::get_if<ImageUpload>(&coming))
      bytes += bytesOfTexture(upload->color) + bytesOfTexture(upload->linear);
  return bytes;
}

}  // namespace lambent::streaming
