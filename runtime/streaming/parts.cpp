#include "runtime/streaming/parts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <variant>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>

#include "runtime/gpu/arena.hpp"
#include "runtime/streaming/resident_tables.hpp"
#include "runtime/streaming/textures.hpp"

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

namespace {

// Values of steps, relative to the last share of planes of something seen with the same size. So surfaces are
// kept until something else appears sqrt(64) times larger.
constexpr float kSurfaces = 64.0f, kCodebooks = 16.0f, kFirstPlanes = 8.0f, kLastPlanes = 1.0f;
// Value of a texture level whose texels are at least as large as pixels. The value falls with the area of
// smaller texels.
constexpr float kTexels = 8.0f;
// Diameter, in pixels, of a sphere of size 1 in a picture with 1080 rows and a field of view of 50 degrees.
constexpr float kPixels = 2300.0f;
// Factor on the value of steps that were chosen before.
constexpr float kStays = 1.5f;
static_assert(kSurfaces > kStays * kCodebooks && kCodebooks > kStays * kFirstPlanes);

constexpr std::uint64_t kProxyLodShare = 4;  // proxy levels of detail may take 1/4 of the memory first

constexpr float kOutOfSight = 0.1f;  // factor for spheres out of sight, as the camera may turn at any moment
constexpr float kLargest = 100.0f;   // limit of the size, for a camera inside or almost inside the sphere

struct Candidate {
  float worth = 0.0f;
  std::uint32_t bundle = 0, unit = 0, step = 0;
  std::uint64_t bytes = 0;
};

}  // namespace

float worthOf(const Parts& parts, std::uint32_t unit, std::uint32_t step, float size) {
  if (unit == 0) return size * kSurfaces;
  if (parts.isImage(unit)) {
    const Parts::Image& image = parts.imageOf(unit);
    const std::uint32_t side = std::max(image.width, image.height) >> (image.coarse - 1 - step);
    const float pixels_a_texel = kPixels * std::sqrt(size) / static_cast<float>(side);
    return size * kTexels * std::min(pixels_a_texel * pixels_a_texel, 1.0f);
  }
  if (step == 0) return size * kCodebooks;
  const std::size_t steps = parts.units[unit].size();
  const float share = static_cast<float>(step - 1) / static_cast<float>(std::max<std::size_t>(steps - 1, 1));
  return size * (kFirstPlanes + share * (kLastPlanes - kFirstPlanes));
}

float sizeSeen(const spec::View& view, const glm::vec3& center_ws, float radius_m) {
  const float distance = std::max(0.0f, glm::distance(view.eye_ws, center_ws) - radius_m);  // 0 for NaN
  const float size = distance > 0.0f ? radius_m / distance : std::numeric_limits<float>::infinity();
  float seen = std::min(size * size, kLargest);
  const glm::mat4 clip_from_world = view.clip_from_view * view.view_from_world;
  const glm::vec4 w = glm::row(clip_from_world, 3);
  for (int axis = 0; axis < 2; ++axis)
    for (const float sign : {1.0f, -1.0f}) {
      const glm::vec4 plane = w + sign * glm::row(clip_from_world, axis);
      const float normal = glm::length(glm::vec3(plane));
      if (normal > 0.0f && glm::dot(plane, glm::vec4(center_ws, 1.0f)) < -radius_m * normal)
        return kOutOfSight * seen;
    }
  return seen;
}

void choose(std::span<Interest* const> bundles, std::uint64_t max_bytes) {
  std::vector<Candidate> candidates;
  for (std::uint32_t b = 0; b < bundles.size(); ++b) {
    Interest& bundle = *bundles[b];
    for (std::uint32_t u = 0; u < bundle.parts.units.size(); ++u) {
      const Unit& unit = bundle.parts.units[u];
      for (std::uint32_t s = 0; s < unit.size(); ++s) {
        const float stays = s < bundle.target[u] ? kStays : 1.0f;
        candidates.push_back({stays * worthOf(bundle.parts, u, s, bundle.size[u]), b, u, s, unit[s].bytes});
      }
    }
    std::ranges::fill(bundle.target, 0u);
  }
  std::ranges::sort(candidates, [](const Candidate& a, const Candidate& b) {
    return std::tuple(-a.worth, a.bundle, a.unit, a.step) < std::tuple(-b.worth, b.bundle, b.unit, b.step);
  });
  std::uint64_t taken = 0;
  const auto take = [&](const Candidate& candidate, std::uint64_t most) {
    Interest& bundle = *bundles[candidate.bundle];
    // If a step did not fit, later steps of the unit cannot be taken.
    if (bundle.target[candidate.unit] != candidate.step) return;
    if (candidate.unit != 0 && bundle.target[0] != bundle.parts.surfaceSteps()) return;
    if (taken + candidate.bytes > most) return;
    taken += candidate.bytes;
    ++bundle.target[candidate.unit];
  };
  const auto isProxyLod = [&](const Candidate& candidate) {
    return bundles[candidate.bundle]->parts.isProxyLod(candidate.unit, candidate.step);
  };
  const auto largest = std::ranges::find_if(
      candidates, [&](const Candidate& candidate) { return candidate.unit == 0 && !isProxyLod(candidate); });
  if (largest == candidates.end()) return;
  constexpr std::uint64_t kInAnyCase = ~std::uint64_t{0};
  for (const Candidate& candidate : candidates)
    if (candidate.bundle == largest->bundle && candidate.unit == 0) take(candidate, kInAnyCase);
  const std::uint64_t with_proxy_lods = std::min(max_bytes, taken + max_bytes / kProxyLodShare);
  for (const Candidate& candidate : candidates)
    if (isProxyLod(candidate)) take(candidate, with_proxy_lods);
  for (const Candidate& candidate : candidates) take(candidate, max_bytes);
}

}  // namespace lambent::streaming
