#include "baker/bake/group_scene.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "baker/bake/bake.hpp"
#include "baker/brdf/brdf.hpp"
#include "baker/cache/key.hpp"
#include "baker/plan/smooth_dielectrics.hpp"
#include "baker/trace/emitters.hpp"
#include "baker/transport/geometry_key.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/bundle/material_fields.hpp"

namespace lambent::baker {

namespace {

const gltf::Material* materialOf(const Scene& scene, const DrawGeometry& draw) {
  return draw.material < 0 ? nullptr : &scene.materials[static_cast<std::size_t>(draw.material)];
}

// The numbers, colours and flags of one part of a material. A measured BRDF counts by its measurements, which
// addReflection() adds, and not by its place in the list.
void addValues(const gltf::Material& material, gltf::MaterialPart part, KeyMaker& key) {
  gltf::forEachMaterialValue([&](const auto& field) {
    if (field.part == part && field.name != "brdf") key.add(material.*field.member);
  });
}

void addColors(const Scene& scene, const GroupGeometry& geometry, KeyMaker& key) {
  key.addText("colors").addList(geometry.texcoords).addList(geometry.colors);
  for (const DrawGeometry& draw : geometry.draws) {
    const gltf::Material* material = materialOf(scene, draw);
    key.add(material != nullptr);
    if (!material) continue;
    addValues(*material, gltf::MaterialPart::Color, key);
    key.add(draw.layered);
    if (draw.layered) key.add(meanSpecularAlbedo(*material)).add(material->roughness);
    gltf::forEachMaterialTexture([&](const auto& field) {  // texture coordinates are among the geometry's
      if (field.part == gltf::MaterialPart::Color) addTexture(scene, (material->*field.member).texture, key);
    });
  }
}

// Adds how glossy surfaces reflect (SurfaceBrdfs), beside their base colours.
void addReflection(const Scene& scene, const GroupGeometry& geometry, int order, KeyMaker& key) {
  bool any = false;
  for (const DrawGeometry& draw : geometry.draws) any |= draw.kind == SampleKind::Glossy;
  key.addText("reflection").add(any);
  if (!any) return;
  key.add(order).addList(geometry.texcoord_sets[0]).addList(geometry.texcoord_sets[1]);
  key.addList(geometry.tangents);
  for (const DrawGeometry& draw : geometry.draws) {
    const gltf::Material* m = materialOf(scene, draw);
    if (!m || draw.kind != SampleKind::Glossy) continue;
    addValues(*m, gltf::MaterialPart::Reflection, key);
    gltf::forEachMaterialTexture([&](const auto& field) {
      if (field.part == gltf::MaterialPart::Reflection) addTextureRef(scene, m->*field.member, key);
    });
    // Only the coordinates of the normal map count: they define the tangent.
    const gltf::TextureRef& normal = m->normal_texture;
    key.add(normal.texture >= 0, normal.texcoord, normal.offset, normal.scale, normal.rotation_rad,
            m->brdf >= 0);
    if (m->brdf >= 0) key.addList(scene.brdfs[static_cast<std::size_t>(m->brdf)].measurements);
  }
}

}  // namespace

GroupKeys groupKeys(const Scene& scene, const GroupGeometry& geometry, std::span<const PlannedLight> lights,
                    const PlannedGroup& planned, const BakeOptions& options) {
  GroupKeys keys;
  {
    KeyMaker key = KeyMaker::ofStage("light samples");
    addShape(geometry, key);
    keys.light_probes = key.add(planned.light_probes.count).add(planned.light_probes.of_group).key();
  }
  KeyMaker surfaces = KeyMaker::ofStage("surfaces");
  addShape(geometry, surfaces);
  addOpacity(scene, geometry, surfaces);
  addLights(scene, geometry, lights, surfaces);
  const Key seen = surfaces.key();
  addColors(scene, geometry, surfaces);
  const Key colored = surfaces.key();
  addReflection(scene, geometry, options.exitOrder(), surfaces);
  const Key reflecting = surfaces.key();

  KeyMaker proxy = KeyMaker::ofStage("proxy");
  addEyes(planned.cameras, proxy);
  keys.proxy = proxy.add(reflecting).key();
  KeyMaker rays = KeyMaker::ofStage("rays");
  addEyes(planned.cameras, rays);
  keys.rays =
      rays.add(seen, options.order, std::uint64_t{options.effectiveRays()}, planned.shadows, planned.bounces)
          .key();
  keys.glossy_rays = KeyMaker::ofStage("glossy rays").add(keys.rays, options.exitOrder()).key();
  keys.bounces = KeyMaker::ofStage("bounces")
                     .add(keys.glossy_rays, colored, reflecting, options.glossy_order, options.fitsDiffuse(),
                          options.fitsGlossy())
                     .key();
  KeyMaker cells = KeyMaker::ofStage("cells");
  for (const PlannedLight& light : lights) cells.add(light.color);  // errors are those of lamps as they are
  keys.cells =
      cells
          .add(keys.bounces, options.bounces, options.leavesNothingOut(), options.effectiveErrorBound(),
               options.picture_bound, options.error_bound > 0.0f, options.effectiveGlossyErrorBound())
          .key();
  return keys;
}

Key brdfTablesKey(const Scene& scene, int order, int shipped) {
  KeyMaker key = KeyMaker::ofStage("BRDF tables");
  key.add(order).add(shipped);
  for (const gltf::Material& material : scene.materials) {
    key.add(material.isDiffuse());
    if (material.isDiffuse()) continue;
    const bundle::BrdfFamily family = brdfKindOf(material).family;
    key.add(family);
    if (family != bundle::BrdfFamily::Measured) continue;
    // A measured BRDF's table may depend on all reflection values of its material.
    addValues(material, gltf::MaterialPart::Color, key);
    addValues(material, gltf::MaterialPart::Reflection, key);
    key.add(material.brdf);
    if (material.brdf < 0) continue;
    const MeasuredBrdf& brdf = scene.brdfs[static_cast<std::size_t>(material.brdf)];
    key.addText(brdf.name).addList(brdf.measurements);
  }
  return key.key();
}

// Computes the digest of a scene. With the settings recorded in the file it decides whether a bundle is up to
// date.

bundle::Generator generatorOf(const Scene& scene, const BakeOptions& options) {
  bundle::Generator generator{"lambent", LAMBENT_VERSION, LAMBENT_ISA, options.settings()};
  generator.settings["source"] = scene.source.filename().string();
  generator.settings["sourceDigest"] = fmt::format("{:016x}", sceneDigest(scene));
  return generator;
}

bool isUpToDate(const Scene& scene, const BakeOptions& options, const std::filesystem::path& output) {
  const auto reader = bundle::Reader::open(output);
  if (!reader || !reader->checkAll()) return false;
  const bundle::Generator& generator = reader->description().generator;
  const bundle::Generator wanted = generatorOf(scene, options);
  return generator.version == wanted.version && generator.isa == wanted.isa &&
         generator.settings == wanted.settings && reader->description().version == bundle::kVersionCurrent;
}

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
  auto rays = RayScene::build(geometry, bake.scene, inputs_.images);
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
  // Layers of smooth dielectrics pass light on.
  const bool layered = std::ranges::any_of(geometry.draws, &DrawGeometry::layered);
  if (!anyGlossy() && !(bounces() && layered)) return {};
  auto brdfs =
      SurfaceBrdfs::load(bake.scene, geometry, bake.tables, inputs_.images, bake.options.exitOrder());
  if (!brdfs) return failAgain(brdfs.error());
  brdfs_ = std::move(*brdfs);
  mirrors_.emplace(geometry, *rays_, *colors_, *brdfs_, !lights.empty());
  return {};
}

}  // namespace lambent::baker
