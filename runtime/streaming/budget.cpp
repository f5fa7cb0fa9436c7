#include "runtime/streaming/budget.hpp"

#include <variant>

#include "runtime/streaming/brdf_texture.hpp"
#include "runtime/streaming/image_decode.hpp"
#include "runtime/streaming/image_uses.hpp"
#include "runtime/streaming/sizes.hpp"
#include "runtime/streaming/work.hpp"

namespace lambent::streaming {

namespace {

Result<std::uint64_t> textureBytes(const bundle::Reader& reader) {
  const bundle::Description& d = reader.description();
  std::uint64_t bytes = 0;
  const std::vector<ImageUse> uses = imageUses(d);
  for (std::size_t i = 0; i < d.images.size(); ++i) {
    const auto file = reader.readView(d.images[i].view);
    if (!file) return failAgain(file.error());
    const auto size = imageSize(*file, reader.path().string() + ": image \"" + d.images[i].name + "\"");
    if (!size) return failAgain(size.error());
    bytes += uses[i].copies() * size->rgbaBytes() * 4 / 3;
  }
  for (std::uint32_t i = 0; i < d.brdf_tables.size(); ++i) {
    const auto table = reader.readBrdfTable(i);
    if (!table) return failAgain(table.error());
    bytes += packBrdf(*table).bytes();
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
