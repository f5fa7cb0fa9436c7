// Imports glTF with its buffers inside, and bakes what can be baked by few rays. What a bake has written its
// reader accepts.
#include "baker/bake/bake.hpp"
#include "baker/cache/cache.hpp"
#include "baker/import/gltf.hpp"
#include "baker/jobs/progress.hpp"
#include "runtime/bundle/container.hpp"
#include "tests/fuzz/input_file.hpp"
#include "tests/fuzz/json_mutator.hpp"

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned seed) {
  return lambent::fuzz::mutateText(data, size, most, seed, /*blindly=*/16);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lambent;
  constexpr std::size_t kMostVertices = 2000, kMostNodes = 64;
  const auto scene = baker::importScene(fuzz::inputFile("scene.gltf", {data, size}));
  if (!scene || scene->nodes.size() > kMostNodes) return 0;
  std::size_t vertices = 0;
  for (const auto& mesh : scene->meshes)
    for (const auto& primitive : mesh.primitives) vertices += primitive.mesh.positions.size();
  if (vertices > kMostVertices) return 0;
  baker::BakeOptions options;
  options.quality = baker::Quality::Draft;
  options.order = 2;
  options.rays = 128;  // the fewest that a bake takes
  options.bounces = 1;
  options.refine_bound = 0.0f;
  // Tables of BRDFs, which take longer than all else, are kept.
  constexpr std::uint64_t kMostKept = std::uint64_t{64} << 20;
  static auto cache = baker::Cache::open(fuzz::keptFolder(), kMostKept);
  fuzz::require(cache.has_value(), "a cache is opened");
  baker::Progress progress;
  const auto output = fuzz::folder() / "scene.lmb.glb";
  if (const auto baked = baker::bake(*scene, options, output, {.progress = progress, .cache = &*cache});
      !baked)
    return 0;
  const auto reader = bundle::Reader::open(output);
  fuzz::require(reader.has_value(), "a bundle that was written is opened");
  const auto checked = reader->checkAll();
  fuzz::require(checked.has_value(), "a bundle that was written is read");
  return 0;
}
