#include "baker/transport/surface_colors.hpp"

#include <algorithm>
#include <utility>

#include <glm/common.hpp>
#include <glm/exponential.hpp>

#include "baker/plan/smooth_dielectrics.hpp"

namespace lambent::baker {

namespace {

float largestOf(const glm::vec3& color) {
  return std::max({color.r, color.g, color.b});
}

bool isGrey(glm::vec3 color) {
  return color.r == color.g && color.g == color.b;
}

// Returns whether every texel, as the runtime sees it, is grey.
bool isGrey(const DecodedImage& image) {
  for (std::size_t i = 0; i + 3 < image.rgba.size(); i += 4)
    if (image.rgba[i] != image.rgba[i + 1] || image.rgba[i] != image.rgba[i + 2]) return false;
  return true;
}

}  // namespace

Result<SurfaceColors> SurfaceColors::load(const Scene& scene, const GroupGeometry& geometry,
                                          std::span<const PlannedLight> lights, DecodedImages& images) {
  SurfaceColors colors;
  colors.geometry_ = &geometry;
  colors.surface_of_.resize(geometry.triangles.size());
  const auto loadTexture = [&](const gltf::TextureRef& ref, Texture& texture) -> Result<void> {
    auto image = images.ofTexture(ref.texture);
    if (!image) return failAgain(image.error());
    if (*image) texture = {std::move(*image), scene.textures[static_cast<std::size_t>(ref.texture)].sampler};
    return {};
  };

  for (const DrawGeometry& draw : geometry.draws) {
    const gltf::Material material =
        draw.material < 0 ? gltf::Material{} : scene.materials[static_cast<std::size_t>(draw.material)];
    Surface surface{
        .first_triangle = draw.first_triangle,
        .base_color = material.unlit ? glm::vec3(0.0f) : glm::vec3(material.base_color),
        .layer = draw.layered ? meanSpecularAlbedo(material) : glm::vec3(0.0f),
        .base_texture = {},
        .emissive_texture = {},
        .transmission_texture = {},
        .light = kNoLight,
        .colored_vertices = false,
        .glossy = draw.kind == SampleKind::Glossy,
        .base_alpha = material.base_color.w,
        .alpha_cutoff = material.alpha_mode == gltf::AlphaMode::Mask ? material.alpha_cutoff : 0.0f,
        .alpha_mode = material.alpha_mode,
        .transmission = material.transmits() ? (1.0f - material.metallic) * material.transmission : 0.0f,
        .pane_reflectance = material.transmits() ? largestOf(reflectedStraightOn(material)) : 0.0f,
        .thickness_m = material.thickness_m,
        .attenuation_distance_m = material.attenuation_distance_m,
        .attenuation_color = glm::min(material.attenuation_color, glm::vec3(1.0f))};
    const auto first = geometry.colors.begin() + draw.first_vertex;
    surface.colored_vertices = std::any_of(
        first, first + draw.vertex_count, [](const glm::vec4& c) { return glm::vec3(c) != glm::vec3(1.0f); });
    auto loaded = loadTexture(material.base_color_texture, surface.base_texture);
    if (loaded && surface.transmission > 0.0f)
      loaded = loadTexture(material.transmission_texture, surface.transmission_texture);
    for (std::uint32_t k = 0; k < lights.size(); ++k)
      if (lights[k].kind == PlannedLight::Kind::Material &&
          static_cast<std::int32_t>(lights[k].index) == draw.material)
        surface.light = k;
    if (loaded && surface.light != kNoLight)
      loaded = loadTexture(material.emissive_texture, surface.emissive_texture);
    if (!loaded) return failAgain(loaded.error());
    if (surface.emissive_texture.image && !isGrey(*surface.emissive_texture.image))
      colors.grey_emission_ = false;
    const bool grey_vertices = std::all_of(first, first + draw.vertex_count,
                                           [](const glm::vec4& c) { return isGrey(glm::vec3(c)); });
    const bool grey_base = isGrey(surface.base_color) && grey_vertices &&
                           (surface.base_color == glm::vec3(0.0f) || !surface.base_texture.image ||
                            isGrey(*surface.base_texture.image));
    if (!grey_base || !isGrey(surface.layer)) colors.grey_ = false;
    if (surface.transmission > 0.0f && !(grey_base && isGrey(surface.attenuation_color)))
      colors.grey_panes_ = false;
    std::fill_n(colors.surface_of_.begin() + draw.first_triangle, draw.triangle_count,
                static_cast<std::uint32_t>(colors.surfaces_.size()));
    colors.surfaces_.push_back(std::move(surface));
  }
  colors.grey_emission_ = colors.grey_emission_ && colors.grey_panes_;
  colors.grey_ = colors.grey_ && colors.grey_emission_;
  return colors;
}

glm::vec2 SurfaceColors::at(const std::vector<glm::vec2>& texcoords, std::uint32_t triangle, float u,
                            float v) const {
  const glm::uvec3 t = geometry_->triangles[triangle];
  return (1.0f - u - v) * texcoords[t.x] + u * texcoords[t.y] + v * texcoords[t.z];
}

glm::vec4 SurfaceColors::lookUp(const Texture& texture, const std::vector<glm::vec2>& texcoords,
                                std::uint32_t triangle, float u, float v) const {
  if (!texture.image) return glm::vec4(1.0f);
  return sampleImage(*texture.image, texture.sampler, at(texcoords, triangle, u, v));
}

glm::vec4 SurfaceColors::vertexColor(std::uint32_t triangle, float u, float v) const {
  const glm::uvec3 t = geometry_->triangles[triangle];
  const auto& c = geometry_->colors;
  return (1.0f - u - v) * c[t.x] + u * c[t.y] + v * c[t.z];
}

glm::vec3 SurfaceColors::baseColor(const Surface& surface, std::uint32_t triangle, float u, float v) const {
  glm::vec3 color = surface.base_color;
  if (color == glm::vec3(0.0f)) return color;
  if (const Texture& base = surface.base_texture; base.image)
    color *= glm::vec3(nearestTexel(*base.image, base.sampler, at(geometry_->texcoords, triangle, u, v)));
  if (surface.colored_vertices) color *= glm::vec3(vertexColor(triangle, u, v));
  return glm::clamp(color, 0.0f, 1.0f);
}

glm::vec3 SurfaceColors::albedo(std::uint32_t triangle, float u, float v) const {
  const Surface& surface = surfaceOf(triangle);
  const float kept = 1.0f - transmission(surface, triangle, u, v);
  return albedoUnderLayer(kept * baseColor(surface, triangle, u, v), surface.layer);
}

float SurfaceColors::transmission(const Surface& surface, std::uint32_t triangle, float u, float v) const {
  if (surface.transmission == 0.0f || !surface.transmission_texture.image) return surface.transmission;
  const Texture& texture = surface.transmission_texture;
  return surface.transmission *
         nearestData(*texture.image, texture.sampler, at(geometry_->pane_texcoords, triangle, u, v)).x;
}

glm::vec3 SurfaceColors::passed(std::uint32_t triangle, float u, float v) const {
  const Surface& surface = surfaceOf(triangle);
  return (1.0f - surface.pane_reflectance) * transmission(surface, triangle, u, v) *
         baseColor(surface, triangle, u, v);
}

glm::vec3 SurfaceColors::passedInside(std::uint32_t triangle, float length_m) const {
  const Surface& surface = surfaceOf(triangle);
  if (surface.thickness_m == 0.0f || surface.attenuation_distance_m == 0.0f) return glm::vec3(1.0f);
  return glm::pow(surface.attenuation_color, glm::vec3(length_m / surface.attenuation_distance_m));
}

float SurfaceColors::alpha(const Surface& surface, std::uint32_t triangle, float u, float v) const {
  return surface.base_alpha * lookUp(surface.base_texture, geometry_->texcoords, triangle, u, v).w *
         vertexColor(triangle, u, v).w;
}

float SurfaceColors::coverage(std::uint32_t triangle, float u, float v) const {
  const Surface& surface = surfaceOf(triangle);
  const glm::vec3 through = passed(triangle, u, v);
  const float kept = 1.0f - (through.r + through.g + through.b) / 3.0f;
  if (surface.alpha_mode == gltf::AlphaMode::Opaque) return kept;
  const float a = alpha(surface, triangle, u, v);
  if (surface.alpha_mode == gltf::AlphaMode::Blend) return glm::clamp(a, 0.0f, 1.0f);
  return a >= surface.alpha_cutoff ? kept : 0.0f;
}

glm::vec3 SurfaceColors::emission(std::uint32_t triangle, float u, float v) const {
  const Surface& surface = surfaceOf(triangle);
  if (surface.alpha_cutoff > 0.0f && alpha(surface, triangle, u, v) < surface.alpha_cutoff)
    return glm::vec3(0.0f);
  return glm::vec3(lookUp(surface.emissive_texture, geometry_->emissive_texcoords, triangle, u, v));
}

}  // namespace lambent::baker
