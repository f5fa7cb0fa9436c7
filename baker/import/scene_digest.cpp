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
  for (const gltf::Node& node : scene.nodes) {
    digest.addText(node.name).add(node.parent).addList(node.children);
    digest.add(node.parent_from_node, node.mesh, node.camera, node.light, node.animated, node.movable,
               node.trs.has_value());
    if (!node.trs) continue;
    const glm::quat& q = node.trs->rotation;
    digest.add(node.trs->translation, glm::vec4(q.x, q.y, q.z, q.w), node.trs->scale);
  }
  digest.addList(scene.roots);
  for (const SceneMesh& mesh : scene.meshes) {
    digest.addText(mesh.name).add(mesh.primitives.size());
    for (const ScenePrimitive& primitive : mesh.primitives) {
      addMesh(primitive.mesh, digest);
      digest.add(primitive.material);
      if (primitive.texels > 0) digest.add(primitive.texels, primitive.texel_set);
    }
  }
  // Fields are added one by one, since the padding between them is undefined.
  for (const gltf::Material& material : scene.materials)
    gltf::forEachMaterialField([&](const auto& field) { addField(material.*field.member, digest); });
  digest.add(scene.brdfs.size());
  for (const MeasuredBrdf& brdf : scene.brdfs) digest.addText(brdf.name).addList(brdf.measurements);
  for (const gltf::Texture& texture : scene.textures) digest.add(texture.image, texture.sampler);
  for (const SceneImage& image : scene.images)
    digest.addText(image.name).addText(image.mime_type).addList(image.file_bytes);
  for (const gltf::Camera& c : scene.cameras)
    digest.addText(c.name).add(c.perspective, c.yfov_rad, c.aspect, c.xmag, c.ymag, c.znear, c.zfar);
  digest.add(scene.lights.size());
  for (const gltf::Light& light : scene.lights)
    digest.addText(light.name)
        .add(light.type, light.color, light.intensity, light.range_m, light.inner_cone_rad,
             light.outer_cone_rad);
  digest.add(scene.animations.size());
  for (const gltf::Animation& animation : scene.animations) {
    digest.addText(animation.name).add(animation.channels.size());
    for (const gltf::AnimationChannel& channel : animation.channels)
      digest.add(channel.node, channel.path, channel.interpolation)
          .addList(channel.times_s)
          .addList(channel.values);
  }
  digest.add(scene.volumes.size());
  for (const SceneVolume& volume : scene.volumes) {
    digest.addText(volume.name).add(volume.node, volume.size).addList(volume.density);
    digest.add(volume.node_from_grid, volume.albedo, volume.g);
  }
  digest.add(scene.neighborhoods.size());
  for (const NeighborhoodRequest& request : scene.neighborhoods)
    digest.add(request.node, request.size, request.extent);
  return digest.key().low;
}

}  // namespace lambent::baker
