#include "runtime/streaming/budget.hpp"

#include <variant>

#include "runtime/streaming/image_decode.hpp"
#include "runtime/streaming/sizes.hpp"
#include "runtime/streaming/work.hpp"

namespace lambent::streaming {

namespace {

// As many copies as residency will make of each image: at most two, one as colour and one as normals.
std::uint64_t copiesOf(const bundle::Description& d, std::size_t image) {
  bool color = false, normals = false;
  const auto names = [&](const gltf::TextureRef& reference) {
    return reference.texture >= 0 &&
           d.textures[static_cast<std::size_t>(reference.texture)].image == static_cast<std::int32_t>(image);
  };
  for (const gltf::Material& material : d.materials) {
    color |= names(material.base_color_texture) || names(material.emissive_texture);
    normals |= names(material.normal_texture);
  }
  return color && normals ? 2 : 1;
}

Result<std::uint64_t> textureBytes(const bundle::Reader& reader) {
  const bundle::Description& d = reader.description();
  std::uint64_t bytes = 0;
  for (std::size_t i = 0; i < d.images.size(); ++i) {
    const auto file = reader.readView(d.images[i].view);
    if (!file) return failAgain(file.error());
    const auto size = imageSize(*file, reader.path().string() + ": image \"" + d.images[i].name + "\"");
    if (!size) return failAgain(size.error());
    bytes += copiesOf(d, i) * size->rgbaBytes() * 4 / 3;
  }
  return bytes;
}

}  // namespace

Result<Budgeted> withinBudget(const bundle::Reader& reader, std::uint64_t max_bytes) {
  const Result<std::uint64_t> textures = textureBytes(reader);
  if (!textures) return failAgain(textures.error());
  const bundle::Description& whole = reader.description();
  Budgeted kept{whole, *textures};
  for (bundle::Group& group : kept.description.groups)
    for (bundle::Cell& cell : group.cells)
      for (bundle::CellTransfer& transfer : cell.transfers) transfer.planes.clear();
  kept.bytes += needsOf(kept.description).total();
  for (const Work& work : workList(whole)) {
    const auto* at = std::get_if<PlaneWork>(&work);
    if (at == nullptr) continue;
    const auto planesOf = [&](auto& description) -> auto& {
      return description.groups[at->group].cells[at->cell].transfers[at->transfer].planes;
    };
    const bundle::WeightPlane& plane = planesOf(whole)[at->plane];
    if (kept.bytes + planeBytes(plane) > max_bytes) break;
    kept.bytes += planeBytes(plane);
    planesOf(kept.description).push_back(plane);
  }
  return kept;
}

}  // namespace lambent::streaming
