// What shows of a bundle whose surfaces are not here: World's part that keeps stand-ins.
#include <algorithm>

#include "runtime/frame/world.hpp"

namespace lambent::frame {

std::size_t StreamingStatus::count(Shown shown) const {
  return static_cast<std::size_t>(std::ranges::count(bundles, shown, &BundleStreaming::shown));
}

std::vector<StandIn> World::standIns() const {
  std::vector<StandIn> list;
  for (std::uint32_t slot = 0; slot < bundles_.size(); ++slot) {
    if (!bundles_[slot]) continue;
    const Bundle& bundle = *bundles_[slot];
    if (bundle.parts.hasStandIn() && bundle.steps.front() > 0 && !hasSurfaces(bundle.parts, bundle.steps))
      list.push_back({.bundle = slot, .id = bundle.proxies_id, .proxies = bundle.proxies});
  }
  return list;
}

bool World::showsSurfaces(std::uint32_t slot) const {
  if (!isOpen(slot)) return false;
  const Bundle& bundle = *bundles_[slot];
  return !bundle.parts.hasStandIn() || hasSurfaces(bundle.parts, bundle.steps);
}

// Proxies stay here, for when the surfaces go; others also see them where these are.
Result<void> World::accept(std::uint32_t slot, streaming::Ready item) {
  Bundle& bundle = *bundles_[slot];
  auto* ready = std::get_if<streaming::ProxyReady>(&item);
  if (ready == nullptr || !bundle.parts.hasStandIn()) return residency_.upload(slot, std::move(item));
  bundle.proxies.resize(bundle.reader->description().groups.size());
  bundle.proxies[ready->group] = std::move(ready->proxy);
  bundle.proxies_id = next_proxies_id_++;
  return {};
}

Result<void> World::beginSurfaces(std::uint32_t slot) {
  const Bundle& bundle = *bundles_[slot];
  if (Result<void> added = residency_.add(bundle.reader->description(), slot); !added) return added;
  rebuildTables();
  for (std::uint32_t g = 0; g < bundle.proxies.size(); ++g)
    if (bundle.proxies[g])
      if (Result<void> done = residency_.upload(slot, streaming::ProxyReady{g, *bundle.proxies[g]}); !done)
        return done;
  return {};
}

void World::endSurfaces(std::uint32_t slot) {
  Bundle& bundle = *bundles_[slot];
  retire(bundle);
  residency_.remove(slot);
  const std::uint32_t stand_in = bundle.parts.hasStandIn() ? bundle.steps.front() : 0;
  std::ranges::fill(bundle.steps, 0u);
  bundle.steps.front() = std::min(stand_in, bundle.parts.surfaceSteps() - 1);
  ++stand_ins_version_;
  rebuildTables();
}

void World::dropStandIn(Bundle& bundle) {
  if (bundle.steps.front() == 0 && !bundle.batch) return;
  retire(bundle);
  bundle.proxies.clear();
  bundle.steps.front() = 0;
  ++stand_ins_version_;
}

}  // namespace lambent::frame
