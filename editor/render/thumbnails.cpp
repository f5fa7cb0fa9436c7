#include <algorithm>
#include <utility>

#include <epoxy/gl.h>

#include "editor/render/renderer.hpp"
#include "editor/session/assets.hpp"
#include "editor/session/materials.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/scene/materials.hpp"

namespace lambent::editor {

namespace {

// Returns whether the view shows the world as it is, and nothing is drawn over it.
bool isPlain(const Session& session) {
  const Viewing& viewing = session.viewing;
  return viewing.surfaces.view == frame::SurfaceView::Final && !viewing.overlays.any() &&
         session.selection.ids().empty() && session.atRest() && !viewing.scale.coarse();
}

// Returns the files of a scene whose contents are shown.
std::vector<Asset> filesOf(const SceneEntry& entry) {
  std::vector<Asset> files;
  if (auto source = assetAt(entry.source)) files.push_back(std::move(*source));
  if (entry.shown == entry.bundle)
    if (auto bundle = assetAt(entry.bundle)) files.push_back(std::move(*bundle));
  return files;
}

scene::Box boundsOf(const Session& session, std::uint32_t slot) {
  scene::Box box;
  for (const ecs::Entity draw : session.stage.world().instance(slot).draws)
    box.add(scene::drawBounds(session.document.registry(), draw));
  return box;
}

spec::Rgba8Image readBack(const gpu::Texture& view) {
  const gpu::TextureDesc& desc = view.desc();
  const std::size_t row = std::size_t{4} * desc.width;
  spec::Rgba8Image image{desc.width, desc.height, std::vector<std::uint8_t>(row * desc.height)};
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureImage(view.id(), 0, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(image.texels.size()),
                    image.texels.data());
  const auto at = [&](std::size_t y) { return image.texels.begin() + static_cast<std::ptrdiff_t>(y * row); };
  for (std::size_t y = 0; y < desc.height / 2; ++y)
    std::swap_ranges(at(y), at(y + 1), at(desc.height - 1 - y));
  return image;
}

spec::Rgba8Image cut(const spec::Rgba8Image& image, const PicturePart& part) {
  spec::Rgba8Image made{part.width, part.height, {}};
  for (std::size_t y = 0; y < part.height; ++y) {
    const std::size_t first = 4 * ((part.top + y) * image.width + part.left);
    const auto row = image.texels.begin() + static_cast<std::ptrdiff_t>(first);
    made.texels.insert(made.texels.end(), row,
                       row + static_cast<std::ptrdiff_t>(4 * std::size_t{part.width}));
  }
  return made;
}

}  // namespace

// The world and a scene that is open alone have all of the view. Of scenes beside others, those without a
// picture have the part around them.
std::vector<Thumbnails::Shown> Thumbnails::shownIn(Session& session, const spec::Size& size) {
  if (!isPlain(session)) return {};
  std::vector<Shown> shown;
  const PicturePart all{0, 0, size.width, size.height};
  if (!session.files.world().empty() && !session.files.modified())
    if (auto world = assetAt(session.files.world())) shown.push_back({std::move(*world), all});
  const auto& entries = session.scenes.entries();
  const bool alone = entries.size() == 1 && session.files.world().empty();
  for (const SceneEntry& entry : entries)
    for (Asset& file : filesOf(entry)) {
      if (alone)
        shown.push_back({std::move(file), all});
      else if (entry.slot && session.asset_pictures.lacks(file))
        if (const auto part = partWithBox(session.viewing.shown_view, size, boundsOf(session, *entry.slot)))
          shown.push_back({std::move(file), *part});
    }
  return shown;
}

void Thumbnails::takeFromView(Session& session, const gpu::Texture& view) {
  const std::vector<Shown> shown = shownIn(session, {view.desc().width, view.desc().height});
  if (shown.empty() || !taken_.renew(shown, session.scenes.version())) return;
  const spec::Rgba8Image image = readBack(view);
  for (const Shown& one : shown) session.asset_pictures.keep(one.asset, smallPictureOf(cut(image, one.part)));
}

void Thumbnails::update(Session& session, const gpu::Texture& view) {
  takeFromView(session, view);
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
