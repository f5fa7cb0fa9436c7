#include "baker/import/scene_digest.hpp"

#include "runtime/bundle/material_fields.hpp"

namespace lambent::baker {

namespace {

void addField(const gltf::TextureRef& ref, KeyMaker& digest) {
  digest.add(ref.texture, ref.texcoord, ref.offset, ref.scale, ref.rotation_rad);
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
  digest.add(c.perspective, c.yfov_rad, c.aspect, c.xmag, c.ymag, c.znear, c.zfar);
}

void addLight(const gltf::Light& light, KeyMaker& digest) {
  digest.addText(light.name);
  digest.add(light.type, light.color, light.intensity, light.range_m, light.inner_cone_rad,
             light.outer_cone_rad);
}

void addAnimation(const gltf::Animation& animation, KeyMaker& digest) {
  digest.addText(animation.name);
  digest.add(animation.channels.size());
  for (const gltf::AnimationChannel& channel : animation.channels) {
    digest.add(channel.node, channel.path, channel.interpolation);
    digest.addList(channel.times_s).addList(channel.values);
  }
}

void addNode(const gltf::Node& node, KeyMaker& digest) {
  digest.addText(node.name);
  digest.add(node.parent).addList(node.children);
  digest.add(node.parent_from_node, node.mesh, node.camera, node.light, node.animated, node.movable,
             node.trs.has_value());
  if (!node.trs) return;
  const glm::quat& q = node.trs->rotation;
  digest.add(node.trs->translation, glm::vec4(q.x, q.y, q.z, q.w), node.trs->scale);
}

void addVolume(const SceneVolume& volume, KeyMaker& digest) {
  digest.addText(volume.name);
  digest.add(volume.node, volume.size).addList(volume.density);
  digest.add(volume.node_from_grid, volume.albedo, volume.g);
}

}  // namespace

void addMesh(const bundle::MeshData& mesh, KeyMaker& key) {
  key.addList(mesh.positions).addList(mesh.normals).addList(mesh.normal_weights);
  key.addList(mesh.texcoords0).addList(mesh.texcoords1);
  key.addList(mesh.colors).addList(mesh.tangents).addList(mesh.indices);
}

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
      if (primitive.texels > 0) digest.add(primitive.texels, primitive.texel_set);
    }
  }
  for (const gltf::Material& material : scene.materials) addMaterial(material, digest);
  digest.add(scene.brdfs.size());
  for (const MeasuredBrdf& brdf : scene.brdfs) {
    digest.addText(brdf.name).addList(brdf.measurements);
  }
  for (const gltf::Texture& texture : scene.textures) {
    digest.add(texture.image, texture.sampler);
  }
  for (const SceneImage& image : scene.images) {
    digest.addText(image.name).addText(image.mime_type).addList(image.file_bytes);
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
    digest.add(request.node, request.size, request.extent);
  return digest.key().low;
}

}  // namespace lambent::baker
