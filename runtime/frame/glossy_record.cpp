#include "runtime/frame/glossy_record.hpp"

#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include "runtime/sh/zonal_factors.hpp"

namespace lambent::frame {

std::int32_t brdfTableOf(const World& world, std::size_t draw) {
  const streaming::ResidentDraw& resident = world.residency().draws()[draw];
  const streaming::ResidentBundle& owner = world.residency().bundles()[resident.bundle];
  const gltf::Material& material = materialOf(world, draw);
  const bundle::BrdfFamily family = bundle::brdfFamilyOf(material);
  if (family == bundle::BrdfFamily::Measured)
    return static_cast<std::size_t>(material.brdf) < owner.brdf_tables.size() ? material.brdf : -1;
  for (std::size_t i = 0; i < owner.brdf_families.size(); ++i)
    if (owner.brdf_families[i] == family) return static_cast<std::int32_t>(i);
  return -1;
}

bool glossyReady(const World& world, std::size_t draw) {
  const streaming::ResidentDraw& resident = world.residency().draws()[draw];
  const streaming::ResidentBundle& owner = world.residency().bundles()[resident.bundle];
  const std::int32_t table = brdfTableOf(world, draw);
  return resident.glossy() && table >= 0 && owner.brdf_tables[static_cast<std::size_t>(table)].texture &&
         owner.brdf_tables[static_cast<std::size_t>(table)].order == bundle::bandsOf(resident.outputs) &&
         world.residency().meshes()[resident.mesh].block && resident.rows &&
         world.residency().groups()[resident.group].samples;
}

GlossyPart describeGlossy(const World& world, std::size_t draw) {
  const streaming::ResidentDraw& resident = world.residency().draws()[draw];
  const streaming::ResidentMesh& mesh = world.residency().meshes()[resident.mesh];
  const streaming::ResidentGroup& group = world.residency().groups()[resident.group];
  const streaming::BrdfTexture& table = world.residency()
                                            .bundles()[resident.bundle]
                                            .brdf_tables[static_cast<std::size_t>(brdfTableOf(world, draw))];
  const gltf::Material& material = materialOf(world, draw);
  const glm::vec3 dielectric = material.reflectance() * material.specular_color;
  return {.group_from_world = glm::mat3x4(glm::mat3_cast(glm::conjugate(world.rotationOf(resident.group)))),
          .dielectric = glm::vec4(dielectric, material.specular),
          .metallic_roughness_texture = slotOf(material.metallic_roughness_texture, mesh),
          .specular_texture = slotOf(material.specular_texture, mesh),
          .specular_color_texture = slotOf(material.specular_color_texture, mesh),
          .anisotropy_texture = slotOf(material.anisotropy_texture, mesh),
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
          .first_sample = group.sampleBase(resident.outputs),
          .draw = static_cast<std::uint32_t>(draw),
          .glossy_pad = {}};
}

GlossyKind glossyKindOf(const World& world, std::size_t draw) {
  return {.bands = bundle::bandsOf(world.residency().draws()[draw].outputs),
          .family = bundle::brdfFamilyOf(materialOf(world, draw))};
}

std::vector<gpu::Define> definesOf(const GlossyKind& kind) {
  const bool anisotropic = kind.family == bundle::BrdfFamily::AnisotropicGgx;
  const auto order = static_cast<int>(kind.bands);
  const sh::ZonalFactors factors =
      anisotropic ? sh::ZonalFactors::anisotropic(order) : sh::ZonalFactors::isotropic(order);
  std::string axes;
  for (const glm::vec3& axis : factors.axes())
    axes += fmt::format("{}vec3({:.9g}, {:.9g}, {:.9g})", axes.empty() ? "" : ", ", axis.x, axis.y, axis.z);
  std::vector<gpu::Define> defines = {{"LAMBENT_GLOSSY", "1"},
                                      {"LAMBENT_BANDS", std::to_string(kind.bands)},
                                      {"LAMBENT_ZONAL_AXES", fmt::format("vec3[]({})", axes)}};
  if (anisotropic) defines.push_back({"LAMBENT_ANISOTROPIC", "1"});
  if (kind.family == bundle::BrdfFamily::Measured) defines.push_back({"LAMBENT_MEASURED", "1"});
  return defines;
}

}  // namespace lambent::frame
