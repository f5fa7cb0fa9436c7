#include "editor/render/thumbnails.hpp"

#include <algorithm>
#include <utility>

#include "editor/session/small_pictures.hpp"

namespace lambent::editor {

namespace {

// Returns the files whose contents the view shows and nothing else: the world, or the only scene with its
// bundle. There are none while something is drawn over them.
std::vector<Asset> shownAlone(const Session& session) {
  const Viewing& viewing = session.viewing;
  const bool plain = viewing.surfaces.view == frame::SurfaceView::Final && !viewing.overlays.any() &&
                     session.selection.ids().empty();
  if (!plain || !session.atRest() || viewing.scale.coarse()) return {};
  std::vector<Asset> shown;
  const auto add = [&](const std::filesystem::path& file) {
    if (auto asset = assetAt(file)) shown.push_back(std::move(*asset));
  };
  if (!session.files.world().empty()) {
    if (!session.files.modified()) add(session.files.world());
  } else if (session.scenes.entries().size() == 1) {
    const SceneEntry& entry = session.scenes.entries().front();
    add(entry.source);
    if (entry.shown == entry.bundle) add(entry.bundle);
  }
  return shown;
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

}  // namespace

void Thumbnails::takeFromView(Session& session, const gpu::Texture& view) {
  const std::vector<Asset> shown = shownAlone(session);
  if (shown.empty() || !taken_.renew(shown, session.scenes.version())) return;
  const spec::Rgba8Image small = smallPictureOf(readBack(view));
  for (const Asset& asset : shown) session.asset_pictures.keep(asset, small);
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

}  // namespace lambent::editor
