#include "runtime/draws/glossy_record.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include "runtime/sh/zonal.hpp"

namespace lambent::frame {

namespace {

std::optional<BrdfChoice> tableFor(std::span<const bundle::BrdfFamily> tables,
                                   const gltf::Material& material) {
  using Family = bundle::BrdfFamily;
  const Family family = bundle::brdfFamilyOf(material);
  if (family == Family::Measured) {
    const auto index = static_cast<std::size_t>(material.brdf);
    if (index >= tables.size() || tables[index] != family) return {};
    return BrdfChoice{material.brdf, family};
  }
  const Family other = family == Family::Ggx ? Family::AnisotropicGgx : Family::Ggx;
  for (const Family wanted : {family, other})
    if (const auto found = std::ranges::find(tables, wanted); found != tables.end())
      return BrdfChoice{static_cast<std::int32_t>(found - tables.begin()), wanted};
  return {};
}

BrdfChoice choiceOf(const World& world, std::size_t draw) {
  const streaming::ResidentDraw& resident = world.residency().draws()[draw];
  gltf::Material now = world.material(draw);
  if (resident.layered) now.brdf = -1, now.anisotropy = 0.0f;  // the layer is one of GGX without direction
  return brdfChoiceOf(world.residency().bundles()[resident.bundle].brdf_families, now,
                      world.bakedMaterial(draw));
}

// Returns whether the table that a draw looks up is resident.
bool tableReady(const World& world, std::size_t draw) {
  const std::int32_t table = brdfTableOf(world, draw);
  return table >= 0 && world.residency()
                           .bundles()[world.residency().draws()[draw].bundle]
                           .brdf_tables[static_cast<std::size_t>(table)]
                           .texture;
}

}  // namespace

BrdfChoice brdfChoiceOf(std::span<const bundle::BrdfFamily> tables, const gltf::Material& now,
                        const gltf::Material& baked) {
  if (const auto choice = tableFor(tables, now)) return *choice;
  return tableFor(tables, baked).value_or(BrdfChoice{-1, bundle::brdfFamilyOf(baked)});
}

std::int32_t brdfTableOf(const World& world, std::size_t draw) {
  return choiceOf(world, draw).table;
}

bool glossyReady(const World& world, std::size_t draw) {
  const streaming::ResidentDraw& resident = world.residency().draws()[draw];
  const streaming::ResidentBundle& owner = world.residency().bundles()[resident.bundle];
  const std::int32_t table = brdfTableOf(world, draw);
  return resident.glossy() && table >= 0 && owner.brdf_tables[static_cast<std::size_t>(table)].texture &&
         owner.brdf_tables[static_cast<std::size_t>(table)].order == transfer::bandsOf(resident.outputs) &&
         world.residency().meshes()[resident.mesh].block && resident.rows &&
         world.residency().groups()[resident.group].samples;
}

bool layerReady(const World& world, std::size_t draw) {
  const streaming::ResidentDraw& resident = world.residency().draws()[draw];
  return resident.layered && resident.radiance && tableReady(world, draw);
}

GlossyPart describeGlossy(const World& world, std::size_t draw) {
  const streaming::ResidentDraw& resident = world.residency().draws()[draw];
  const streaming::ResidentMesh& mesh = world.residency().meshes()[resident.mesh];
  const streaming::ResidentGroup& group = world.residency().groups()[resident.group];
  const streaming::BrdfTexture& table = world.residency()
                                            .bundles()[resident.bundle]
                                            .brdf_tables[static_cast<std::size_t>(brdfTableOf(world, draw))];
  const gltf::Material& material = materialOf(world, draw);
  // A diffuse material is Lambert, whatever its roughness says (docs/conventions.md).
  const glm::vec3 dielectric = material.reflectance() * material.specular_color;
  const float specular = material.isDiffuse() ? 0.0f : material.specular;
  const streaming::SampleStretch samples = group.stretchOf(resident.form());
  const auto textureOfLobes = [&](const gltf::TextureRef& texture) {
    return slotOf(resident.layered ? gltf::TextureRef{} : texture, mesh);
  };
  return {.group_from_world = glm::mat3x4(glm::mat3_cast(glm::conjugate(world.rotationOf(resident.group)))),
          .dielectric = glm::vec4(dielectric, specular),
          .metallic_roughness_texture = slotOf(material.metallic_roughness_texture, mesh),
          .specular_texture = textureOfLobes(material.specular_texture),
          .specular_color_texture = textureOfLobes(material.specular_color_texture),
          .anisotropy_texture = textureOfLobes(material.anisotropy_texture),
          .metallic = material.metallic,
          .roughness = material.roughness,
          .anisotropy = material.anisotropy,
          .direction_cos = std::cos(material.anisotropy_rotation_rad),
          .direction_sin = std::sin(material.anisotropy_rotation_rad),
          .roughnesses = table.roughnesses,
          .strengths = table.strengths,
          .indices_word = mesh.indices_word,
          .rows_word = resident.rows.word(),
          .row_entries = resident.row_entries,
          .vertex_count = mesh.vertex_count,
          .first_sample = samples.first_sample,
          .draw = static_cast<std::uint32_t>(draw),
          .first_output = samples.first_output,
          .seen_word = resident.layered ? resident.seenWord(mesh) : kAbsent,
          .glossy_pad = 0};
}

GlossyKind layerKindOf(const World& world, std::size_t draw) {
  const streaming::ResidentBundle& owner =
      world.residency().bundles()[world.residency().draws()[draw].bundle];
  const BrdfChoice choice = choiceOf(world, draw);
  return {.bands = owner.brdf_tables[static_cast<std::size_t>(choice.table)].order, .family = choice.family};
}

GlossyKind glossyKindOf(const World& world, std::size_t draw, std::uint32_t max_bands) {
  const std::uint32_t bands = transfer::bandsOf(world.residency().draws()[draw].outputs);
  return {.bands = bands,
          .used_bands = max_bands < bands ? max_bands : 0,
          .family = choiceOf(world, draw).family};
}

std::string axesText(const sh::ZonalFactors& factors) {
  std::string axes;
  for (const glm::vec3& axis : factors.axes())
    axes += fmt::format("{}vec3({:.9g}, {:.9g}, {:.9g})", axes.empty() ? "" : ", ", axis.x, axis.y, axis.z);
  return fmt::format("vec3[]({})", axes);
}

std::vector<gpu::Define> definesOf(const GlossyKind& kind) {
  const bool anisotropic = kind.family == bundle::BrdfFamily::AnisotropicGgx;
  const auto order = static_cast<int>(kind.bands);
  const sh::ZonalFactors factors(order, !anisotropic);
  std::vector<gpu::Define> defines = {{"LAMBENT_GLOSSY", "1"},
                                      {"LAMBENT_BANDS", std::to_string(kind.bands)},
                                      {"LAMBENT_ZONAL_AXES", axesText(factors)}};
  if (kind.used_bands > 0) defines.push_back({"LAMBENT_USED_BANDS", std::to_string(kind.used_bands)});
  if (anisotropic) defines.push_back({"LAMBENT_ANISOTROPIC", "1"});
  if (kind.family == bundle::BrdfFamily::Measured) defines.push_back({"LAMBENT_MEASURED", "1"});
  return defines;
}

}  // namespace lambent::frame
