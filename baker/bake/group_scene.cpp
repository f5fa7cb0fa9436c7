#include "baker/bake/group_scene.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace lambent::baker {

namespace {

// The runtime holds what it shades of a group's samples in one page: a vec4 for each output of each sample.
// An OpenGL driver may have pages of 128 MiB.
constexpr std::uint64_t kMostBytesShaded = std::uint64_t{128} << 20;
std::uint64_t bytesShaded(const SampleSet& samples, int glossy_order) {
  const std::uint64_t outputs =
      static_cast<std::uint64_t>(glossy_order) * static_cast<std::uint64_t>(glossy_order);
  return 16 * (samples.diffuse.size() + transfer::kMappedOutputs * samples.normal_mapped.size() +
               outputs * samples.glossy.size());
}

}  // namespace

std::size_t mostGlossySamples(int glossy_order) {
  return kMostBytesShaded /
         (16u * static_cast<std::size_t>(glossy_order) * static_cast<std::size_t>(glossy_order));
}

GroupScene::GroupScene(const SceneBake& of, const SurfaceInputs& inputs, std::size_t at,
                       const BakeContext& context)
    : bake(of), index(at), group(of.plan.groups[at]), inputs_(inputs) {
  context.progress.begin("samples");
  const auto place = [&](bool with_glossy) {
    geometry = buildGroupGeometry(group, bake.scene, inputs.meshes.decoded, with_glossy);
    samples = buildSamples(geometry);
  };
  place(!bake.tables.entries.empty());
  if (const std::uint64_t bytes = bytesShaded(samples, bake.options.glossy_order);
      anyGlossy() && bytes > kMostBytesShaded) {
    notices.push_back(
        fmt::format("rigid group \"{}\": {} glossy samples take {} MiB on the GPU, more than the {} MiB that "
                    "one piece may have; its surfaces have diffuse transfer and mirror little but the sky. "
                    "Part it into several groups (extras.lambent.movable), or lower --glossy-order",
                    group.name, samples.glossy.size(), bytes >> 20, kMostBytesShaded >> 20));
    place(/*with_glossy=*/false);
  }
  for (std::size_t d = 0; d < group.draws.size(); ++d) {
    const PlannedDraw& draw = group.draws[d];
    if (bake.scene.meshes[draw.mesh].primitives[draw.primitive].texels > 0 && geometry.draws[d].texels == 0)
      notices.push_back(fmt::format(
          "mesh \"{}\", primitive {}: is glossy or has a normal map, so texture_transfer is left out and it "
          "keeps transfer at vertices; give it a diffuse material without a normal map",
          bake.scene.meshes[draw.mesh].name, draw.primitive));
  }
  lights = findGroupLights(bake.scene, group);
  cameras_ = cameraEyes(bake.scene, group, geometry);
  if (context.cache)
    keys = groupKeys(bake.scene, geometry, lights,
                     {bake.plan.light_probes[index].count, transport().shadows, bounces(), cameras_},
                     bake.options);
}

bool GroupScene::anyLayered() const {
  return std::ranges::any_of(geometry.draws, [](const DrawGeometry& draw) { return draw.layered; });
}

Result<void> GroupScene::loadColors() {
  if (colors_) return {};
  auto loaded = SurfaceColors::load(bake.scene, geometry, lights, inputs_.images);
  if (!loaded) return failAgain(loaded.error());
  colors_ = std::move(*loaded);
  return {};
}

Result<void> GroupScene::findImportance(const BakeContext& context) {
  if (rays_) return {};
  context.progress.begin("hierarchy");
  auto rays = RayScene::build(geometry, bake.scene, inputs_.alpha_maps);
  if (!rays) return failAgain(rays.error());
  rays_ = std::move(*rays);
  context.progress.begin("importance");
  importance_ = Importance(geometry, *rays_, cameras_);
  return {};
}

Result<void> GroupScene::prepareRays(const BakeContext& context) {
  if (auto loaded = loadColors(); !loaded) return loaded;
  if (auto found = findImportance(context); !found) return found;
  sample_importance_ = importance_.ofSamples(samples);
  if (!anyGlossy() && !(bounces() && anyLayered())) return {};
  auto brdfs =
      SurfaceBrdfs::load(bake.scene, geometry, bake.tables, inputs_.images, bake.options.exitOrder());
  if (!brdfs) return failAgain(brdfs.error());
  brdfs_ = std::move(*brdfs);
  mirrors_.emplace(geometry, *rays_, *colors_, *brdfs_, !lights.empty());
  return {};
}

}  // namespace lambent::baker
