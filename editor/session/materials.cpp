#include "editor/session/materials.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "editor/session/session.hpp"
#include "runtime/scene/materials.hpp"

namespace lambent::editor {

std::vector<ecs::Entity> materialsOf(const Session& session, ecs::Entity object) {
  const ecs::Registry& registry = session.document.registry();
  std::vector<ecs::Entity> found;
  for (const auto [draw, item] : registry.view<const scene::DrawItem>()) {
    if (draw != object && item.node != object && !isBelow(registry, item.node, object)) continue;
    if (item.material < 0) continue;
    const ecs::Entity material =
        session.stage.world().instance(item.bundle).materials[static_cast<std::size_t>(item.material)];
    if (std::ranges::find(found, material) == found.end()) found.push_back(material);
  }
  return found;
}

std::vector<std::pair<std::int32_t, std::string>> measuredBrdfs(const Session& session,
                                                                const scene::MaterialComponent& material) {
  std::vector<std::pair<std::int32_t, std::string>> found;
  const auto& tables = session.stage.world().description(material.bundle).brdf_tables;
  for (std::size_t i = 0; i < tables.size(); ++i)
    if (tables[i].family == bundle::BrdfFamily::Measured)
      found.emplace_back(static_cast<std::int32_t>(i), tables[i].name);
  return found;
}

PrimitiveFacts factsOf(const Session& session, const scene::DrawItem& draw) {
  const bundle::Description& description = session.stage.world().description(draw.bundle);
  const bundle::Mesh& mesh = description.meshes[draw.mesh];
  const bundle::Primitive& primitive = mesh.primitives[draw.primitive];
  const transfer::Form form = description.draws[draw.draw].form();
  return {mesh.name,
          form == transfer::Form::Matrix         ? "glossy, per pixel"
          : form == transfer::Form::NormalMapped ? "diffuse, per pixel by its normal map"
                                                 : "diffuse, at its vertices",
          primitive.vertex_count, primitive.index_count / 3};
}

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
const glm::vec3 kToLamp = glm::normalize(glm::vec3(-0.5f, 0.7f, 0.6f));
constexpr float kLampIrradiance = 2.2f;
constexpr glm::vec3 kZenith(0.75f, 0.85f, 1.0f), kNadir(0.16f, 0.15f, 0.14f);

glm::vec3 sky(const glm::vec3& direction, float roughness) {
  const float sharpness = glm::mix(4.0f, 1.0f, roughness);  // the horizon is blurred by rough surfaces
  return glm::mix(kNadir, kZenith, glm::clamp(0.5f + 0.5f * sharpness * direction.y, 0.0f, 1.0f));
}

// Returns the GGX lobe times the cosine, with the height-correlated visibility term of a smooth surface left
// at 1/4, which a thumbnail does not show.
float ggx(float n_h, float roughness) {
  const float alpha = std::max(roughness * roughness, 2e-3f), alpha2 = alpha * alpha;
  const float base = n_h * n_h * (alpha2 - 1.0f) + 1.0f;
  return 0.25f * alpha2 / (kPi * base * base);
}

glm::vec3 shade(const gltf::MaterialFactors& m, const glm::vec3& normal) {
  const glm::vec3 to_eye(0.0f, 0.0f, 1.0f);
  const float root = m.ior > 0.0f ? (m.ior - 1.0f) / (m.ior + 1.0f) : 1.0f;
  const glm::vec3 dielectric = glm::min(root * root * m.specular_color, glm::vec3(1.0f)) * m.specular;
  const glm::vec3 f0 = glm::mix(dielectric, m.base_color, m.metallic);
  const float grazing = std::pow(1.0f - std::max(normal.z, 0.0f), 5.0f) * (1.0f - m.roughness);
  const glm::vec3 fresnel = f0 + (glm::max(f0, glm::vec3(m.specular)) - f0) * grazing;
  const glm::vec3 diffuse = (1.0f - m.metallic) * m.base_color * (1.0f - fresnel);
  const float n_l = std::max(glm::dot(normal, kToLamp), 0.0f);
  const float n_h = std::max(glm::dot(normal, glm::normalize(kToLamp + to_eye)), 0.0f);
  const glm::vec3 mirrored = glm::reflect(-to_eye, normal);
  return diffuse * (kLampIrradiance / kPi * n_l + 0.6f * sky(normal, 1.0f)) +
         fresnel *
             (kLampIrradiance * n_l * std::min(ggx(n_h, m.roughness), 40.0f) + sky(mirrored, m.roughness)) +
         m.emission_strength * m.emission;
}

std::uint8_t byteOf(float linear) {
  const float shown = std::pow(glm::clamp(linear, 0.0f, 1.0f), 1.0f / 2.2f);
  return static_cast<std::uint8_t>(std::lround(255.0f * shown));
}

}  // namespace

spec::Rgba8Image previewOf(const gltf::MaterialFactors& material, std::uint32_t size) {
  spec::Rgba8Image image{size, size, std::vector<std::uint8_t>(std::size_t{size} * size * 4, 0)};
  const float half = 0.5f * static_cast<float>(size);
  for (std::uint32_t y = 0; y < size; ++y)
    for (std::uint32_t x = 0; x < size; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / half - 1.0f,
                  v = 1.0f - (static_cast<float>(y) + 0.5f) / half;
      const float r2 = u * u + v * v;
      // The rim fades over a pixel.
      const float cover = glm::clamp(half * (1.0f - std::sqrt(r2)) + 0.5f, 0.0f, 1.0f);
      if (cover <= 0.0f) continue;
      const glm::vec3 color =
          shade(material, glm::normalize(glm::vec3(u, v, std::sqrt(std::max(0.0f, 1.0f - r2)))));
      std::uint8_t* texel = &image.texels[(std::size_t{y} * size + x) * 4];
      for (int channel = 0; channel < 3; ++channel) texel[channel] = byteOf(color[channel]);
      texel[3] = static_cast<std::uint8_t>(std::lround(255.0f * cover));
    }
  return image;
}

}  // namespace lambent::editor
