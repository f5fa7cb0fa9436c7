#include "editor/render/thumbnails.hpp"

#include <algorithm>

namespace lambent::editor {

void Thumbnails::update(EnvironmentMapShelf& shelf) {
  auto& maps = shelf.environment_maps();
  std::erase_if(textures_, [&](const auto& texture) {
    return std::ranges::find(maps, texture.first, &EnvironmentMapShelf::EnvironmentMap::file) == maps.end();
  });
  for (EnvironmentMapShelf::EnvironmentMap& map : maps) {
    if (map.texture != 0 || map.thumbnail.texels.empty()) continue;
    const spec::Rgba8Image& image = map.thumbnail;
    gpu::Texture texture("thumbnail", {.format = GL_RGBA8, .width = image.width, .height = image.height});
    glTextureSubImage2D(texture.id(), 0, 0, 0, static_cast<GLsizei>(image.width),
                        static_cast<GLsizei>(image.height), GL_RGBA, GL_UNSIGNED_BYTE, image.texels.data());
    map.texture = texture.id();
    textures_[map.file] = std::move(texture);
  }
}

}  // namespace lambent::editor
