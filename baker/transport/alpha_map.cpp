#include "baker/transport/alpha_map.hpp"

#include <map>

namespace lambent::baker {

Result<std::vector<std::shared_ptr<const AlphaMap>>> loadAlphaMaps(const Scene& scene) {
  std::vector<std::shared_ptr<const AlphaMap>> maps(scene.materials.size());
  std::map<std::int32_t, std::shared_ptr<const DecodedImage>> decoded;
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const gltf::Material& material = scene.materials[m];
    if (material.alpha_mode != gltf::AlphaMode::Mask) continue;
    auto map = std::make_shared<AlphaMap>();
    map->factor = material.base_color.w;
    map->cutoff = material.alpha_cutoff;
    if (const std::int32_t texture = material.base_color_texture.texture; texture >= 0) {
      const gltf::Texture& source = scene.textures[static_cast<std::size_t>(texture)];
      auto& image = decoded[source.image];
      if (!image) {
        auto pixels = decodeImage(scene.images[static_cast<std::size_t>(source.image)]);
        if (!pixels) return failAgain(pixels.error());
        image = std::make_shared<DecodedImage>(std::move(*pixels));
      }
      map->image = image;
      map->sampler = source.sampler;
    }
    maps[m] = std::move(map);
  }
  return maps;
}

}  // namespace lambent::baker
