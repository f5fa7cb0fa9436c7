// Tests the surface shaders alone: one rectangle fills the picture, with a record, vertices, light and
// textures that each test writes, and is compared with closed forms and surface_normal.glsl as C++.
#include <algorithm>
#include <array>
#include <cstring>
#include <functional>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "runtime/bundle/gltf_types.hpp"
#include "runtime/draws/surface_shared.h"
#include "runtime/gpu/program.hpp"
#include "runtime/surface/surfaces.hpp"
#include "tests/runtime/surface/surface_normal.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {
namespace {

constexpr std::uint32_t kSize = 16;

using Light = std::array<glm::vec3, kLightCoefficients>;

gpu::Texture picture(std::uint32_t width, std::uint32_t height, const std::vector<std::uint8_t>& rgba,
                     GLenum format) {
  gpu::Texture texture("picture", {.format = format, .width = width, .height = height});
  glTextureSubImage2D(texture.id(), 0, 0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height),
                      GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  return texture;
}

glm::mat3x2 transformed(const gltf::TextureRef& reference) {
  const glm::vec2 origin = reference.apply({0, 0});
  return {reference.apply({1, 0}) - origin, reference.apply({0, 1}) - origin, origin};
}

// Holds the rectangle's vertex attributes. TEXCOORD_0 is as in glTF, (0, 0) at the top left; TEXCOORD_1 is
// the same at all vertices.
struct Vertices {
  std::array<glm::vec3, 4> positions = {glm::vec3(-1, -1, 0), {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  glm::vec3 normal{0, 0, 1};
  glm::vec4 tangent{1, 0, 0, 1};
  std::array<glm::vec2, 4> texcoords0 = {glm::vec2(0, 1), {1, 1}, {1, 0}, {0, 0}};
  glm::vec2 texcoord1{0.5f, 0.5f};
};

TextureSlot slot(std::uint32_t set, const gltf::TextureRef& reference = {}) {
  return {.texture_from_coordinates = transformed(reference), .set = set, .pad = 0};
}

}  // namespace

class SurfaceShader : public testing::GpuTest {
 protected:
  using Picture = std::vector<glm::vec4>;

  // words_per_vertex: 4 is radiance, 27 light for normal maps.
  Picture draw(const SurfaceDraw& record, const Vertices& vertices, const std::vector<float>& light,
               std::size_t words_per_vertex) {
    const Result<gpu::Program> program = makeSurfaceProgram(
        {.normal_mapped = words_per_vertex == 27, .texels = record.irradiance_set != kAbsent}, {},
        /*finest_texels=*/false);
    EXPECT_TRUE(program) << program.error().line();
    if (!program) return {};
    std::vector<float> geometry;
    const auto append = [&](const auto& value) {
      for (int i = 0; i < value.length(); ++i) geometry.push_back(value[i]);
    };
    for (const glm::vec3& position : vertices.positions) append(position);
    for (int i = 0; i < 4; ++i) append(vertices.normal);
    for (int i = 0; i < 4; ++i) append(vertices.tangent);
    for (const glm::vec2& at : vertices.texcoords0) append(at);
    for (int i = 0; i < 4; ++i) append(vertices.texcoord1);
    EXPECT_EQ(light.size(), 4 * words_per_vertex);
    gpu::Table draws("draws"), words("geometry"), radiance("radiance"), view("view"), indices("indices");
    const glm::mat4 identity[] = {glm::mat4(1.0f), glm::mat4(1.0f)};
    const std::uint32_t corners[] = {0, 1, 2, 0, 2, 3};
    draws.assign(std::span(&record, 1));
    words.assign(std::span<const float>(geometry));
    radiance.assign(std::span<const float>(light));
    view.assign(std::span<const glm::mat4>(identity));
    indices.assign(std::span<const std::uint32_t>(corners));
    const gpu::Texture target("target", {.format = GL_RGBA32F, .width = kSize, .height = kSize});
    const gpu::Framebuffer framebuffer("target", target, nullptr);
    const gpu::VertexArray array("rectangle");
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
    glViewport(0, 0, kSize, kSize);
    program->use();
    glBindVertexArray(array.id());
    glVertexArrayElementBuffer(array.id(), indices.buffer().id());
    glVertexAttribI1ui(0, 0);
    glBindBufferBase(GL_UNIFORM_BUFFER, kBindView, view.buffer().id());
    draws.bindStorage(kBindDraws);
    words.bindStorage(kBindGeometry);
    radiance.bindStorage(kBindRadiance);
    const gpu::Sampler sampler(GL_REPEAT, GL_REPEAT, GL_NEAREST, GL_NEAREST_MIPMAP_NEAREST);
    for (const GLuint unit : {kUnitBaseColor, kUnitEmissive, kUnitNormal}) {
      glBindTextureUnit(unit, textures[unit].id());
      glBindSampler(unit, sampler.id());
    }
    if (record.irradiance_set != kAbsent) glBindSampler(kUnitIrradiance, 0);
    glDrawElements(GL_TRIANGLES, 6, GL_UNSIGNED_INT, nullptr);
    for (const GLuint unit : {kUnitBaseColor, kUnitEmissive, kUnitNormal}) glBindSampler(unit, 0);
    Picture picture(kSize * kSize);
    glGetTextureImage(target.id(), 0, GL_RGBA, GL_FLOAT,
                      static_cast<GLsizei>(picture.size() * sizeof(glm::vec4)), picture.data());
    return picture;
  }

