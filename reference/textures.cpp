#include "reference/textures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>

#include "runtime/bundle/material_fields.hpp"

namespace lambent::baker::reference {

namespace {

// These are glTF's sampler constants.
constexpr std::uint32_t kClampToEdge = 33071, kMirroredRepeat = 33648, kNearest = 9728;

// Tabulates the sRGB decoding of IEC 61966-2-1.
std::array<float, 256> srgbTable() {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const float coded = static_cast<float>(i) / 255.0f;
    table[i] = coded <= 0.04045f ? coded / 12.92f : std::pow((coded + 0.055f) / 1.055f, 2.4f);
  }
  return table;
}
const std::array<float, 256> kLinearFromSrgb = srgbTable();

std::size_t wrapped(double at, std::uint32_t size, std::uint32_t mode) {
  const double n = size;
  if (mode == kClampToEdge) return static_cast<std::size_t>(std::clamp(at, 0.0, n - 1.0));
  const double period = mode == kMirroredRepeat ? 2.0 * n : n;
  double texel = at - period * std::floor(at / period);
  if (texel >= n) texel = period - 1.0 - texel;
  return static_cast<std::size_t>(std::clamp(texel, 0.0, n - 1.0));
}

}  // namespace

Result<Textures> Textures::load(const Scene& scene) {
  Textures out;
  out.textures_ = scene.textures;
  out.images_.resize(scene.images.size());
  std::optional<Error> error;
  const auto load = [&](const gltf::TextureRef& ref) {
    if (ref.texture < 0 || error) return;
    const std::int32_t image = scene.textures[static_cast<std::size_t>(ref.texture)].image;
    if (image < 0 || out.images_[static_cast<std::size_t>(image)]) return;
    auto decoded = decodeImage(scene.images[static_cast<std::size_t>(image)]);
    if (decoded)
      out.images_[static_cast<std::size_t>(image)] = std::move(*decoded);
    else
      error = std::move(decoded.error());
  };
  for (const gltf::Material& material : scene.materials)
    gltf::forEachMaterialTexture([&](const auto& field) { load(material.*field.member); });
  if (error) return failAgain(std::move(*error));
  return out;
}

template <typename Decode>
glm::vec4 Textures::lookUp(const gltf::TextureRef& ref, const glm::vec2& uv, const Decode& decode) const {
  if (ref.texture < 0) return glm::vec4(1.0f);
  const gltf::Texture& texture = textures_[static_cast<std::size_t>(ref.texture)];
  if (texture.image < 0 || !images_[static_cast<std::size_t>(texture.image)]) return glm::vec4(1.0f);
  const DecodedImage& image = *images_[static_cast<std::size_t>(texture.image)];
  const glm::vec2 turned = ref.apply(uv);
  const bool nearest = texture.sampler.mag_filter == kNearest;
  const double x = std::clamp(double{turned.x} * image.width, -1e12, 1e12) - (nearest ? 0.0 : 0.5);
  const double y = std::clamp(double{turned.y} * image.height, -1e12, 1e12) - (nearest ? 0.0 : 0.5);
  const double left = std::floor(x), top = std::floor(y);
  const auto texel = [&](double column, double row) {
    const std::size_t at = wrapped(row, image.height, texture.sampler.wrap_t) * image.width +
                           wrapped(column, image.width, texture.sampler.wrap_s);
    return decode(&image.rgba[4 * at]);
  };
  if (nearest) return texel(left, top);
  const auto fx = static_cast<float>(x - left), fy = static_cast<float>(y - top);
  return glm::mix(glm::mix(texel(left, top), texel(left + 1.0, top), fx),
                  glm::mix(texel(left, top + 1.0), texel(left + 1.0, top + 1.0), fx), fy);
}

glm::vec4 Textures::color(const gltf::TextureRef& ref, const glm::vec2& uv) const {
  return lookUp(ref, uv, [](const std::uint8_t* p) {
    return glm::vec4(kLinearFromSrgb[p[0]], kLinearFromSrgb[p[1]], kLinearFromSrgb[p[2]],
                     static_cast<float>(p[3]) / 255.0f);
  });
}

glm::vec4 Textures::data(const gltf::TextureRef& ref, const glm::vec2& uv) const {
  return lookUp(ref, uv, [](const std::uint8_t* p) { return glm::vec4(p[0], p[1], p[2], p[3]) / 255.0f; });
}

}  // namespace lambent::baker::reference
