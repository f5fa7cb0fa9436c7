#include <utility>

#include <epoxy/gl.h>

#include "editor/render/renderer.hpp"
#include "editor/session/assets.hpp"
#include "editor/session/materials.hpp"
#include "runtime/scene/materials.hpp"

namespace lambent::editor {

void Thumbnails::update(Session& session) {
  auto& pictures = session.asset_pictures.pictures();
  std::erase_if(textures_, [&](const auto& texture) { return !pictures.contains(texture.first); });
  for (auto& [file, picture] : pictures) {
    if (picture.image.texels.empty()) continue;
    const spec::Rgba8Image image = std::exchange(picture.image, {});
    gpu::Texture texture("thumbnail", {.format = GL_RGBA8, .width = image.width, .height = image.height});
    glTextureSubImage2D(texture.id(), 0, 0, 0, static_cast<GLsizei>(image.width),
                        static_cast<GLsizei>(image.height), GL_RGBA, GL_UNSIGNED_BYTE, image.texels.data());
    picture.texture = texture.id();
    picture.aspect = static_cast<float>(image.width) / static_cast<float>(image.height);
    textures_[file] = std::move(texture);
  }
}

namespace {

constexpr std::uint32_t kPreviewPixels = 64;

// Returns the textures that the material of the file names, with the pictures that have arrived.
std::vector<MaterialPictures::Texture> texturesOf(const Session& session,
                                                  const scene::MaterialComponent& component) {
  std::vector<MaterialPictures::Texture> found;
  const bundle::Description& description = session.stage.world().description(component.bundle);
  const streaming::ResidentBundle& resident = session.stage.world().residency().bundles()[component.bundle];
  gltf::forEachMaterialField([&](const auto& field) {
    if constexpr (std::is_same_v<typename std::remove_cvref_t<decltype(field)>::Value, gltf::TextureRef>) {
      const gltf::TextureRef& reference = description.materials[component.material].*field.member;
      if (reference.texture < 0) return;
      const std::int32_t image = description.textures[static_cast<std::size_t>(reference.texture)].image;
      if (image < 0) return;
      MaterialPictures::Texture& texture = found.emplace_back();
      texture.use = field.name;
      texture.name = description.images[static_cast<std::size_t>(image)].name;
      const auto& images = field.color_texture ? resident.images : resident.linear_images;
      if (static_cast<std::size_t>(image) >= images.size() || !images[static_cast<std::size_t>(image)])
        return;
      const gpu::Texture& arrived = images[static_cast<std::size_t>(image)];
      texture.picture = arrived.id();
      texture.width = arrived.desc().width, texture.height = arrived.desc().height;
      // Panels show the texels as they are. Surfaces have samplers of their own, which decode them.
      if (epoxy_has_gl_extension("GL_EXT_texture_sRGB_decode"))
        glTextureParameteri(arrived.id(), GL_TEXTURE_SRGB_DECODE_EXT, GL_SKIP_DECODE_EXT);
    }
  });
  return found;
}

}  // namespace

void MaterialPainter::update(Session& session) {
  MaterialPictures& pictures = session.material_pictures;
  const ecs::Registry& registry = session.document.registry();
  pictures.of.clear();
  std::erase_if(previews_, [&](const auto& preview) { return !pictures.wanted.contains(preview.first); });
  for (const ecs::Entity entity : pictures.wanted) {
    const auto* component = registry.tryGet<scene::MaterialComponent>(entity);
    if (!component || !session.stage.world().isOpen(component->bundle)) continue;
    Preview& preview = previews_[entity];
    const std::uint64_t version = registry.version<scene::MaterialComponent>(entity);
    if (!preview.texture || preview.version != version) {
      const spec::Rgba8Image image = previewOf(*component, kPreviewPixels);
      if (!preview.texture)
        preview.texture = gpu::Texture("material preview",
                                       {.format = GL_RGBA8, .width = image.width, .height = image.height});
      glTextureSubImage2D(preview.texture.id(), 0, 0, 0, static_cast<GLsizei>(image.width),
                          static_cast<GLsizei>(image.height), GL_RGBA, GL_UNSIGNED_BYTE, image.texels.data());
      preview.version = version;
    }
    pictures.of[entity] = {preview.texture.id(), texturesOf(session, *component)};
  }
  pictures.wanted.clear();
}

}  // namespace lambent::editor
