// What accuracy costs in pass 0: error at the samples (relative RMS of shaded radiance over real lights)
// against the number of rays, beside the time. The truth is the same pass with many rays.
//   ray_error SCENE.glb [--truth=RAYS]
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "baker/bake/ship_meshes.hpp"
#include "baker/compress/cpca.hpp"
#include "baker/effects/diffuse/direct.hpp"
#include "baker/import/gltf.hpp"
#include "baker/transport/ray_scene.hpp"

int main(int argc, char** argv) {
  using namespace lambent::baker;
  if (argc < 2) {
    std::fprintf(stderr, "ray_error: no scene; give a .gltf or .glb file\n");
    return 2;
  }
  const std::size_t truth_rays =
      argc > 2 && std::strncmp(argv[2], "--truth=", 8) == 0 ? std::strtoul(argv[2] + 8, nullptr, 10) : 16384;
  const auto scene = importScene(argv[1]);
  if (!scene) {
    std::fprintf(stderr, "ray_error: %s\n", scene.error().line().c_str());
    return 1;
  }
  const auto groups = findRigidGroups(*scene);
  Progress progress;
  const auto meshes = shipMeshes(*scene, groups, 0.0f, progress, {});
  const GroupGeometry geometry = buildGroupGeometry(groups.at(0), *scene, meshes->decoded);
  const SampleSet samples = buildSamples(geometry);
  const auto rays = RayScene::build(geometry, *scene, *loadAlphaMaps(*scene));
  constexpr int kOrder = 5;
  lambent::bundle::TransferShape shape;
  shape.order = kOrder;
  const auto bakeWith = [&](std::size_t count) {
    return *bakeDirect(geometry, samples, *rays, {kOrder, count}, progress, {});
  };
  const TransferField truth = bakeWith(truth_rays);
  std::printf("%s: %zu samples, order %d, against %zu rays\n  rays   error   seconds\n", argv[1],
              samples.size(), kOrder, truth_rays);
  for (const std::size_t count : {128u, 256u, 512u, 1024u, 2048u, 4096u}) {
    const auto start = std::chrono::steady_clock::now();
    const TransferField field = bakeWith(count);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("%6zu  %5.2f %%  %7.2f\n", count,
                100.0 * radianceError(truth.vectors, field.vectors, shape), seconds);
  }
  return 0;
}
