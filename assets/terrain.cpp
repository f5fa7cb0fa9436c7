#include "assets/terrain.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "assets/noise.hpp"
#include "assets/shapes.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::assets {

namespace {

constexpr std::uint32_t kPeriod = 256;

// Returns ridges that are sharp on top, by folding noise.
float ridged(glm::vec2 at, std::uint32_t seed) {
  float sum = 0.0f, weight = 0.5f, sharper = 1.0f;
  for (std::uint32_t octave = 0; octave < 5; ++octave) {
    const float folded = 1.0f - std::abs(2.0f * noise(at, kPeriod, seed + octave) - 1.0f);
    const float ridge = folded * folded * sharper;
    sum += weight * ridge;
    sharper = std::clamp(1.6f * ridge, 0.0f, 1.0f);
    at = at * 2.03f + 11.7f;
    weight *= 0.5f;
  }
  return sum;
}

glm::vec3 normalAt(const Terrain& terrain, float x, float z) {
  constexpr float kStep = 0.05f;
  const float along_x = terrain.height(x + kStep, z) - terrain.height(x - kStep, z);
  const float along_z = terrain.height(x, z + kStep) - terrain.height(x, z - kStep);
  return glm::normalize(glm::vec3(-along_x, 2.0f * kStep, -along_z));
}

float srgb(float linear) {
  const float c = std::clamp(linear, 0.0f, 1.0f);
  return c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f;
}

}  // namespace

float Terrain::height(float x, float z) const {
  const float from_middle = std::sqrt(x * x + z * z) / bowl_m;
  const float rise = glm::smoothstep(0.55f, 1.6f, from_middle);
  // Lattice coordinates must stay positive.
  const glm::vec2 at = glm::vec2(x, z) / 9.0f + 60.0f;
  const float rolling = noise(at * 1.7f, kPeriod, seed + 40) - 0.5f;
  return height_m * (rise * ridged(at, seed) * 1.15f + 0.10f * rolling);
}

Mesh terrainMesh(const Terrain& terrain, int cells) {
  Mesh mesh = surface(cells, cells, [&](double u, double v) {
    const float x = terrain.side_m * (static_cast<float>(u) - 0.5f);
    const float z = terrain.side_m * (0.5f - static_cast<float>(v));
    return SurfacePoint{{x, terrain.height(x, z), z}, normalAt(terrain, x, z)};
  });
  mesh.texcoords.clear();
  for (const glm::vec3& at : mesh.positions)
    mesh.texcoords.emplace_back(at.x / terrain.side_m + 0.5f, at.z / terrain.side_m + 0.5f);
  return mesh;
}

std::vector<std::uint8_t> terrainPng(const Terrain& terrain, int side) {
  const auto texels = static_cast<std::uint32_t>(side);
  spec::Rgba8Image image{texels, texels, {}};
  image.texels.reserve(std::size_t{4} * texels * texels);
  for (std::uint32_t row = 0; row < texels; ++row)
    for (std::uint32_t column = 0; column < texels; ++column) {
      const float u = (static_cast<float>(column) + 0.5f) / static_cast<float>(side);
      const float v = (static_cast<float>(row) + 0.5f) / static_cast<float>(side);
      const float x = terrain.side_m * (u - 0.5f), z = terrain.side_m * (v - 0.5f);
      const float level = terrain.height(x, z) / terrain.height_m;
      const float steep = 1.0f - normalAt(terrain, x, z).y;
      const float grain = noise(glm::vec2(column, row) * 0.37f, 4096, terrain.seed + 90) - 0.5f;
      const glm::vec3 grass(0.17f, 0.26f, 0.075f), rock(0.33f, 0.29f, 0.25f), snow(0.82f, 0.84f, 0.87f);
      glm::vec3 color = glm::mix(grass, glm::vec3(0.30f, 0.30f, 0.12f), std::clamp(3.0f * level, 0.0f, 1.0f));
      color = glm::mix(color, rock, glm::smoothstep(0.10f, 0.26f, steep + 0.08f * grain));
      color = glm::mix(color, snow, glm::smoothstep(0.52f, 0.66f, level + 0.10f * grain - 0.4f * steep));
      color *= 1.0f + 0.25f * grain;
      for (int channel = 0; channel < 3; ++channel)
        image.texels.push_back(static_cast<std::uint8_t>(std::lround(255.0f * srgb(color[channel]))));
      image.texels.push_back(255);
    }
  return spec::encodePng(image);
}

}  // namespace lambent::assets
