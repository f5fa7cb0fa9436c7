#include "runtime/streaming/parts.hpp"

#include <algorithm>
#include <string>
#include <variant>

#include "runtime/gpu/arena.hpp"
#include "runtime/streaming/brdf_texture.hpp"
#include "runtime/streaming/image_decode.hpp"
#include "runtime/streaming/image_uses.hpp"
#include "runtime/streaming/sizes.hpp"

namespace lambent::streaming {

namespace {

// A group's planes come in so many shares: each is shaded with the next frame, and so are all its vertices.
constexpr std::size_t kShares = 12;

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

void add(Step& step, const Work& work, std::uint64_t bytes) {
  step.work.push_back(work);
  step.bytes += bytes;
}

}  // namespace

std::uint32_t Parts::planesIn(std::uint32_t group, std::uint32_t steps, std::uint32_t cell,
                              std::uint32_t transfer) const {
  std::uint32_t count = 0;
  for (std::uint32_t s = 0; s < std::min<std::size_t>(steps, units[1 + group].size()); ++s)
    for (const Work& work : units[1 + group][s].work)
      if (const auto* plane = std::get_if<PlaneWork>(&work))
        count += plane->cell == cell && plane->transfer == transfer ? 1u : 0u;
  return count;
}

Result<Parts> partsOf(const bundle::Reader& reader, bool limited) {
  const bundle::Description& d = reader.description();
  Parts parts;
  parts.units.resize(1 + d.groups.size());
  Step stand_in, base;
  std::vector<Step> codebooks(d.groups.size());
  std::vector<std::vector<PlaneWork>> planes(d.groups.size());
  for (const Work& work : workList(d)) {
    if (const auto* plane = std::get_if<PlaneWork>(&work)) {
      planes[plane->group].push_back(*plane);
    } else if (const auto* codebook = std::get_if<CodebookWork>(&work)) {
      add(codebooks[codebook->group], work, 0);
    } else if (const auto* weights = std::get_if<LightWeightsWork>(&work)) {
      add(codebooks[weights->group], work, 0);
    } else if (const auto* proxy = std::get_if<ProxyWork>(&work); proxy != nullptr && limited) {
      add(stand_in, work, standInBytes(d, proxy->group));
    } else {
      add(base, work, 0);
    }
  }
  Needs needs = needsOf(d);
  needs.transfer = 0;
  base.bytes = needs.total();
  if (limited) {
    const Result<std::uint64_t> textures = textureBytes(reader);
    if (!textures) return failAgain(textures.error());
    base.bytes += *textures;
  }
  if (!stand_in.work.empty()) parts.units.front().push_back(std::move(stand_in));
  parts.units.front().push_back(std::move(base));
  for (std::uint32_t g = 0; g < d.groups.size(); ++g) {
    if (codebooks[g].work.empty()) continue;
    for (const bundle::Cell& cell : d.groups[g].cells) {
      codebooks[g].bytes += cellBytes(cell) + gpu::Arena::kAlignment;
      for (const bundle::CellTransfer& transfer : cell.transfers)
        for (const bundle::WeightPlane& plane : transfer.planes) codebooks[g].bytes -= planeBytes(plane);
    }
    Unit& unit = parts.units[1 + g];
    unit.push_back(std::move(codebooks[g]));
    const std::size_t shares = std::min(kShares, planes[g].size());
    for (std::size_t share = 0; share < shares; ++share) {
      Step& step = unit.emplace_back();
      for (std::size_t p = share * planes[g].size() / shares; p < (share + 1) * planes[g].size() / shares;
           ++p) {
        const PlaneWork& at = planes[g][p];
        add(step, at, planeBytes(d.groups[g].cells[at.cell].transfers[at.transfer].planes[at.plane]));
      }
    }
  }
  return parts;
}

}  // namespace lambent::streaming
