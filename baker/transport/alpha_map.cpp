#include "baker/transport/alpha_map.hpp"

#include <utility>

namespace lambent::baker {

Result<AlphaMaps> loadAlphaMaps(const Scene& scene, DecodedImages& images) {
  AlphaMaps maps(scene.materials.size());
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const gltf::Material& material = scene.materials[m];
    if (material.alpha_mode != gltf::AlphaMode::Mask) continue;
    auto map = std::make_shared<AlphaMap>();
    map->factor = material.base_color.w;
    map->cutoff = material.alpha_cutoff;
    const std::int32_t texture = material.base_color_texture.texture;
    auto image = images.ofTexture(texture);
    if (!image) return failAgain(image.error());
    map->image = std::move(*image);
    if (map->image) map->sampler = scene.textures[static_cast<std::size_t>(texture)].sampler;
    maps[m] = std::move(map);
  }
  return maps;
}

}  // namespace lambent::baker
