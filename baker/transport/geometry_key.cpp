#include "baker/transport/geometry_key.hpp"

namespace lambent::baker {

namespace {

template <typename T>
std::span<const T> ofDraw(const std::vector<T>& of_vertices, const DrawGeometry& draw) {
  return std::span(of_vertices).subspan(draw.first_vertex, draw.vertex_count);
}

}  // namespace

void addShape(const GroupGeometry& geometry, KeyMaker& key) {
  key.addText("shape");
  key.addList(geometry.positions).addList(geometry.normals).addList(geometry.normal_weights);
  key.addList(geometry.triangles);
  key.add(std::uint64_t{geometry.draws.size()});
  for (const DrawGeometry& draw : geometry.draws) {
    key.add(draw.first_vertex).add(draw.vertex_count).add(draw.first_triangle).add(draw.triangle_count);
    key.add(draw.back).add(draw.kind);
    if (draw.texels > 0) key.add(draw.texels).addList(ofDraw(geometry.chart_coordinates, draw));
  }
}

void addOpacity(const Scene& scene, const GroupGeometry& geometry, KeyMaker& key) {
  key.addText("opacity");
  for (const DrawGeometry& draw : geometry.draws) {
    key.add(draw.material >= 0);
    if (draw.material < 0) continue;
    const gltf::Material& material = scene.materials[static_cast<std::size_t>(draw.material)];
    key.add(material.double_sided).add(material.alpha_mode).add(material.transmits());
    if (material.transmits()) {
      key.add(material.passedStraightOn()).add(glm::vec3(material.base_color)).add(material.thickness_m);
      key.add(material.attenuation_distance_m).add(material.attenuation_color);
      addTextureRef(scene, material.transmission_texture, key);
    }
    if (material.alpha_mode == gltf::AlphaMode::Mask)
      key.add(material.alpha_cutoff).add(material.base_color.w);
    else if (!material.transmits())
      continue;
    addTexture(scene, material.base_color_texture.texture, key);
    key.addList(ofDraw(geometry.texcoords, draw)).addList(ofDraw(geometry.colors, draw));
  }
}

void addTexture(const Scene& scene, std::int32_t texture, KeyMaker& key) {
  key.add(texture >= 0);
  if (texture < 0) return;
  const gltf::Texture& source = scene.textures[static_cast<std::size_t>(texture)];
  key.add(source.sampler.wrap_s).add(source.sampler.wrap_t);
  key.add(source.sampler.mag_filter).add(source.sampler.min_filter);
  key.add(source.image >= 0);
  if (source.image < 0) return;
  const SceneImage& image = scene.images[static_cast<std::size_t>(source.image)];
  key.addText(image.mime_type).addList(image.file_bytes);
}

void addTextureRef(const Scene& scene, const gltf::TextureRef& ref, KeyMaker& key) {
  addTexture(scene, ref.texture, key);
  key.add(ref.texcoord).add(ref.offset).add(ref.scale).add(ref.rotation_rad);
}

}  // namespace lambent::baker
