// The baker's first stages on a scene made in the test, without Draco: geometry, samples, rays, direct
// transfer.
#pragma once

#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "baker/effects/diffuse/direct.hpp"
#include "baker/plan/rigid_groups.hpp"
#include "baker/transport/ray_scene.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::testing {

struct Transport {
  baker::GroupGeometry geometry;
  baker::SampleSet samples;
  baker::RayScene rays;

  explicit Transport(const baker::Scene& scene) : Transport(scene, baker::findRigidGroups(scene).at(0)) {}

  baker::TransferField direct(int order = 5, std::size_t ray_count = 512) const {
    baker::Progress progress;
    auto field = baker::bakeDirect(geometry, samples, rays, {order, ray_count}, progress, {});
    EXPECT_TRUE(field.has_value());
    return std::move(*field);
  }

  // The sample whose position is nearest.
  std::size_t sampleAt(glm::vec3 position) const {
    std::size_t best = 0;
    for (std::size_t s = 1; s < samples.size(); ++s)
      if (glm::distance(samples.positions[s], position) < glm::distance(samples.positions[best], position))
        best = s;
    return best;
  }

 private:
  Transport(const baker::Scene& scene, const baker::RigidGroup& group)
      : geometry(baker::buildGroupGeometry(group, scene, decoded(scene))),
        samples(baker::buildSamples(geometry)),
        rays(build(geometry, scene)) {}

  static std::vector<std::vector<bundle::MeshData>> decoded(const baker::Scene& scene) {
    std::vector<std::vector<bundle::MeshData>> meshes;
    for (const baker::SceneMesh& mesh : scene.meshes) {
      meshes.emplace_back();
      for (const baker::ScenePrimitive& primitive : mesh.primitives) meshes.back().push_back(primitive.mesh);
    }
    return meshes;
  }

  static baker::RayScene build(const baker::GroupGeometry& geometry, const baker::Scene& scene) {
    auto maps = baker::loadAlphaMaps(scene);
    EXPECT_TRUE(maps.has_value());
    auto rays = baker::RayScene::build(geometry, scene, std::move(*maps));
    EXPECT_TRUE(rays.has_value());
    return std::move(*rays);
  }
};

// E/pi under uniform light of radiance 1.
inline float uniformRadiance(std::span<const float> transfer) {
  return transfer[0] * std::sqrt(4.0f * std::numbers::pi_v<float>);
}

}  // namespace lambent::testing
