// Computes the digest of a scene. With the settings recorded in the file it decides whether a bundle is up to
// date.
#include <fmt/format.h>

#include "baker/bake/bake.hpp"
#include "baker/cache/key.hpp"
#include "baker/transport/geometry_key.hpp"
#include "runtime/bundle/material_fields.hpp"
#include "runtime/bundle/reader.hpp"

namespace lambent::baker {

namespace {

void addField(const gltf::TextureRef& ref, KeyMaker& digest) {
  digest.add(ref.texture), digest.add(ref.texcoord);
  digest.add(ref.offset), digest.add(ref.scale), digest.add(ref.rotation_rad);
}
void addField(const std::string& text, KeyMaker& digest) {
  digest.addText(text);
}
template <PlainBytes T>
void addField(const T& value, KeyMaker& digest) {
  digest.add(value);
}

// Fields are added one by one, since the padding between them is undefined.
void addMaterial(const gltf::Material& material, KeyMaker& digest) {
  gltf::forEachMaterialField([&](const auto& field) { addField(material.*field.member, digest); });
}

void addCamera(const gltf::Camera& c, KeyMaker& digest) {
  digest.addText(c.name);
  digest.add(c.perspective);
  for (const float value : {c.yfov_rad, c.aspect, c.xmag, c.ymag, c.znear, c.zfar}) digest.add(value);
}

void addLight(const gltf::Light& light, KeyMaker& digest) {
  digest.addText(light.name);
  digest.add(light.type), digest.add(light.color), digest.add(light.intensity), digest.add(light.range_m);
  digest.add(light.inner_cone_rad), digest.add(light.outer_cone_rad);
}

void addAnimation(const gltf::Animation& animation, KeyMaker& digest) {
  digest.addText(animation.name);
  digest.add(animation.channels.size());
  for (const gltf::AnimationChannel& channel : animation.channels) {
    digest.add(channel.node), digest.add(channel.path), digest.add(channel.interpolation);
    digest.addList(channel.times_s);
    digest.addList(channel.values);
  }
}

void addNode(const gltf::Node& node, KeyMaker& digest) {
  digest.addText(node.name);
  digest.add(node.parent), digest.addList(node.children), digest.add(node.parent_from_node);
  digest.add(node.mesh), digest.add(node.camera), digest.add(node.light);
  digest.add(node.animated), digest.add(node.movable), digest.add(node.trs.has_value());
  if (!node.trs) return;
  const glm::quat& q = node.trs->rotation;
  digest.add(node.trs->translation), digest.add(glm::vec4(q.x, q.y, q.z, q.w)), digest.add(node.trs->scale);
}

void addVolume(const SceneVolume& volume, KeyMaker& digest) {
  digest.addText(volume.name);
  digest.add(volume.node), digest.add(volume.size);
  digest.addList(volume.density);
  digest.add(volume.node_from_grid), digest.add(volume.albedo), digest.add(volume.g);
}

}  // namespace

std::uint64_t sceneDigest(const Scene& scene) {
  KeyMaker digest;
  digest.addText(scene.source.filename().string());
  if (scene.origin != glm::dvec3(0.0)) digest.add(scene.origin);
  digest.add(scene.nodes.size());
  for (const gltf::Node& node : scene.nodes) addNode(node, digest);
  digest.addList(scene.roots);
  for (const SceneMesh& mesh : scene.meshes) {
    digest.addText(mesh.name);
    digest.add(mesh.primitives.size());
    for (const ScenePrimitive& primitive : mesh.primitives) {
      addMesh(primitive.mesh, digest);
      digest.add(primitive.material);
      if (primitive.texels > 0) digest.add(primitive.texels), digest.add(primitive.texel_set);
    }
  }
  for (const gltf::Material& material : scene.materials) addMaterial(material, digest);
  digest.add(scene.brdfs.size());
  for (const MeasuredBrdf& brdf : scene.brdfs) {
    digest.addText(brdf.name);
    digest.addList(brdf.measurements);
  }
  for (const gltf::Texture& texture : scene.textures) {
    digest.add(texture.image);
    digest.add(texture.sampler);
  }
  for (const SceneImage& image : scene.images) {
    digest.addText(image.name);
    digest.addText(image.mime_type);
    digest.addList(image.file_bytes);
  }
  for (const gltf::Camera& camera : scene.cameras) addCamera(camera, digest);
  digest.add(scene.lights.size());
  for (const gltf::Light& light : scene.lights) addLight(light, digest);
  digest.add(scene.animations.size());
  for (const gltf::Animation& animation : scene.animations) addAnimation(animation, digest);
  digest.add(scene.volumes.size());
  for (const SceneVolume& volume : scene.volumes) addVolume(volume, digest);
  digest.add(scene.neighborhoods.size());
  for (const NeighborhoodRequest& request : scene.neighborhoods)
    digest.add(request.node), digest.add(request.size), digest.add(request.extent);
  return digest.key().low;
}

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

}  // namespace lambent::baker
