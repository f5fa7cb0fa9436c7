#include "baker/bake/bounce_memory.hpp"

#include <algorithm>
#include <vector>

#include "baker/effects/diffuse/inside_faces.hpp"
#include "baker/effects/glossy/inside_faces.hpp"
#include "baker/trace/patches.hpp"
#include "runtime/base/memory.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

std::size_t coefficients(int order) {
  return static_cast<std::size_t>(sh::coefficientCount(order));
}

// Bounces hold the sum of all passes, the last two of them, and two copies while one is fitted to points
// inside faces.
std::size_t floatsOfDiffuse(const DirectResult& direct) {
  constexpr std::size_t kFields = 5;
  std::size_t floats = kFields * direct.field.vectors.size() + direct.mapped.vectors.size();
  if (direct.inside) {
    const DirectResult& there = direct.inside->points().direct();
    floats += there.field.vectors.size() + 2 * there.mapped.vectors.size();
  }
  for (const auto& points : direct.watched) floats += points->direct().field.vectors.size();
  return floats;
}

// Patches pass light on by a matrix.
std::size_t floatsOfPatches(const DirectResult& direct, std::size_t glossy) {
  const std::size_t patches = std::min(kMostPatches, direct.field.size() + glossy);
  return patches * patches * direct.field.channels;
}

// The last two passes have the bands of exit kernels, and so has a pass at points inside faces; their sum has
// those that ship.
std::size_t floatsOfGlossy(const GlossyDirect& glossy, const BakeOptions& options) {
  const GlossyField& field = glossy.field;
  const std::size_t columns = field.channels * (coefficients(field.order_in) + field.light_columns);
  const std::size_t exits = coefficients(field.order_out) * columns;
  std::size_t floats = field.size() * (2 * exits + coefficients(options.glossy_order) * columns);
  if (glossy.inside) floats += glossy.inside->points().size() * exits;
  return floats;
}

// Returns how many bytes the results of bounces take at most, beyond what direct light holds.
std::uint64_t bytesOfBounces(const SurfaceTransport& light, const BakeOptions& options) {
  std::size_t floats = floatsOfDiffuse(light.direct);
  if (options.bounces != 1)
    floats += floatsOfPatches(light.direct, light.glossy ? light.glossy->field.size() : 0);
  if (light.glossy) floats += floatsOfGlossy(*light.glossy, options);
  return floats * sizeof(float);
}

}  // namespace

void makeRoomForBounces(const BakeOptions& options, SurfaceTransport& light) {
  std::vector<HitStore*> stores = {&light.direct.hits};
  if (light.direct.inside) stores.push_back(&light.direct.inside->points().direct().hits);
  if (light.glossy) {
    stores.push_back(&light.glossy->hits);
    if (light.glossy->inside) stores.push_back(&light.glossy->inside->points().direct().hits);
  }
  std::uint64_t held = 0;
  for (const HitStore* store : stores) held += store->bytes();
  const std::uint64_t resident = residentBytes();
  const std::uint64_t needed = bytesOfBounces(light, options) + resident - std::min(held, resident);
  const std::uint64_t limit = options.effectiveMemory();
  const std::uint64_t room = limit - std::min(limit, needed);
  if (held <= room) return;
  const double share = static_cast<double>(room) / static_cast<double>(held);
  for (HitStore* store : stores)
    store->keepAtMost(static_cast<std::size_t>(share * static_cast<double>(store->bytes())));
  returnFreedMemory();
}

}  // namespace lambent::baker
