// The part of World that shows a proxy level of detail for a bundle whose surfaces are not here.
#include <algorithm>

#include "runtime/world/world.hpp"

namespace lambent::frame {

std::size_t StreamingStatus::count(Shown shown) const {
  return static_cast<std::size_t>(std::ranges::count(bundles, shown, &BundleStreaming::shown));
}

std::vector<ProxyLod> World::proxyLods() const {
  std::vector<ProxyLod> list;
  for (std::uint32_t slot = 0; slot < bundles_.size(); ++slot) {
    if (!bundles_[slot]) continue;
    const Bundle& bundle = *bundles_[slot];
    if (bundle.parts.hasProxyLod() && bundle.steps.front() > 0 && !hasSurfaces(bundle.parts, bundle.steps))
      list.push_back({.bundle = slot, .id = bundle.proxies_id, .proxies = bundle.proxies});
  }
  return list;
}

bool World::showsSurfaces(std::uint32_t slot) const {
  if (!isOpen(slot)) return false;
  const Bundle& bundle = *bundles_[slot];
  return !bundle.parts.hasProxyLod() || hasSurfaces(bundle.parts, bundle.steps);
}

// Proxies stay here for when the surfaces are dropped, and other groups see them in any case.
Result<void> World::accept(std::uint32_t slot, streaming::Ready item) {
  Bundle& bundle = *bundles_[slot];
  auto* ready = std::get_if<streaming::ProxyChunk>(&item);
  if (ready == nullptr || !bundle.parts.hasProxyLod()) return residency_.upload(slot, std::move(item));
  bundle.proxies.resize(bundle.reader->description().groups.size());
  bundle.proxies[ready->group.value] = std::move(ready->proxy);
  bundle.proxies_id = next_proxies_id_++;
  return {};
}

Result<void> World::beginSurfaces(std::uint32_t slot) {
  const Bundle& bundle = *bundles_[slot];
  if (Result<void> added = residency_.add(bundle.reader->description(), slot); !added) return added;
  rebuildTables();
  for (std::uint32_t g = 0; g < bundle.proxies.size(); ++g)
    if (bundle.proxies[g])
      if (Result<void> done =
              residency_.upload(slot, streaming::ProxyChunk{bundle::GroupIndex{g}, *bundle.proxies[g]});
          !done)
        return done;
  return {};
}

void World::endSurfaces(std::uint32_t slot) {
  Bundle& bundle = *bundles_[slot];
  retire(bundle);
  residency_.remove(slot);
  const std::uint32_t proxy_lod = bundle.parts.hasProxyLod() ? bundle.steps.front() : 0;
  std::ranges::fill(bundle.steps, 0u);
  bundle.steps.front() = std::min(proxy_lod, bundle.parts.surfaceSteps() - 1);
  ++proxy_lods_version_;
  rebuildTables();
}

void World::dropProxyLod(Bundle& bundle) {
  if (bundle.steps.front() == 0 && !bundle.batch) return;
  retire(bundle);
  bundle.proxies.clear();
  bundle.steps.front() = 0;
  ++proxy_lods_version_;
}

}  // namespace lambent::frame
