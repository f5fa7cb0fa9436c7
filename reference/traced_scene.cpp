#include "reference/traced_scene.hpp"

namespace lambent::baker::reference {

TracedScene::TracedScene(const Scene& scene, Surfaces surfaces)
    : surfaces_(std::move(surfaces)),
      emissive_(surfaces_),
      punctual_(punctualLights(scene)),
      volumes_(Volumes::build(scene, notices_)),
      rays_(RayTracer::build(surfaces_)) {}

Result<std::unique_ptr<const TracedScene>> TracedScene::build(const Scene& scene) {
  auto surfaces = Surfaces::build(scene);
  if (!surfaces) return failAgain(std::move(surfaces.error()));
  std::unique_ptr<TracedScene> traced(new TracedScene(scene, std::move(*surfaces)));
  if (!traced->rays_) return failAgain(std::move(traced->rays_.error()));
  return traced;
}

World TracedScene::under(const Environment& environment, const std::vector<spec::LocalLight>& shapes,
                         const EyeRays& eye) const {
  return {.surfaces = surfaces_,
          .rays = *rays_,
          .environment = environment,
          .emissive = emissive_,
          .punctual = punctual_,
          .shapes = shapes,
          .volumes = volumes_,
          .eye = eye};
}

}  // namespace lambent::baker::reference
