// Makes volumes with known answers.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "baker/effects/volume/volume.hpp"

namespace lambent::testing {

struct Fog {
  std::vector<float> values;
  std::shared_ptr<const baker::DensityField> field;

  // Makes a box from low to high, with the density at its voxel centres.
  Fog(glm::uvec3 size, glm::vec3 low, glm::vec3 high, const std::function<float(glm::vec3)>& density) {
    const glm::mat4 group_from_grid =
        glm::scale(glm::translate(glm::mat4(1.0f), low), (high - low) / glm::vec3(size));
    for (std::uint32_t z = 0; z < size.z; ++z)
      for (std::uint32_t y = 0; y < size.y; ++y)
        for (std::uint32_t x = 0; x < size.x; ++x)
          values.push_back(density(glm::vec3(group_from_grid * glm::vec4(glm::vec3(x, y, z) + 0.5f, 1.0f))));
    field = std::make_shared<baker::DensityField>(size, values, group_from_grid);
  }

  baker::Medium medium(glm::vec3 albedo = glm::vec3(1.0f), float g = 0.0f) const {
    return {field, values, albedo, g};
  }
};

// Makes the box [-1/2, 1/2]^3 of one density.
inline Fog cube(float sigma, std::uint32_t voxels = 1) {
  return Fog(glm::uvec3(voxels), glm::vec3(-0.5f), glm::vec3(0.5f), [sigma](glm::vec3) { return sigma; });
}

inline constexpr glm::dvec3 kCenter(0.0);
inline const double kRoot4Pi = std::sqrt(4.0 * std::numbers::pi);

inline baker::VolumeSettings gridOf(std::uint32_t n, int order = 5, std::size_t rays = 512) {
  baker::VolumeSettings settings;
  settings.grid = glm::uvec3(n);
  settings.order = order;
  settings.rays = rays;
  return settings;
}

inline baker::VolumeTransfer transferOf(const Fog& fog, const baker::VolumeSettings& settings = {},
                                        glm::vec3 albedo = glm::vec3(1.0f),
                                        const baker::Occluders& occluders = {}, float g = 0.0f) {
  baker::Progress progress;
  auto transfer = baker::bakeVolumeTransfer(fog.medium(albedo, g), settings, occluders, {progress});
  EXPECT_TRUE(transfer.has_value());
  return std::move(*transfer);
}

// Returns one interpolated coefficient of the light that arrives at a place, per column of the environment.
inline double arrivingAt(const baker::VolumeTransfer& t, glm::dvec3 place, std::size_t block,
                         std::size_t output, std::size_t column) {
  const auto at = t.grid.stencil(t.grid.gridFromGroup(place), 0);
  double sum = 0.0;
  for (int k = 0; k < at.count; ++k)
    sum += at.weight[static_cast<std::size_t>(k)] *
           double{t.vectors[at.node[static_cast<std::size_t>(k)] * t.vectorSize() +
                            (block * t.outputs() + output) * t.columns() + column]};
  return sum;
}

// Returns the interpolated mean radiance at a place under uniform light of radiance 1, of isotropic
// scattering. block 0 is single scattering, block 1 all scattering.
inline double uniformAt(const baker::VolumeTransfer& t, glm::dvec3 place, std::size_t block,
                        std::size_t i = 0) {
  return kRoot4Pi * arrivingAt(t, place, block, 0, i);
}

}  // namespace lambent::testing