  Picture drawRadiance(const SurfaceDraw& record, const glm::vec3& radiance) {
    std::vector<float> words;
    for (int i = 0; i < 4; ++i) words.insert(words.end(), {radiance.r, radiance.g, radiance.b, 0.0f});
    return draw(record, {}, words, 4);
  }
  // Sets the same light at every vertex.
  Picture drawLight(const SurfaceDraw& record, const Vertices& vertices, const Light& light) {
    std::vector<float> words;
    for (int i = 0; i < 4; ++i)
      for (const glm::vec3& coefficient : light)
        words.insert(words.end(), {coefficient.r, coefficient.g, coefficient.b});
    return draw(record, vertices, words, 27);
  }

  std::array<gpu::Texture, 3> textures;  // by unit
};

namespace {

// Reads a pixel, counted from the left and from the top.
glm::vec4 at(const std::vector<glm::vec4>& picture, std::uint32_t x, std::uint32_t y) {
  return picture[(kSize - 1 - y) * kSize + x];
}

const Light kLight = [] {
  Light light;
  for (std::size_t j = 0; j < light.size(); ++j)
    light[j] = glm::vec3(1.0f, 0.3f * static_cast<float>(j) - 1.0f, j % 2 == 0 ? 0.5f : -0.7f);
  return light;
}();

// E/pi of kLight at a normal.
glm::vec3 diffuseLight(const glm::vec3& normal) {
  Light light = kLight;
  return glsl::SurfaceNormal().diffuseLight(light.data(), normal);
}

}  // namespace

// Texels count by their share that is shaded, and vertices by the rest.
TEST_F(SurfaceShader, TakesIrradianceFromTexelsAndTheRestFromVertices) {
  constexpr std::uint32_t kSide = 4;
  std::vector<glm::vec4> texels;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    const float share = i % 3 == 0 ? 0.0f : 1.0f;
    texels.emplace_back(share * glm::vec3(0.25f * static_cast<float>(i), static_cast<float>(i % 5), 2.0f),
                        share);
  }
  textures[kUnitIrradiance] =
      gpu::Texture("irradiance", {.format = GL_RGBA16F, .width = kSide, .height = kSide});
  glTextureSubImage2D(textures[kUnitIrradiance].id(), 0, 0, 0, kSide, kSide, GL_RGBA, GL_FLOAT,
                      texels.data());
  textures[kUnitIrradiance].interpolate();
  SurfaceDraw record = plainRecord();
  record.irradiance_set = 0;
  const glm::vec3 at_vertices(0.5f, 1.5f, 3.0f);
  const Picture shown = drawRadiance(record, at_vertices);
  for (std::uint32_t y = 0; y < kSize; ++y)
    for (std::uint32_t x = 0; x < kSize; ++x) {
      const auto place = [](std::uint32_t i) {
        return std::clamp((static_cast<float>(i) + 0.5f) / kSize * kSide - 0.5f, 0.0f, float{kSide - 1});
      };
      const float u = place(x), v = place(y);
      const auto left = std::min(static_cast<std::uint32_t>(u), kSide - 2),
                 top = std::min(static_cast<std::uint32_t>(v), kSide - 2);
      const float along = u - static_cast<float>(left), down = v - static_cast<float>(top);
      const auto texel = [&](std::uint32_t i, std::uint32_t j) {
        return texels[left + i + kSide * (top + j)];
      };
      const glm::vec4 mixed = glm::mix(glm::mix(texel(0, 0), texel(1, 0), along),
                                       glm::mix(texel(0, 1), texel(1, 1), along), down);
      const glm::vec3 wanted = glm::vec3(mixed) + (1.0f - mixed.w) * at_vertices;
      EXPECT_LT(glm::length(glm::vec3(at(shown, x, y)) - wanted), 0.02f) << x << ", " << y;
    }
}

TEST_F(SurfaceShader, AddsEmissionToReflectedLightInTheEmissiveTexturesOwnCoordinates) {
  // The base colour is one grey texel; the emissive texture has four: red green / blue white from the top.
  textures[kUnitBaseColor] = picture(1, 1, {255, 128, 0, 255}, GL_RGBA8);
  textures[kUnitEmissive] =
      picture(2, 2, {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255}, GL_SRGB8_ALPHA8);
  SurfaceDraw record = plainRecord();
  record.base_color = {0.5f, 0.5f, 0.5f, 1.0f};
  record.emission = {5.0f, 6.0f, 7.0f, 0.0f};
  record.base_color_texture = slot(1);
  const glm::vec3 reflected(0.5f * 2.0f, 0.5f * 2.0f * 128.0f / 255.0f, 0.0f);
  struct Case {
    gltf::TextureRef reference;
    glm::vec3 top_left, top_right;
  };
  const Case cases[] = {
      {{}, {5, 0, 0}, {0, 6, 0}},
      // The texture is shifted by half its size to the right and downwards, and repeats.
      {{.texture = 0, .texcoord = 0, .offset = {0.5f, 0.5f}}, {5, 6, 7}, {0, 0, 7}},
      // The rectangle shows half of the texture's width.
      {{.texture = 0, .texcoord = 0, .offset = {0.0f, 0.0f}, .scale = {0.5f, 1.0f}}, {5, 0, 0}, {5, 0, 0}},
      // The texture is turned by 90 degrees: u' = v, v' = -u. The top right corner (1, 0) samples (0, -1),
      // and the beginning of the top row samples the bottom of the texture's left side.
      {{.texture = 0,
        .texcoord = 0,
        .offset = {0.0f, 0.0f},
        .scale = {1.0f, 1.0f},
        .rotation_rad = 1.57079633f},
       {0, 0, 7},
       {5, 0, 0}}};
  for (const Case& test : cases) {
    record.emissive_texture = slot(0, test.reference);
    const Picture image = drawRadiance(record, glm::vec3(2.0f));
    ASSERT_FALSE(image.empty());
    EXPECT_LT(glm::distance(glm::vec3(at(image, 3, 3)), reflected + test.top_left), 1e-4f);
    EXPECT_LT(glm::distance(glm::vec3(at(image, 12, 3)), reflected + test.top_right), 1e-4f);
  }
  record.emissive_texture = slot(1);  // all of it at the last texel's corner
  const Picture image = drawRadiance(record, glm::vec3(2.0f));
  EXPECT_EQ(at(image, 3, 3), at(image, 12, 12));
}

TEST_F(SurfaceShader, ReceivesLightAtThePixelsNormalAsTheReferenceDoes) {
  const glm::vec3 texel = glm::vec3(220, 70, 200) / 255.0f;
  textures[kUnitNormal] = picture(1, 1, {220, 70, 200, 255}, GL_RGBA8);
  // The mesh is rotated and stretched in its group, and also mirrored.
  for (const float mirrored : {1.0f, -1.0f}) {
    const glm::mat3 group_from_mesh =
        glm::mat3(glm::rotate(glm::mat4(1.0f), 1.2f, glm::normalize(glm::vec3(1, -2, 0.5f)))) *
        glm::mat3(glm::vec3(mirrored * 1.5f, 0, 0), glm::vec3(0, 0.5f, 0), glm::vec3(0, 0, 2.0f));
    const glm::mat3 normal_matrix = glm::transpose(glm::inverse(group_from_mesh));
    Vertices vertices;
    vertices.normal = glm::normalize(glm::vec3(0.2f, 0.1f, 1.0f));
    vertices.tangent = {glm::normalize(glm::vec3(1.0f, 0.3f, -0.2f)), -1.0f};
    SurfaceDraw record = plainRecord();
    record.group_from_mesh = glm::mat3x4(group_from_mesh);
    record.group_from_mesh_normal = glm::mat3x4(normal_matrix);
    record.base_color = {0.5f, 1.0f, 0.25f, 1.0f};
    record.normal_texture = slot(0);
    record.normal_scale = 0.8f;
    const glm::vec3 normal = glm::normalize(normal_matrix * vertices.normal);
    for (const float facing : {1.0f, -1.0f}) {
      record.facing = facing;
      glsl::SurfaceNormal shader;
      const auto stored = shader.frameFromTangent(
          normal, glm::vec4(group_from_mesh * glm::vec3(vertices.tangent), -1.0f * mirrored));
      const auto derived = shader.frameFromDerivatives(normal, group_from_mesh[0], group_from_mesh[1],
                                                       {0.5f, 0.0f}, {0.0f, -0.5f});
      for (const bool tangents : {true, false}) {
        record.tangents_word = tangents ? 24 : kAbsent;
        const glm::vec3 bent = shader.perturbedNormal(tangents ? stored : derived, texel, 0.8f);
        const glm::vec3 expected = glm::vec3(record.base_color) * diffuseLight(facing * bent);
        const Picture image = drawLight(record, vertices, kLight);
        ASSERT_FALSE(image.empty());
        // Derivatives are differences of interpolated positions, 1e-7 of 1 over steps of 1/16.
        for (const glm::vec4& pixel : image)
          ASSERT_LT(glm::distance(glm::vec3(pixel), expected), 1e-4f)
              << "mirrored " << mirrored << " facing " << facing << " tangents " << tangents;
      }
    }
  }
}

TEST_F(SurfaceShader, TakesTheSameMipLevelAlsoWhereTrianglesMeet) {
  // Magnified, so the finest level everywhere: white, where the coarser one is black.
  gpu::Texture& texture = textures[kUnitBaseColor];
  texture = gpu::Texture("levels", {.format = GL_RGBA8, .width = 2, .height = 2, .levels = 2});
  const std::vector<std::uint8_t> white(16, 255), black(4, 0);
  glTextureSubImage2D(texture.id(), 0, 0, 0, 2, 2, GL_RGBA, GL_UNSIGNED_BYTE, white.data());
  glTextureSubImage2D(texture.id(), 1, 0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, black.data());
  SurfaceDraw record = plainRecord();
  record.base_color_texture = slot(0, {.texture = 0, .texcoord = 0, .offset = {0.3f, 0.6f}});
  for (const glm::vec4& pixel : drawRadiance(record, glm::vec3(1.0f)))
    EXPECT_LT(glm::distance(pixel, glm::vec4(1.0f)), 1e-6f);
}

}  // namespace lambent::frame
