#include "baker/bake/group_keys.hpp"

#include "baker/brdf/brdf_kinds.hpp"
#include "baker/plan/smooth_dielectrics.hpp"
#include "baker/trace/emitters.hpp"
#include "baker/transport/geometry_key.hpp"
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
    key.add(normal.texture >= 0).add(normal.texcoord).add(normal.offset).add(normal.scale);
    key.add(normal.rotation_rad).add(m->brdf >= 0);
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
  keys.rays = rays.add(seen)
                  .add(options.order)
                  .add(std::uint64_t{options.effectiveRays()})
                  .add(planned.shadows)
                  .add(planned.bounces)
                  .key();
  keys.glossy_rays = KeyMaker::ofStage("glossy rays").add(keys.rays).add(options.exitOrder()).key();
  keys.bounces = KeyMaker::ofStage("bounces")
                     .add(keys.glossy_rays)
                     .add(colored)
                     .add(reflecting)
                     .add(options.glossy_order)
                     .add(options.fitsDiffuse())
                     .add(options.fitsGlossy())
                     .key();
  KeyMaker cells = KeyMaker::ofStage("cells");
  for (const PlannedLight& light : lights) cells.add(light.color);  // errors are those of lamps as they are
  keys.cells = cells.add(keys.bounces)
                   .add(options.bounces)
                   .add(options.leavesNothingOut())
                   .add(options.effectiveErrorBound())
                   .add(options.picture_bound)
                   .add(options.error_bound > 0.0f)
                   .add(options.effectiveGlossyErrorBound())
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

}  // namespace lambent::baker
