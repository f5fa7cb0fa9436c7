// Makes media for the CPU twin, seen by a view whose axes are the world's.
#pragma once

#include <algorithm>
#include <functional>
#include <random>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "runtime/effects/volume/march.hpp"
#include "runtime/effects/volume/volume_ref.hpp"
#include "runtime/streaming/load_request.hpp"
#include "tests/support/built_volume.hpp"

namespace lambent::effects::volume::testing {

using lambent::testing::BuiltVolume;

inline streaming::ResidentVolume residentOf(const BuiltVolume& built) {
  streaming::ResidentVolume volume;
  volume.grid.size = built.size;
  volume.grid.group_from_grid = built.group_from_grid;
  volume.grid.density_max = built.density_max;
  volume.grid.albedo = built.albedo;
  volume.grid.g = built.g;
  volume.grid.transfer_size = built.transfer_size;
  volume.outputs = built.shape.outputs;
  return volume;
}

// Uses the density as coded, and the given light for each texel of the light texture with all slabs.
inline ref::Medium mediumOf(const BuiltVolume& built,
                            const std::function<glm::vec4(const glm::uvec3& texel)>& light,
                            const glm::mat4& world_from_group = glm::mat4(1.0f),
                            const glm::mat4& view_from_world = glm::mat4(1.0f)) {
  ref::Medium medium;
  medium.record = *describeMarch(residentOf(built), world_from_group, view_from_world);
  const std::vector<std::byte> codes = built.codes();
  medium.density.size = built.size;
  medium.density.values.clear();
  for (std::size_t i = 0; i < codes.size(); i += built.bits / 8) {
    auto code = std::to_integer<std::uint32_t>(codes[i]);
    if (built.bits == 16) code |= std::to_integer<std::uint32_t>(codes[i + 1]) << 8;
    medium.density.values.push_back(static_cast<float>(code) / (built.bits == 16 ? 65535.0f : 255.0f));
  }
  medium.block_maxima = streaming::blockMaxima(codes, built.bits, built.size);
  medium.light.size = medium.record.light_size;
  medium.light.values.clear();
  for (uint z = 0; z < medium.light.size.z; ++z)
    for (uint y = 0; y < medium.light.size.y; ++y)
      for (uint x = 0; x < medium.light.size.x; ++x) medium.light.values.push_back(light({x, y, z}));
  return medium;
}

inline glm::vec4 whiteLight(const glm::uvec3&) {
  return glm::vec4(1.0f);
}

// Returns a function of voxel coordinates with values 0..1: clumps with edges about two voxels wide, and
// holes between.
inline std::function<float(const glm::vec3&)> clumps(unsigned seed, float voxels) {
  std::mt19937 engine(seed);
  const auto number = [&](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(engine);
  };
  std::vector<glm::vec4> balls;
  for (int i = 0; i < 12; ++i)
    balls.emplace_back(number(0.2f, 0.8f) * voxels, number(0.2f, 0.8f) * voxels, number(0.2f, 0.8f) * voxels,
                       number(0.06f, 0.22f) * voxels);
  return [balls](const glm::vec3& at) {
    float most = 0.0f;
    for (const glm::vec4& ball : balls) {
      const float inside = ball.w - glm::distance(at, glm::vec3(ball));
      const float ripple =
          0.6f + 0.4f * std::sin(1.1f * at.x) * std::sin(0.9f * at.y) * std::sin(1.3f * at.z);
      most = std::max(most, std::clamp(0.5f * inside, 0.0f, 1.0f) * ripple);
    }
    return most;
  };
}

}  // namespace lambent::effects::volume::testing
