#include "runtime/streaming/image_uses.hpp"

#include <algorithm>

#include "runtime/bundle/material_fields.hpp"

namespace lambent::streaming {

namespace {

std::vector<bool> reflectingMaterials(const bundle::Description& description) {
  std::vector<bool> glossy(description.materials.size(), false);
  for (const bundle::Draw& draw : description.draws) {
    const std::int32_t material = description.meshes[draw.mesh].primitives[draw.primitive].material;
    if (material >= 0 && (draw.glossy() || bundle::isLayered(description, draw)))
      glossy[static_cast<std::size_t>(material)] = true;
  }
  return glossy;
}

}  // namespace

std::vector<ImageUse> imageUses(const bundle::Description& description) {
  std::vector<ImageUse> uses(description.images.size());
  const auto read = [&](const gltf::TextureRef& reference, bool ImageUse::*as) {
    if (reference.texture < 0) return;
    const std::int32_t image = description.textures[static_cast<std::size_t>(reference.texture)].image;
    if (image >= 0) uses[static_cast<std::size_t>(image)].*as = true;
  };
  const std::vector<bool> glossy = reflectingMaterials(description);
  for (std::size_t i = 0; i < description.materials.size(); ++i) {
    const gltf::Material& material = description.materials[i];
    gltf::forEachMaterialTexture([&](const auto& field) {
      if (field.part == gltf::MaterialPart::Reflection && !glossy[i]) return;
      read(material.*field.member, field.color_texture ? &ImageUse::color : &ImageUse::linear);
    });
  }
  for (ImageUse& use : uses) use.color |= !use.linear;
  return uses;
}

std::vector<std::uint32_t> imagesOf(const bundle::Description& description, std::int32_t material) {
  std::vector<std::uint32_t> images;
  if (material < 0) return images;
  const gltf::Material& of = description.materials[static_cast<std::size_t>(material)];
  gltf::forEachMaterialTexture([&](const auto& field) {
    const gltf::TextureRef& reference = of.*field.member;
    if (reference.texture < 0) return;
    const std::int32_t image = description.textures[static_cast<std::size_t>(reference.texture)].image;
    if (image >= 0 && std::ranges::find(images, static_cast<std::uint32_t>(image)) == images.end())
      images.push_back(static_cast<std::uint32_t>(image));
  });
  return images;
}

}  // namespace lambent::streaming
