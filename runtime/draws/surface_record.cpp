#include "runtime/draws/surface_record.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include "runtime/sh/zonal.hpp"

namespace lambent::frame {

namespace {

// Returns the matrix from the mesh's to the texture's coordinates.
glm::mat3x2 transformOf(const gltf::TextureRef& texture) {
  const glm::vec2 origin = texture.apply({0.0f, 0.0f});
  return {texture.apply({1.0f, 0.0f}) - origin, texture.apply({0.0f, 1.0f}) - origin, origin};
}

}  // namespace

TextureSlot slotOf(const gltf::TextureRef& texture, const streaming::ResidentMesh& mesh) {
  const std::uint32_t set = texture.texcoord;
  const bool there = texture.texture >= 0 && set < 2 && mesh.texcoords_word[set] != kAbsent;
  return {.texture_from_coordinates = transformOf(texture), .set = there ? set : kAbsent, .pad = 0};
}

bool normalMapped(const World& world, std::size_t draw) {
  return world.residency().draws()[draw].form() == transfer::Form::NormalMapped;
}

bool hasTexels(const World& world, std::size_t draw) {
  const streaming::ResidentDraw& resident = world.residency().draws()[draw];
  const streaming::ResidentMesh& mesh = world.residency().meshes()[resident.mesh];
  return resident.irradiance && mesh.texcoords_word[resident.texel_set] != kAbsent;
}

SurfaceDraw describe(const World& world, std::size_t draw) {
  const streaming::ResidentDraw& resident = world.residency().draws()[draw];
  const streaming::ResidentMesh& mesh = world.residency().meshes()[resident.mesh];
  const gltf::Material& material = world.material(draw);
  const float facing = resident.back ? -1.0f : 1.0f;
  const glm::quat turn = world.rotationOf(resident.group);
  const float transmission = material.transmits() ? (1.0f - material.metallic) * material.transmission : 0.0f;
  // Unlit surfaces emit nothing but their base colour (KHR_materials_unlit).
  const glm::vec3 emission = material.unlit ? glm::vec3(0.0f) : world.emission(draw);
  return {.world_from_mesh = world.worldFromMesh(draw),
          .group_from_mesh = glm::mat3x4(resident.group_from_mesh),
          .group_from_mesh_normal = glm::mat3x4(facing * resident.group_from_mesh_normal),
          .world_from_group = {turn.x, turn.y, turn.z, turn.w},
          .base_color = material.base_color,
          .emission = glm::vec4(emission, 0.0f),
          .base_color_texture = slotOf(material.base_color_texture, mesh),
          .emissive_texture = slotOf(material.emissive_texture, mesh),
          .normal_texture = slotOf(material.normal_texture, mesh),
          .normal_scale = material.normal_scale,
          .facing = facing,
          .positions_word = mesh.positions_word,
          .normals_word = mesh.normals_word,
          .tangents_word = mesh.tangents_word,
          .texcoords0_word = mesh.texcoords_word[0],
          .texcoords1_word = mesh.texcoords_word[1],
          .colors_word = mesh.colors_word,
          .radiance_word = resident.radiance.word(),
          .alpha_mode = static_cast<uint>(material.alpha_mode),
          .alpha_cutoff = material.alpha_cutoff,
          .unlit = material.unlit ? 1u : 0u,
          .bounced_word = kAbsent,
          .irradiance_set = hasTexels(world, draw) ? resident.texel_set : kAbsent,
          .transmission = transmission,
          .pane_reflectance = transmission > 0.0f ? 1.0f - material.passedStraightOn() / transmission : 0.0f};
}

SurfaceTextures texturesOf(const World& world, std::size_t draw, const SurfaceDraw& record) {
  const gltf::Material& material = world.material(draw);
  SurfaceTextures textures;
  if (record.base_color_texture.set != kAbsent) textures.base_color = material.base_color_texture.texture;
  // Textures that are never read must not split batches: surfaces without emission, and those that receive
  // light at their vertices, leave them out.
  if (record.emissive_texture.set != kAbsent && glm::vec3(record.emission) != glm::vec3(0.0f))
    textures.emissive = material.emissive_texture.texture;
  const bool glossy = world.residency().draws()[draw].glossy();
  if (record.normal_texture.set != kAbsent && (glossy || normalMapped(world, draw)))
    textures.normal = material.normal_texture.texture;
  if (glossy || world.residency().draws()[draw].layered) {
    const streaming::ResidentMesh& mesh = world.residency().meshes()[world.residency().draws()[draw].mesh];
    const auto textureOf = [&](const gltf::TextureRef& reference) {
      return slotOf(reference, mesh).set != kAbsent ? reference.texture : -1;
    };
    textures.metallic_roughness = textureOf(material.metallic_roughness_texture);
    textures.specular = textureOf(material.specular_texture);
    textures.specular_color = textureOf(material.specular_color_texture);
    textures.anisotropy = textureOf(material.anisotropy_texture);
  }
  if (textures != SurfaceTextures{})
    textures.bundle = static_cast<std::int32_t>(world.residency().draws()[draw].bundle);
  return textures;
}

namespace {

gpu::Texture oneTexel(const char* label, const glm::vec4& value) {
  // Eight bits cannot represent 0.5, so a flat normal needs more.
  gpu::Texture texture(label, {.format = GL_RGBA16F});
  glTextureSubImage2D(texture.id(), 0, 0, 0, 1, 1, GL_RGBA, GL_FLOAT, &value.x);
  return texture;
}

}  // namespace

TextureUnits::TextureUnits()
    : white_(oneTexel("white", glm::vec4(1.0f))),
      flat_(oneTexel("flat normal", glm::vec4(0.5f, 0.5f, 1.0f, 1.0f))),
      along_tangent_(oneTexel("along the tangent", glm::vec4(1.0f, 0.5f, 1.0f, 1.0f))) {}

void TextureUnits::bindOne(GLuint unit, const streaming::ResidentBundle* bundle, std::int32_t texture) {
  const bool numbers = unit != kUnitBaseColor && unit != kUnitEmissive && unit != kUnitSpecularColor;
  const gpu::Texture* image = unit == kUnitNormal       ? &flat_
                              : unit == kUnitAnisotropy ? &along_tangent_
                                                        : &white_;
  gltf::Sampler wanted;
  if (bundle != nullptr && texture >= 0) {
    const gltf::Texture& described = bundle->textures[static_cast<std::size_t>(texture)];
    wanted = described.sampler;
    if (described.image >= 0) {
      const auto& images = numbers ? bundle->linear_images : bundle->images;
      const gpu::Texture& arrived = images[static_cast<std::size_t>(described.image)];
      if (arrived) image = &arrived;
    }
  }
  auto& sampler = samplers_[{wanted.wrap_s, wanted.wrap_t, wanted.mag_filter, wanted.min_filter}];
  if (!sampler) sampler = gpu::Sampler(wanted.wrap_s, wanted.wrap_t, wanted.mag_filter, wanted.min_filter);
  image->bind(unit);
  glBindSampler(unit, sampler.id());
}

void TextureUnits::bind(const World& world, const SurfaceTextures& textures) {
  const streaming::ResidentBundle* bundle =
      textures.bundle >= 0 ? &world.residency().bundles()[static_cast<std::size_t>(textures.bundle)]
                           : nullptr;
  bindOne(kUnitBaseColor, bundle, textures.base_color);
  bindOne(kUnitEmissive, bundle, textures.emissive);
  bindOne(kUnitNormal, bundle, textures.normal);
}

void TextureUnits::bindGlossy(const World& world, const SurfaceTextures& textures, std::uint32_t bundle,
                              std::int32_t table) {
  const streaming::ResidentBundle* owner = &world.residency().bundles()[bundle];
  bindOne(kUnitMetallicRoughness, owner, textures.metallic_roughness);
  bindOne(kUnitSpecular, owner, textures.specular);
  bindOne(kUnitSpecularColor, owner, textures.specular_color);
  bindOne(kUnitAnisotropy, owner, textures.anisotropy);
  owner->brdf_tables[static_cast<std::size_t>(table)].texture.bind(kUnitBrdf);
}

void TextureUnits::unbindSamplers() const {
  for (GLuint unit = kUnitBaseColor; unit <= kUnitAnisotropy; ++unit) glBindSampler(unit, 0);
}

void DrawIndices::reserve(std::size_t draw_count) {
  if (indices_.byteCount() >= 4 * draw_count) return;
  std::vector<std::uint32_t> indices(2 * draw_count);
  std::iota(indices.begin(), indices.end(), 0u);
  indices_ = gpu::Buffer("draw indices", 4 * indices.size());
  indices_.write(0, std::span<const std::uint32_t>(indices));
  constexpr GLuint kAttribute = 0;
  const GLuint array = vertices_.id();
  glVertexArrayVertexBuffer(array, 0, indices_.id(), 0, 4);
  glVertexArrayBindingDivisor(array, 0, 1);
  glVertexArrayAttribIFormat(array, kAttribute, 1, GL_UNSIGNED_INT, 0);
  glVertexArrayAttribBinding(array, kAttribute, 0);
  glEnableVertexArrayAttrib(array, kAttribute);
}

void DrawIndices::draw(std::uint32_t first_command, std::uint32_t command_count, gpu::Counters& counters) {
  glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT,
                              reinterpret_cast<const void*>(std::size_t{first_command} * sizeof(DrawCommand)),
                              static_cast<GLsizei>(command_count), 0);
  counters.draws += command_count;
  ++counters.draw_calls;
}

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

