// Loads the first rigid group of a scene with everything that the diffuse effect reads, as a bake makes it.
// Errors end the program.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "baker/bake/ship_meshes.hpp"
#include "baker/effects/surface/bounces.hpp"
#include "baker/import/gltf.hpp"
#include "baker/transport/ray_scene.hpp"

struct GroupWorkload {
  lambent::baker::Scene scene;
  lambent::baker::GroupGeometry geometry;
  lambent::baker::SampleSet samples;
  std::vector<lambent::baker::PlannedLight> lights;
  std::unique_ptr<lambent::baker::RayScene> rays;
  std::unique_ptr<lambent::baker::SurfaceColors> colors;

  lambent::baker::TracedScene view() const { return {scene, geometry, samples, *rays, *colors, lights}; }
};

template <typename T>
T orExit(lambent::Result<T> result) {
  if (!result) {
    std::fprintf(stderr, "%s\n", result.error().line().c_str());
    std::exit(1);
  }
  return std::move(*result);
}

// The result is a pointer because colours refer to the geometry. `change_scene` may change the scene as read,
// `change_geometry` the geometry as built.
inline std::unique_ptr<GroupWorkload> loadGroup(
    const std::string& file, const std::function<void(lambent::baker::Scene&)>& change_scene = {},
    const std::function<void(lambent::baker::GroupGeometry&)>& change_geometry = {},
    bool with_glossy = false) {
  using namespace lambent::baker;
  auto work = std::make_unique<GroupWorkload>();
  work->scene = orExit(importScene(file));
  if (change_scene) change_scene(work->scene);
  const auto groups = findRigidGroups(work->scene);
  Progress progress;
  const auto meshes =
      orExit(shipMeshes(work->scene, groups, orExit(splitMeshes(work->scene, groups, 0.0f)), {progress}));
  work->geometry = buildGroupGeometry(groups.at(0), work->scene, meshes.decoded, with_glossy);
  if (change_geometry) change_geometry(work->geometry);
  work->samples = buildSamples(work->geometry);
  work->lights = findGroupLights(work->scene, groups.at(0));
  DecodedImages images(work->scene);
  work->rays = std::make_unique<RayScene>(orExit(RayScene::build(work->geometry, work->scene, images)));
  work->colors = std::make_unique<SurfaceColors>(
      orExit(SurfaceColors::load(work->scene, work->geometry, work->lights, images)));
  return work;
}
