// Renders scenes that a test builds, and averages many pixels that all look at one point.
#pragma once

#include <cmath>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "reference/reference.hpp"
#include "tests/support/shapes.hpp"

namespace lambent::testing {

inline baker::reference::Report rendered(const baker::Scene& scene,
                                         const baker::reference::Request& request) {
  baker::Progress progress;
  auto report = baker::reference::render(scene, request, {}, false, progress, {});
  EXPECT_TRUE(report) << report.error().line();
  return report ? std::move(*report) : baker::reference::Report{};
}

// Adds a camera as the first of the scene, so that it is the default.
inline void lookAt(baker::Scene& scene, glm::vec3 eye, glm::vec3 target, float fov_deg) {
  scene.cameras = {{.name = "eye", .yfov_rad = glm::radians(fov_deg)}};
  const glm::vec3 along = glm::normalize(target - eye);
  const glm::vec3 up = std::abs(along.y) > 0.9f ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0);
  addNode(scene, glm::inverse(glm::lookAt(eye, target, up))).camera = 0;
}

struct Measured {
  glm::dvec3 mean{0.0}, error{0.0};  // standard error of the mean
  double alpha = 0.0;
};

// Returns what 64 independent pixels see of `target` from `eye`.
inline Measured measured(baker::Scene scene, glm::vec3 eye, glm::vec3 target,
                         const std::vector<spec::Light>& lights, baker::reference::Options options = {}) {
  lookAt(scene, eye, target, 0.01f);
  options.size = {8, 8};
  const auto report = rendered(scene, {.lights = lights, .camera = {}, .options = options});
  Measured out;
  glm::dvec3 squares(0.0);
  const double count = static_cast<double>(report.image.texels.size());
  for (const glm::vec4& texel : report.image.texels) {
    out.mean += glm::dvec3(texel) / count;
    out.alpha += double{texel.w} / count;
  }
  for (const glm::vec4& texel : report.image.texels) {
    const glm::dvec3 away = glm::dvec3(texel) - out.mean;
    squares += away * away;
  }
  out.error = glm::sqrt(squares / (count * (count - 1.0)));
  return out;
}

// Allows four standard errors, which a correct result exceeds with a chance of 1 in 16,000, and the rounding
// of floats. The tests use the same random numbers every time.
inline void expectMean(const Measured& m, double expected, double rounding = 2e-5) {
  EXPECT_NEAR(m.mean.g, expected, 4.0 * m.error.g + rounding * std::max(1.0, expected));
}

inline baker::reference::Options samples(std::uint32_t spp, std::optional<std::uint32_t> bounces = {}) {
  baker::reference::Options options;
  options.spp = spp;
  options.bounces = bounces;
  return options;
}

// Returns a grey Lambert material.
inline gltf::Material matte(float albedo = 1.0f) {
  gltf::Material material;
  material.metallic = 0.0f;
  material.base_color = glm::vec4(glm::vec3(albedo), 1.0f);
  return material;
}

// Returns a material that shines and reflects nothing.
inline gltf::Material lamp(float radiance) {
  gltf::Material material = matte(0.0f);
  material.emissive = glm::vec3(radiance);
  return material;
}

// Makes a floor and a ball above it; the request is for a picture of them in the light of sky and sun.
inline baker::Scene ballOnAFloor() {
  baker::Scene scene = sceneOf({grid({0, 0, 0}, 4.0f, 8), icosphere({0, 0.6f, 0}, 0.5f, 3)});
  scene.materials[0].base_color = glm::vec4(0.7f, 0.6f, 0.5f, 1);
  return scene;
}
inline baker::reference::Request ballInTheSun(const baker::reference::Options& options) {
  return {.lights = {spec::ConstantLight{.radiance = glm::vec3(0.3f)},
                     spec::SunLight{.elevation_deg = 40, .angle_deg = 4, .radiance = glm::vec3(50)}},
          .camera = spec::OrbitCamera{30, 20, 2, 40},
          .options = options};
}

inline void paint(baker::Scene& scene, std::size_t mesh, const gltf::Material& material) {
  scene.meshes[mesh].primitives[0].material = static_cast<std::int32_t>(scene.materials.size());
  scene.materials.push_back(material);
}

// Adds the mesh with a node of its own, without a transform.
inline void add(baker::Scene& scene, const bundle::MeshData& mesh, const gltf::Material& material) {
  addNode(scene).mesh = static_cast<std::int32_t>(scene.meshes.size());
  scene.meshes.push_back({"", {{mesh, 0}}});
  paint(scene, scene.meshes.size() - 1, material);
}

// Adds a texture that is read without filtering.
inline gltf::TextureRef addTexture(baker::Scene& scene, const spec::Rgba8Image& image) {
  const std::vector<std::uint8_t> png = spec::encodePng(image);
  const auto bytes = std::as_bytes(std::span(png));
  scene.textures.push_back({.image = static_cast<std::int32_t>(scene.images.size()), .sampler = {}});
  scene.textures.back().sampler.mag_filter = 9728;  // NEAREST
  scene.images.push_back({"texture", "image/png", {bytes.begin(), bytes.end()}});
  return {.texture = static_cast<std::int32_t>(scene.textures.size()) - 1};
}

// Gives each triangle vertices of its own with its face normal.
inline bundle::MeshData flat(const bundle::MeshData& mesh) {
  bundle::MeshData out;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::vec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                    c = mesh.positions[mesh.indices[i + 2]];
    for (const glm::vec3& p : {a, b, c}) {
      out.indices.push_back(static_cast<std::uint32_t>(out.positions.size()));
      out.positions.push_back(p);
      out.normals.push_back(glm::normalize(glm::cross(b - a, c - a)));
    }
  }
  return out;
}

inline spec::Light uniform(float radiance) {
  return spec::ConstantLight{.radiance = glm::vec3(radiance)};
}

inline const glm::vec3 kPlace(0.1f, 0, 0.2f);  // that tests of one place look at

inline baker::reference::Options limited(std::uint32_t spp, int in, std::optional<int> out = {}) {
  baker::reference::Options options = samples(spp, 0);
  options.band_limit = baker::reference::BandLimit{in, out};
  return options;
}

}  // namespace lambent::testing