// Returns the table that a draw looks up, or null if no table fits.
const streaming::BrdfTexture* tableOf(const World& world, std::size_t draw) {
  const std::int32_t table = brdfTableOf(world, draw);
  const auto& tables = world.residency().bundles()[world.residency().draws()[draw].bundle].brdf_tables;
  return table >= 0 ? &tables[static_cast<std::size_t>(table)] : nullptr;
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
  const streaming::BrdfTexture* table = tableOf(world, draw);
  return resident.glossy() && table != nullptr && table->texture &&
         table->order == transfer::bandsOf(resident.outputs) &&
         world.residency().meshes()[resident.mesh].block && resident.rows &&
         world.residency().groups()[resident.group].samples;
}

bool layerReady(const World& world, std::size_t draw) {
  const streaming::ResidentDraw& resident = world.residency().draws()[draw];
  const streaming::BrdfTexture* table = tableOf(world, draw);
  return resident.layered && resident.radiance && table != nullptr && table->texture;
}

GlossyPart describeGlossy(const World& world, std::size_t draw) {
  const streaming::ResidentDraw& resident = world.residency().draws()[draw];
  const streaming::ResidentMesh& mesh = world.residency().meshes()[resident.mesh];
  const streaming::ResidentGroup& group = world.residency().groups()[resident.group];
  const streaming::BrdfTexture& table = *tableOf(world, draw);
  const gltf::Material& material = world.material(draw);
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
  return {.bands = tableOf(world, draw)->order, .family = choiceOf(world, draw).family};
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
