// Runs the baker's first stages (geometry, samples, rays, transfer) on a scene made in the test, without
// Draco.
#pragma once

#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "baker/effects/surface/bounces.hpp"
#include "baker/effects/surface/direct.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/plan/rigid_groups.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::testing {

inline glm::mat3 upright() {
  return glm::mat3(baker::localFrame({0, 1, 0}));
}

struct Transport {
  baker::Scene scene;
  std::vector<baker::PlannedLight> lights;
  baker::GroupGeometry geometry;
  baker::SampleSet samples;
  baker::RayScene rays;
  baker::SurfaceColors colors;
  const baker::MirrorPaths* mirrors = nullptr;  // set by tests whose rays follow mirrors

  // with_glossy: surfaces that are not diffuse get glossy samples.
  explicit Transport(const baker::Scene& from, bool with_glossy = false)
      : Transport(from, baker::findRigidGroups(from).at(0), with_glossy) {}
  Transport(const Transport&) = delete;  // colors refers to geometry
  Transport& operator=(const Transport&) = delete;

  baker::TracedScene diffuse() const { return {scene, geometry, samples, rays, colors, lights, mirrors}; }

  baker::TransferField direct(int order = 5, std::size_t ray_count = 512) const {
    return bake(order, ray_count, /*bounces=*/0).direct.field;
  }

  struct Baked {
    baker::DirectResult direct;
    baker::BounceResult bounced;  // the sums of all passes
  };
  // A negative number of bounces means as many as tail_error needs.
  Baked bake(int order, std::size_t ray_count, int bounces, double tail_error = 1e-3,
             std::size_t hit_memory = std::size_t{1} << 30) const {
    const baker::TracedScene view = diffuse();
    const baker::DirectPass pass(
        view, {.order = order, .rays = ray_count, .keep_hits = bounces != 0, .hit_memory = hit_memory});
    baker::Progress progress;
    auto first = baker::bakeDirect(pass, {progress});
    EXPECT_TRUE(first.has_value());
    if (bounces == 0) return {std::move(*first), {}};
    auto rest = baker::bakeBounces({pass, *first}, {bounces, tail_error}, {progress});
    EXPECT_TRUE(rest.has_value());
    return {std::move(*first), std::move(*rest)};
  }

  // Returns the sample with the nearest position.
  std::size_t sampleAt(glm::vec3 position) const {
    std::size_t best = 0;
    for (std::size_t s = 1; s < samples.size(); ++s)
      if (glm::distance(samples.positions[s], position) < glm::distance(samples.positions[best], position))
        best = s;
    return best;
  }

 private:
  Transport(const baker::Scene& from, const baker::RigidGroup& group, bool with_glossy)
      : scene(from),
        lights(baker::findGroupLights(from, group)),
        geometry(baker::buildGroupGeometry(group, from, decoded(from), with_glossy)),
        samples(baker::buildSamples(geometry)),
        rays(build(geometry, from)),
        colors(load(from, geometry, lights)) {}

  static baker::SurfaceColors load(const baker::Scene& scene, const baker::GroupGeometry& geometry,
                                   const std::vector<baker::PlannedLight>& lights) {
    baker::DecodedImages images(scene);
    auto colors = baker::SurfaceColors::load(scene, geometry, lights, images);
    EXPECT_TRUE(colors.has_value());
    return std::move(*colors);
  }

  static std::vector<std::vector<bundle::MeshData>> decoded(const baker::Scene& scene) {
    std::vector<std::vector<bundle::MeshData>> meshes;
    for (const baker::SceneMesh& mesh : scene.meshes) {
      meshes.emplace_back();
      for (const baker::ScenePrimitive& primitive : mesh.primitives) meshes.back().push_back(primitive.mesh);
    }
    return meshes;
  }

  static baker::RayScene build(const baker::GroupGeometry& geometry, const baker::Scene& scene) {
    baker::DecodedImages images(scene);
    auto rays = baker::RayScene::build(geometry, scene, images);
    EXPECT_TRUE(rays.has_value());
    return std::move(*rays);
  }
};

// Returns E/pi under uniform light of radiance 1.
inline float uniformRadiance(std::span<const float> transfer) {
  return transfer[0] * std::sqrt(4.0f * std::numbers::pi_v<float>);
}

}  // namespace lambent::testing
