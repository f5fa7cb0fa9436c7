#include "runtime/streaming/parts.hpp"

#include <algorithm>
#include <string>
#include <variant>

#include "runtime/gpu/arena.hpp"
#include "runtime/streaming/brdf_texture.hpp"
#include "runtime/streaming/images.hpp"
#include "runtime/streaming/sizes.hpp"

namespace lambent::streaming {

namespace {

// Number of shares in which a group's planes are loaded. After each share the whole group is shaded again.
constexpr std::size_t kShares = 12;

Result<std::vector<Parts::Image>> describeImages(const bundle::Reader& reader) {
  const bundle::Description& d = reader.description();
  std::vector<Parts::Image> images;
  for (const bundle::Image& image : d.images) {
    const auto file = reader.readView(image.view);
    if (!file) return failAgain(file.error());
    const auto size = imageSize(*file, reader.path().string() + ": image \"" + image.name + "\"");
    if (!size) return failAgain(size.error());
    images.push_back(
        {.width = size->width, .height = size->height, .coarse = coarseLevel(*size), .groups = {}});
  }
  for (const bundle::Draw& draw : d.draws)
    for (const std::uint32_t image : imagesOf(d, d.meshes[draw.mesh].primitives[draw.primitive].material)) {
      std::vector<std::uint32_t>& groups = images[image].groups;
      if (std::ranges::find(groups, draw.group) == groups.end()) groups.push_back(draw.group);
    }
  return images;
}

Result<std::uint64_t> tableBytes(const bundle::Reader& reader) {
  const bundle::Description& d = reader.description();
  std::uint64_t bytes = 0;
  for (std::uint32_t i = 0; i < d.brdf_tables.size(); ++i) {
    const auto table = reader.readBrdfTable(i);
    if (!table) return failAgain(table.error());
    bytes += packBrdf(*table).bytes();
  }
  return bytes;
}

std::uint64_t levelBytes(const Parts::Image& image, std::uint32_t level) {
  return textureBytes(sizeAt({image.width, image.height}, level));
}

// Adds the coarse level of each image to the first unit, and a unit for its finer levels.
void addImages(Parts& parts, Step& base, const std::vector<ImageUse>& uses) {
  for (std::uint32_t i = 0; i < parts.images.size(); ++i) {
    const Parts::Image& image = parts.images[i];
    base.bytes += uses[i].copies() * levelBytes(image, image.coarse);
    Unit& unit = parts.units.emplace_back();
    for (std::uint32_t level = image.coarse; level-- > 0;)
      unit.push_back({.work = {ImageRequest{i, level}},
                      .bytes = uses[i].copies() * (levelBytes(image, level) - levelBytes(image, level + 1))});
  }
}

void add(Step& step, const Work& work, std::uint64_t bytes) {
  step.work.push_back(work);
  step.bytes += bytes;
}

}  // namespace

std::uint32_t Parts::planesIn(bundle::GroupIndex group, std::uint32_t steps, bundle::CellIndex cell,
                              bundle::TransferIndex transfer) const {
  std::uint32_t count = 0;
  for (std::uint32_t s = 0; s < std::min<std::size_t>(steps, units[1 + group.value].size()); ++s)
    for (const Work& work : units[1 + group.value][s].work)
      if (const auto* plane = std::get_if<PlaneRequest>(&work))
        count += plane->cell == cell && plane->transfer == transfer ? 1u : 0u;
  return count;
}

std::uint32_t Parts::levelsIn(std::size_t unit, std::uint32_t steps) const {
  const Image& image = imageOf(unit);
  return levelCount({image.width, image.height}) - (image.coarse - steps);
}

std::vector<Work> Parts::workOf(const std::vector<std::uint32_t>& steps) const {
  std::vector<Work> work;
  for (std::size_t u = 0; u < units.size(); ++u)
    for (std::uint32_t s = isImage(u) && steps[u] > 0 ? steps[u] - 1 : 0; s < steps[u]; ++s)
      work.insert(work.end(), units[u][s].work.begin(), units[u][s].work.end());
  return work;
}

Result<Parts> partsOf(const bundle::Reader& reader, bool limited) {
  const bundle::Description& d = reader.description();
  Parts parts;
  parts.units.resize(1 + d.groups.size());
  if (limited) {
    Result<std::vector<Parts::Image>> images = describeImages(reader);
    if (!images) return failAgain(images.error());
    parts.images = std::move(*images);
  }
  Step proxy_lod, base;
  std::vector<Step> codebooks(d.groups.size());
  std::vector<std::vector<PlaneRequest>> planes(d.groups.size());
  for (const Work& work : requestsOf(d)) {
    if (const auto* plane = std::get_if<PlaneRequest>(&work)) {
      planes[plane->group.value].push_back(*plane);
    } else if (const auto* codebook = std::get_if<CodebookRequest>(&work)) {
      add(codebooks[codebook->group.value], work, 0);
    } else if (const auto* weights = std::get_if<LightWeightsRequest>(&work)) {
      add(codebooks[weights->group.value], work, 0);
    } else if (const auto* proxy = std::get_if<ProxyRequest>(&work); proxy != nullptr && limited) {
      add(proxy_lod, work, proxyLodBytes(d, proxy->group));
    } else if (const auto* image = std::get_if<ImageRequest>(&work); image != nullptr && limited) {
      add(base, ImageRequest{image->image, parts.images[image->image].coarse}, 0);
    } else {
      add(base, work, 0);
    }
  }
  Needs needs = needsOf(d);
  needs.transfer = 0;
  base.bytes = needs.total();
  if (limited) {
    const Result<std::uint64_t> tables = tableBytes(reader);
    if (!tables) return failAgain(tables.error());
    base.bytes += *tables;
    addImages(parts, base, imageUses(d));
  }
  if (!proxy_lod.work.empty()) parts.units.front().push_back(std::move(proxy_lod));
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
        const PlaneRequest& at = planes[g][p];
        add(step, at,
            planeBytes(d.groups[g].cells[at.cell.value].transfers[at.transfer.value].planes[at.plane.value]));
      }
    }
  }
  return parts;
}

}  // namespace lambent::streaming
