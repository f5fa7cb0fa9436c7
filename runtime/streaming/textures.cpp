#include "runtime/streaming/textures.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "runtime/bundle/material_fields.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/spec/rec709.hpp"

// This room compiles stb_image here only, as static functions, so that it does not collide with other copies
// in a program. It is included as a system header to suppress warnings.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_NO_LINEAR
#define STBI_NO_HDR
#include <stb/stb_image.h>

namespace lambent::streaming {

namespace {

constexpr const char* kHint = "replace the image in the scene and bake it again";

const stbi_uc* stbBytes(std::span<const std::byte> file) {
  return reinterpret_cast<const stbi_uc*>(file.data());
}

struct FreePixels {
  void operator()(stbi_uc* pixels) const { stbi_image_free(pixels); }
};

}  // namespace

Result<ImageSize> imageSize(std::span<const std::byte> file, const std::string& subject) {
  int width = 0, height = 0, channels = 0;
  if (file.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    return fail(subject, "is a file of more than 2 GiB", kHint);
  if (stbi_info_from_memory(stbBytes(file), static_cast<int>(file.size()), &width, &height, &channels) == 0)
    return fail(subject, fmt::format("is not a PNG or JPEG that can be read ({})", stbi_failure_reason()),
                kHint);
  if (width <= 0 || height <= 0) return fail(subject, "has no texels", kHint);
  const ImageSize size{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
  if (size.width > kMaxImageSide || size.height > kMaxImageSide)
    return fail(subject,
                fmt::format("has {} x {} texels, more than {} on a side", width, height, kMaxImageSide),
                kHint);
  return size;
}

Result<std::vector<std::uint8_t>> decodeRgba(std::span<const std::byte> file, const std::string& subject) {
  const auto size = imageSize(file, subject);
  if (!size) return failAgain(size.error());
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<stbi_uc, FreePixels> pixels(stbi_load_from_memory(
      stbBytes(file), static_cast<int>(file.size()), &width, &height, &channels, STBI_rgb_alpha));
  if (!pixels) return fail(subject, fmt::format("is damaged ({})", stbi_failure_reason()), kHint);
  return std::vector<std::uint8_t>(pixels.get(), pixels.get() + size->rgbaBytes());
}

namespace {

// Codes by sRGB (IEC 61966-2-1).
float toSrgb(float light) {
  return light <= 0.0031308f ? 12.92f * light : 1.055f * std::pow(light, 1.0f / 2.4f) - 0.055f;
}

std::uint8_t byteOf(float value) {
  return static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(value, 0.0f, 1.0f)));
}

// The part of a row of `count` texels that lies in texel `at` of a row of `fewer` texels: the index of the
// first one, and weights that sum to 1.
struct Span {
  std::uint32_t first = 0;
  std::vector<float> weights;
};
Span spanOf(std::uint32_t at, std::uint32_t fewer, std::uint32_t count) {
  const double width = double{1} * count / fewer, begin = width * at, end = begin + width;
  Span span{.first = static_cast<std::uint32_t>(begin), .weights = {}};
  for (std::uint32_t i = span.first; i < count && i < end; ++i)
    span.weights.push_back(
        static_cast<float>((std::min(end, i + 1.0) - std::max(begin, double{1} * i)) / width));
  return span;
}

}  // namespace

ImageSize sizeAt(const ImageSize& size, std::uint32_t level) {
  return {std::max(size.width >> level, 1u), std::max(size.height >> level, 1u)};
}

std::uint32_t levelCount(const ImageSize& size) {
  return static_cast<std::uint32_t>(std::bit_width(std::max(size.width, size.height)));
}

std::uint64_t textureBytes(const ImageSize& size) {
  return std::uint64_t{size.rgbaBytes()} * 4 / 3;
}

std::uint32_t coarseLevel(const ImageSize& size) {
  std::uint32_t level = 0;
  while (std::max(size.width, size.height) >> level > kCoarseSide) ++level;
  return level;
}

std::vector<std::uint8_t> shrink(std::span<const std::uint8_t> rgba, const ImageSize& size,
                                 std::uint32_t level, bool color) {
  assert(rgba.size() == size.rgbaBytes());
  const ImageSize small = sizeAt(size, level);
  std::array<float, 256> codes{}, light{};  // values of codes as numbers and as colours
  for (std::size_t code = 0; code < 256; ++code) {
    codes[code] = static_cast<float>(code) / 255.0f;
    light[code] = color ? spec::linearFromSrgb(codes[code]) : codes[code];
  }
  std::vector<Span> across;
  for (std::uint32_t x = 0; x < small.width; ++x) across.push_back(spanOf(x, small.width, size.width));
  std::vector<std::uint8_t> result;
  result.reserve(small.rgbaBytes());
  std::vector<std::array<float, 4>> row(small.width);
  for (std::uint32_t y = 0; y < small.height; ++y) {
    std::ranges::fill(row, std::array<float, 4>{});
    const Span down = spanOf(y, small.height, size.height);
    for (std::uint32_t j = 0; j < down.weights.size(); ++j) {
      const std::uint8_t* const from = rgba.data() + std::size_t{4} * size.width * (down.first + j);
      for (std::uint32_t x = 0; x < small.width; ++x)
        for (std::uint32_t i = 0; i < across[x].weights.size(); ++i) {
          const float weight = down.weights[j] * across[x].weights[i];
          const std::uint8_t* const texel = from + std::size_t{4} * (across[x].first + i);
          for (std::size_t c = 0; c < 3; ++c) row[x][c] += weight * light[texel[c]];
          row[x][3] += weight * codes[texel[3]];
        }
    }
    for (const std::array<float, 4>& texel : row) {
      for (std::size_t c = 0; c < 3; ++c) result.push_back(byteOf(color ? toSrgb(texel[c]) : texel[c]));
      result.push_back(byteOf(texel[3]));
    }
  }
  return result;
}

namespace {

std::vector<bool> reflectingMaterials(const bundle::Description& description) {
  std::vector<bool> glossy(description.materials.size(), false);
  for (const bundle::Draw& draw : description.draws) {
    const std::int32_t material = description.meshes[draw.mesh].primitives[draw.primitive].material;
    if (material >= 0 && (draw.glossy() || bundle::isLayered(description, draw)))
      glossy[static_cast<std::size_t>(material)] = true;
  }
  return glossy;
}

}  // namespace

std::vector<ImageUse> imageUses(const bundle::Description& description) {
  std::vector<ImageUse> uses(description.images.size());
  const auto read = [&](const gltf::TextureRef& reference, bool ImageUse::*as) {
    if (reference.texture < 0) return;
    const std::int32_t image = description.textures[static_cast<std::size_t>(reference.texture)].image;
    if (image >= 0) uses[static_cast<std::size_t>(image)].*as = true;
  };
  const std::vector<bool> glossy = reflectingMaterials(description);
  for (std::size_t i = 0; i < description.materials.size(); ++i) {
    const gltf::Material& material = description.materials[i];
    gltf::forEachMaterialTexture([&](const auto& field) {
      if (field.part == gltf::MaterialPart::Reflection && !glossy[i]) return;
      read(material.*field.member, field.color_texture ? &ImageUse::color : &ImageUse::linear);
    });
  }
  for (ImageUse& use : uses) use.color |= !use.linear;
  return uses;
}

std::vector<std::uint32_t> imagesOf(const bundle::Description& description, std::int32_t material) {
  std::vector<std::uint32_t> images;
  if (material < 0) return images;
  const gltf::Material& of = description.materials[static_cast<std::size_t>(material)];
  gltf::forEachMaterialTexture([&](const auto& field) {
    const gltf::TextureRef& reference = of.*field.member;
    if (reference.texture < 0) return;
    const std::int32_t image = description.textures[static_cast<std::size_t>(reference.texture)].image;
    if (image >= 0 && std::ranges::find(images, static_cast<std::uint32_t>(image)) == images.end())
      images.push_back(static_cast<std::uint32_t>(image));
  });
  return images;
}

BrdfTexels packBrdf(const bundle::BrdfTable& table) {
  const sh::ZonalFactors factors(static_cast<int>(table.order), table.isotropic());
  const auto count = static_cast<std::uint32_t>(factors.weightCount());
  const std::uint32_t stride = table.lobes == 2 ? 2 : 4;
  BrdfTexels texels;
  texels.per_node = (stride * count + 3) / 4;
  texels.width = table.angles;
  texels.height = table.isotropic() ? table.roughnesses : table.azimuths;
  texels.layers = texels.per_node * (table.isotropic() ? 1 : table.strengths * table.roughnesses);
  texels.values.assign(std::size_t{texels.width} * texels.height * texels.layers, glm::vec4(0.0f));
  std::vector<float> weights(count);
  const float* node = table.values.data();
  for (std::uint32_t strength = 0; strength < table.strengths; ++strength)
    for (std::uint32_t roughness = 0; roughness < table.roughnesses; ++roughness)
      for (std::uint32_t azimuth = 0; azimuth < table.azimuths; ++azimuth)
        for (std::uint32_t angle = 0; angle < table.angles; ++angle, node += table.nodeValues()) {
          const std::uint32_t down = table.isotropic() ? roughness : azimuth;
          const std::uint32_t layer =
              table.isotropic() ? 0 : (strength * table.roughnesses + roughness) * texels.per_node;
          for (std::uint32_t lobe = 0; lobe < table.lobes; ++lobe) {
            factors.factor({node + lobe * table.coefficients(), table.coefficients()}, weights);
            for (std::uint32_t p = 0; p < count; ++p) {
              const std::uint32_t component = stride * p + lobe;
              const std::size_t texel =
                  (std::size_t{layer + component / 4} * texels.height + down) * texels.width + angle;
              texels.values[texel][static_cast<int>(component % 4)] = weights[p];
            }
          }
        }
  return texels;
}

Result<BrdfTexture> makeBrdfTexture(const bundle::BrdfTable& table, const BrdfTexels& texels,
                                    const std::string& subject) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &most);
  if (texels.layers > static_cast<std::uint32_t>(most))
    return fail(subject, fmt::format("takes {} layers of a texture; this device has {}", texels.layers, most),
                "bake with fewer nodes of roughness or anisotropy");
  BrdfTexture made{
      .texture = gpu::Texture(
          "brdf",
          {.format = GL_RGBA32F, .width = texels.width, .height = texels.height, .layers = texels.layers}),
      .order = table.order,
      .roughnesses = table.roughnesses,
      .strengths = table.strengths};
  glTextureSubImage3D(made.texture.id(), 0, 0, 0, 0, static_cast<GLsizei>(texels.width),
                      static_cast<GLsizei>(texels.height), static_cast<GLsizei>(texels.layers), GL_RGBA,
                      GL_FLOAT, texels.values.data());
  made.texture.interpolate();
  return made;
}

}  // namespace lambent::streaming
