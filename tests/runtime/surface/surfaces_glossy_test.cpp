// Tests the surface shaders of glossy draws alone: a rectangle in two draws fills the picture, with random
// rows, samples and tables, and is compared with the shaders' text as C++ and closed forms.
#include <array>
#include <cmath>
#include <cstring>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/draws/glossy_record.hpp"
#include "runtime/draws/surface_record.hpp"
#include "runtime/draws/surface_shared.h"
#include "runtime/gpu/program.hpp"
#include "runtime/surface/surface_program.hpp"
#include "tests/runtime/evaluate/random_table.hpp"
#include "tests/runtime/surface/surface_normal.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/glsl/glossy_kernels.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {
namespace {

namespace kernel = glossy::glsl;
constexpr std::uint32_t kGlossySize = 16;
using Picture = std::vector<glm::vec4>;

// These are the words of the geometry page: positions, normals, tangents, TEXCOORD_0 and indices, for four
// vertices.
constexpr std::uint32_t kNormals = 12, kTangents = 24, kTexcoords = 40, kIndices = 48;

struct Scene {
  std::array<glm::vec3, 4> positions = {glm::vec3(-1, -1, 0), {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  std::array<std::uint32_t, 6> indices = {0, 1, 2, 0, 2, 3};
  glm::vec3 normal = glm::normalize(glm::vec3(0.2f, -0.1f, 1.0f));
  glm::vec4 tangent{glm::normalize(glm::vec3(1.0f, 0.4f, 0.0f)), -1.0f};
  glm::vec4 eye{0.3f, -0.5f, 2.0f, 1.0f};
  bundle::BrdfTable table;
  GlossyKind kind{.bands = 5, .family = bundle::BrdfFamily::Ggx};
  std::vector<std::vector<std::uint32_t>> rows = {{0}, {1, 2}, {3}, {4, 5, 0}};  // by vertex
  std::vector<glm::vec4> samples;
  GlossyDraw record{};
  std::array<glm::vec4, 8> texels{};  // by unit, where a slot is set
};

TextureSlot slotOf(bool there) {
  return {.texture_from_coordinates = glm::mat3x2(1.0f), .set = there ? 0u : kAbsent, .pad = 0};
}

Scene makeScene(lambent::testing::BundleMaker& maker, const GlossyKind& kind, bool textures) {
  Scene scene;
  scene.kind = kind;
  const bool anisotropic = kind.family == bundle::BrdfFamily::AnisotropicGgx;
  const bool measured = kind.family == bundle::BrdfFamily::Measured;
  scene.table = glossy::testing::randomTable(maker, kind.bands, !anisotropic, measured ? 3 : 2);
  for (std::uint32_t i = 0; i < 6 * kind.bands * kind.bands; ++i)
    scene.samples.emplace_back(maker.uniform(-1, 1), maker.uniform(-1, 1), maker.uniform(-1, 1), 0.0f);
  SurfaceDraw& surface = scene.record.surface;
  surface = {.world_from_mesh = glm::mat4(1.0f),
             .group_from_mesh = glm::mat3x4(1.0f),
             .group_from_mesh_normal = glm::mat3x4(1.0f),
             .world_from_group = glm::vec4(0, 0, 0, 1),
             .base_color = {0.8f, 0.5f, 0.3f, 1.0f},
             .emission = glm::vec4(0.1f, 0.0f, 0.0f, 0.0f),
             .base_color_texture = slotOf(false),
             .emissive_texture = slotOf(false),
             .normal_texture = slotOf(textures),
             .normal_scale = 0.7f,
             .facing = 1.0f,
             .positions_word = 0,
             .normals_word = kNormals,
             .tangents_word = kTangents,
             .texcoords0_word = kTexcoords,
             .texcoords1_word = kAbsent,
             .colors_word = kAbsent,
             .radiance_word = 0,
             .alpha_mode = kAlphaOpaque,
             .alpha_cutoff = 0.5f,
             .unlit = 0,
             .bounced_word = kAbsent,
             .irradiance_set = kAbsent,
             .transmission = 0.0f,
             .pane_reflectance = 0.0f};
  scene.record.glossy = {.group_from_world = glm::mat3x4(1.0f),
                         .dielectric = {0.04f, 0.05f, 0.06f, 0.9f},
                         .metallic_roughness_texture = slotOf(textures),
                         .specular_texture = slotOf(textures),
                         .specular_color_texture = slotOf(textures),
                         .anisotropy_texture = slotOf(textures && anisotropic),
                         .metallic = 0.6f,
                         .roughness = 0.7f,
                         .anisotropy = 0.9f,
                         .direction_cos = std::cos(0.4f),
                         .direction_sin = std::sin(0.4f),
                         .roughnesses = scene.table.roughnesses,
                         .strengths = scene.table.strengths,
                         .indices_word = kIndices,
                         .rows_word = 0,
                         .row_entries = 0,
                         .vertex_count = 4,
                         .first_sample = 0,
                         .draw = 0,
                         .first_output = 0,
                         .seen_word = 0,
                         .glossy_pad = 0};
  scene.texels[kUnitNormal] = {0.6f, 0.45f, 0.9f, 1.0f};
  scene.texels[kUnitMetallicRoughness] = {0.0f, 0.8f, 0.5f, 1.0f};
  scene.texels[kUnitSpecular] = {0.0f, 0.0f, 0.0f, 0.75f};
  scene.texels[kUnitSpecularColor] = {0.5f, 0.75f, 1.0f, 1.0f};
  scene.texels[kUnitAnisotropy] = {0.25f, 0.9f, 0.8f, 1.0f};
  return scene;
}

gpu::Texture oneTexel(const glm::vec4& value) {
  gpu::Texture texture("texel", {.format = GL_RGBA32F});
  glTextureSubImage2D(texture.id(), 0, 0, 0, 1, 1, GL_RGBA, GL_FLOAT, &value.x);
  return texture;
}

// Returns the pixel's colour by the twin, at a place of the rectangle.
glm::vec3 expectedAt(const Scene& scene, const glm::vec3& place) {
  const std::size_t n = std::size_t{scene.kind.bands} * scene.kind.bands;
  const std::size_t triangle = place.x >= place.y ? 0 : 3;
  std::array<std::uint32_t, 3> corners;
  for (std::size_t c = 0; c < 3; ++c) corners[c] = scene.indices[triangle + c];
  const glm::vec3 shares = kernel::Isotropic().cornerWeights(
      place, scene.positions[corners[0]], scene.positions[corners[1]], scene.positions[corners[2]]);
  std::vector<glm::vec4> light(n, glm::vec4(0.0f));
  for (int c = 0; c < 3; ++c) {
    const auto& row = scene.rows[corners[static_cast<std::size_t>(c)]];
    for (const std::uint32_t sample : row)
      for (std::size_t k = 0; k < n; ++k)
        light[k] += shares[c] / static_cast<float>(row.size()) * scene.samples[n * sample + k];
  }
  const SurfaceDraw& surface = scene.record.surface;
  const GlossyPart& glossy = scene.record.glossy;
  const auto texel = [&](const TextureSlot& slot, std::uint32_t unit) {
    return slot.set == kAbsent ? glm::vec4(1.0f) : scene.texels[unit];
  };
  glsl::SurfaceNormal shader;
  const auto frame = shader.frameFromTangent(scene.normal, scene.tangent);
  const glm::vec3 normal =
      surface.facing *
      (surface.normal_texture.set == kAbsent
           ? frame.normal
           : shader.perturbedNormal(frame, glm::vec3(scene.texels[kUnitNormal]), surface.normal_scale));
  const glm::vec3 to_eye = glm::normalize(glm::vec3(scene.eye) - scene.eye.w * place);
  const kernel::Table table(scene.table);
  const glm::vec3 base(surface.base_color);
  if (scene.kind.family == bundle::BrdfFamily::Measured)
    return glm::vec3(table.reflect({normal, {}, to_eye}, light).light) + glm::vec3(surface.emission);
  const glm::vec4 mr = texel(glossy.metallic_roughness_texture, kUnitMetallicRoughness);
  const float roughness = glossy.roughness * mr.g, metallic = glossy.metallic * mr.b;
  const glm::vec3 dielectric =
      glm::vec3(glossy.dielectric) * glm::vec3(texel(glossy.specular_color_texture, kUnitSpecularColor));
  const auto fresnel = kernel::Isotropic().fresnelOf(
      base, metallic, dielectric, glossy.dielectric.w * texel(glossy.specular_texture, kUnitSpecular).a);
  glm::vec2 direction(1.0f, 0.0f);
  float anisotropy = glossy.anisotropy;
  if (glossy.anisotropy_texture.set != kAbsent) {
    direction = glm::normalize(2.0f * glm::vec2(scene.texels[kUnitAnisotropy]) - 1.0f);
    anisotropy *= scene.texels[kUnitAnisotropy].b;
  }
  direction = {glossy.direction_cos * direction.x - glossy.direction_sin * direction.y,
               glossy.direction_sin * direction.x + glossy.direction_cos * direction.y};
  const glm::vec3 bitangent = frame.handedness * glm::cross(frame.normal, frame.tangent);
  const glm::vec3 along = shader.alongSurface(normal, direction.x * frame.tangent + direction.y * bitangent);
  const kernel::Reflection reflected = table.reflect({normal, along, to_eye, roughness, anisotropy}, light);
  return fresnel.f0 * glm::vec3(reflected.f0_light) + fresnel.f90 * glm::vec3(reflected.f90_light) +
         kernel::Isotropic().diffuseAlbedo(base, metallic, fresnel, glm::vec2(reflected.albedo)) *
             glm::vec3(reflected.diffuse) +
         glm::vec3(surface.emission);
}

class GlossySurface : public testing::GpuTest {
 protected:
  Picture draw(Scene& scene) {
    const Result<gpu::Program> program =
        makeSurfaceProgram({.glossy = scene.kind}, {}, /*finest_texels=*/true);
    EXPECT_TRUE(program) << program.error().line();
    if (!program) return {};
    std::vector<float> words;
    const auto append = [&](const auto& value) {
      for (int i = 0; i < value.length(); ++i) words.push_back(value[i]);
    };
    for (const glm::vec3& position : scene.positions) append(position);
    for (int i = 0; i < 4; ++i) append(scene.normal);
    for (int i = 0; i < 4; ++i) append(scene.tangent);
    for (int i = 0; i < 4; ++i) append(glm::vec2(0.5f));
    for (const std::uint32_t index : scene.indices) words.push_back(std::bit_cast<float>(index));
    std::vector<std::uint32_t> rows = {0}, sample_words;
    std::vector<std::uint16_t> weights;
    for (const auto& row : scene.rows) {
      for (const std::uint32_t sample : row) {
        sample_words.push_back(sample);
        weights.push_back(static_cast<std::uint16_t>(65535 / row.size()));
      }
      rows.push_back(static_cast<std::uint32_t>(sample_words.size()));
    }
    scene.record.glossy.row_entries = static_cast<std::uint32_t>(sample_words.size());
    rows.insert(rows.end(), sample_words.begin(), sample_words.end());
    weights.resize((weights.size() + 1) / 2 * 2);
    for (std::size_t i = 0; i < weights.size(); i += 2)
      rows.push_back(weights[i] | std::uint32_t{weights[i + 1]} << 16);

    // Two draws of one triangle each: gl_PrimitiveID must start anew in the second.
    std::array<GlossyDraw, 2> records = {scene.record, scene.record};
    records[1].glossy.indices_word += 3;
    const std::array<DrawCommand, 2> commands = {
        {{.count = 3, .instance_count = 1, .first_index = kIndices, .base_vertex = 0, .base_instance = 0},
         {.count = 3,
          .instance_count = 1,
          .first_index = kIndices + 3,
          .base_vertex = 0,
          .base_instance = 1}}};
    struct {
      glm::mat4 view_from_world{1.0f}, clip_from_view{1.0f};
      glm::vec4 eye;
    } const block{.eye = scene.eye};
    gpu::Table draws("draws"), geometry("geometry"), rows_table("rows"), samples("samples"), view("view"),
        commands_table("commands");
    draws.assign(std::span<const GlossyDraw>(records));
    geometry.assign(std::span<const float>(words));
    rows_table.assign(std::span<const std::uint32_t>(rows));
    samples.assign(std::span<const glm::vec4>(scene.samples));
    view.assign(std::span(&block, 1));
    commands_table.assign(std::span<const DrawCommand>(commands));
    const auto table = streaming::makeBrdfTexture(scene.table, streaming::packBrdf(scene.table), "table");
    EXPECT_TRUE(table);
    std::vector<gpu::Texture> textures;
    for (GLuint unit = kUnitBaseColor; unit <= kUnitAnisotropy; ++unit) {
      textures.push_back(oneTexel(scene.texels[unit]));
      textures.back().bind(unit);
      glTextureParameteri(textures.back().id(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    }
    table->texture.bind(kUnitBrdf);
    const gpu::Texture target("target", {.format = GL_RGBA32F, .width = kGlossySize, .height = kGlossySize});
    const gpu::Framebuffer framebuffer("target", target, nullptr);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
    glViewport(0, 0, kGlossySize, kGlossySize);
    DrawIndices indices("draws");
    indices.reserve(2);
    indices.bind(geometry.buffer());
    program->use();
    glBindBufferBase(GL_UNIFORM_BUFFER, kBindView, view.buffer().id());
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, commands_table.buffer().id());
    draws.bindStorage(kBindDraws);
    geometry.bindStorage(kBindGeometry);
    rows_table.bindStorage(kBindRows);
    samples.bindStorage(kBindSamples);
    gpu::Counters counters;
    DrawIndices::draw(0, 2, counters);
    Picture picture(kGlossySize * kGlossySize);
    glGetTextureImage(target.id(), 0, GL_RGBA, GL_FLOAT,
                      static_cast<GLsizei>(picture.size() * sizeof(glm::vec4)), picture.data());
    return picture;
  }

  void expectTwin(Scene& scene, const char* what) {
    const Picture picture = draw(scene);
    ASSERT_FALSE(picture.empty());
    double largest = 0.0, difference = 0.0;
    for (std::uint32_t y = 0; y < kGlossySize; ++y)
      for (std::uint32_t x = 0; x < kGlossySize; ++x) {
        const glm::vec3 place((2.0f * static_cast<float>(x) + 1.0f) / kGlossySize - 1.0f,
                              (2.0f * static_cast<float>(y) + 1.0f) / kGlossySize - 1.0f, 0.0f);
        const glm::vec3 expected = expectedAt(scene, place);
        largest = testing::larger(largest, glm::length(expected));
        difference =
            testing::larger(difference, glm::distance(expected, glm::vec3(picture[y * kGlossySize + x])));
      }
    // Hardware interpolates the table with 8 bits between nodes, an error of 0.6 % on an H100; the shader's
    // own interpolation agrees there to 0.003 %.
    EXPECT_LT(difference, 1e-2 * largest) << what;
    EXPECT_GT(largest, 0.1);
  }
};

}  // namespace

TEST_F(GlossySurface, MatchesTheTwinForEveryFamilyAndOrder) {
  lambent::testing::BundleMaker maker(61);
  for (const std::uint32_t bands : {4u, 5u, 6u})
    for (const bundle::BrdfFamily family :
         {bundle::BrdfFamily::Ggx, bundle::BrdfFamily::AnisotropicGgx, bundle::BrdfFamily::Measured})
      for (const bool textures : {false, true}) {
        Scene scene = makeScene(maker, {.bands = bands, .family = family}, textures);
        expectTwin(scene, textures ? "with textures" : "without textures");
      }
}

TEST_F(GlossySurface, MatchesTheTwinFromTheBackAndInParallelViews) {
  lambent::testing::BundleMaker maker(62);
  Scene scene = makeScene(maker, {.bands = 5, .family = bundle::BrdfFamily::AnisotropicGgx}, true);
  scene.record.surface.facing = -1.0f;
  expectTwin(scene, "back");
  scene.eye = {glm::normalize(glm::vec3(0.9f, 0.1f, 0.2f)), 0.0f};
  expectTwin(scene, "parallel and grazing");
}

TEST_F(GlossySurface, UniformLightShowsTheSameAlbedoAllOver) {
  lambent::testing::BundleMaker maker(63);
  Scene scene = makeScene(maker, {.bands = 5, .family = bundle::BrdfFamily::Ggx}, false);
  scene.table = glossy::testing::evenTable(5, true, 0.7f, 0.1f);
  scene.record.glossy.roughnesses = scene.table.roughnesses;
  for (std::size_t i = 0; i < scene.samples.size(); ++i)
    scene.samples[i] = glm::vec4(i % 25 == 0 ? 3.5449077f : 0.0f);
  scene.record.surface.emission = glm::vec4(0.0f);
  // A metal: its albedo is F0 A + B.
  scene.record.glossy.metallic = 1.0f;
  for (const glm::vec4& pixel : draw(scene))
    EXPECT_LT(glm::distance(glm::vec3(pixel), 0.7f * glm::vec3(0.8f, 0.5f, 0.3f) + 0.1f), 1e-5f);
  // White plastic without losses reflects everything.
  scene.record.glossy.metallic = 0.0f;
  scene.record.surface.base_color = glm::vec4(1.0f);
  scene.record.glossy.dielectric = glm::vec4(0.04f, 0.04f, 0.04f, 1.0f);
  for (const glm::vec4& pixel : draw(scene))
    EXPECT_LT(glm::distance(glm::vec3(pixel), glm::vec3(1.0f)), 1e-5f);
}

}  // namespace lambent::frame
