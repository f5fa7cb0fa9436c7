// The part of World that chooses what of the bundles is on the GPU by what the camera sees.
#include <algorithm>
#include <thread>
#include <tuple>

#include "runtime/gpu/objects.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/streaming/parts.hpp"
#include "runtime/streaming/resident_tables.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

namespace {

// This much is requested at once and uploaded in one piece. It is little because the camera may turn
// meanwhile.
constexpr std::uint64_t kBatchBytes = std::uint64_t{8} << 20;
constexpr std::uint32_t kBatches = 2;  // loading at a time, each for one bundle

std::uint64_t bytesOf(const streaming::Parts& parts, const std::vector<std::uint32_t>& steps) {
  std::uint64_t bytes = 0;
  for (std::size_t u = 0; u < parts.units.size(); ++u)
    for (std::uint32_t s = 0; s < steps[u]; ++s) bytes += parts.units[u][s].bytes;
  return bytes;
}

Shown shownOf(const streaming::Parts& parts, const std::vector<std::uint32_t>& steps) {
  if (steps.front() < parts.surfaceSteps())
    return parts.hasProxyLod() && steps.front() > 0 ? Shown::ProxyLod : Shown::Nothing;
  return std::ranges::equal(steps, parts.units, {}, {}, &streaming::Unit::size) ? Shown::Full : Shown::Partly;
}

std::vector<std::uint32_t> allSteps(const streaming::Parts& parts) {
  std::vector<std::uint32_t> steps;
  for (const streaming::Unit& unit : parts.units) steps.push_back(static_cast<std::uint32_t>(unit.size()));
  return steps;
}

struct Next {
  float worth = 0.0f;
  std::uint32_t unit = 0, step = 0;
};

// Returns what is missing, the most valuable first.
std::vector<Next> missing(const streaming::Interest& bundle, const std::vector<std::uint32_t>& have) {
  std::vector<Next> list;
  for (std::uint32_t u = 0; u < bundle.parts.units.size(); ++u)
    for (std::uint32_t s = have[u]; s < bundle.target[u]; ++s)
      list.push_back({streaming::worthOf(bundle.parts, u, s, bundle.size[u]), u, s});
  // Proxy levels of detail of all bundles come before anything else.
  constexpr float kProxyLodsFirst = 1e6f;
  for (Next& next : list)
    if (bundle.parts.isProxyLod(next.unit, next.step)) next.worth *= kProxyLodsFirst;
  std::ranges::sort(list, [](const Next& a, const Next& b) {
    return std::tuple(-a.worth, a.unit, a.step) < std::tuple(-b.worth, b.unit, b.step);
  });
  return list;
}

bool same(const spec::View& a, const spec::View& b) {
  return a.eye_ws == b.eye_ws && a.view_from_world == b.view_from_world &&
         a.clip_from_view == b.clip_from_view;
}

}  // namespace

void World::setParts(Bundle& bundle, streaming::Parts parts) const {
  bundle.parts = std::move(parts);
  bundle.size.assign(bundle.parts.units.size(), 1.0f);
  bundle.steps.assign(bundle.parts.units.size(), 0);
  bundle.target = limited() ? bundle.steps : allSteps(bundle.parts);
}

void World::seeBundle(Bundle& bundle) const {
  constexpr float kLeast = 1e-12f;
  bundle.size.assign(bundle.parts.units.size(), view_ ? kLeast : 1.0f);
  if (!view_) return;
  // These are the bounds of what a group draws; volumes fill the group's bounds.
  std::vector<scene::Box> boxes(bundle.instance.groups.size());
  const bundle::Description& description = bundle.reader->description();
  for (std::size_t d = 0; d < description.draws.size(); ++d)
    boxes[description.draws[d].group].add(scene::drawBounds(registry_, bundle.instance.draws[d]));
  for (std::size_t g = 0; g < boxes.size(); ++g) {
    const scene::Box box =
        boxes[g].empty() ? scene::groupBounds(registry_, bundle.instance.groups[g]) : boxes[g];
    if (box.empty()) continue;
    bundle.size[1 + g] = std::max(streaming::sizeSeen(*view_, box.center(), box.radius()), kLeast);
    bundle.size[0] = std::max(bundle.size[0], bundle.size[1 + g]);
  }
  for (std::size_t u = bundle.parts.firstImageUnit(); u < bundle.size.size(); ++u)
    for (const std::uint32_t group : bundle.parts.imageOf(u).groups)
      bundle.size[u] = std::max(bundle.size[u], bundle.size[1 + group]);
}

void World::chooseTargets() {
  const bool same_view =
      view_.has_value() == chosen_.view.has_value() && (!view_ || same(*view_, *chosen_.view));
  if (same_view && chosen_.transforms == transformsVersion() && chosen_.bundles == bundles_version_) return;
  chosen_ = {.view = view_, .transforms = transformsVersion(), .bundles = bundles_version_};
  const bool waiting =
      std::ranges::any_of(bundles_, [](const auto& bundle) { return bundle && !settled(*bundle); });
  if (!limited() && !waiting) return;  // everything is here and stays
  std::vector<streaming::Interest*> open;
  for (std::optional<Bundle>& bundle : bundles_) {
    if (!bundle) continue;
    seeBundle(*bundle);
    open.push_back(&*bundle);
  }
  if (limited()) streaming::choose(open, max_resident_bytes_);
}

std::vector<std::uint32_t> World::stepsForReplacement(std::uint32_t slot,
                                                      const streaming::Parts& parts) const {
  if (!limited()) return allSteps(parts);
  std::vector<streaming::Interest> copies(bundles_.size());
  std::vector<streaming::Interest*> open;
  for (std::size_t i = 0; i < bundles_.size(); ++i) {
    if (!bundles_[i]) continue;
    copies[i] = *bundles_[i];
    open.push_back(&copies[i]);
  }
  // The replacement counts as large as the old bundle; units without a counterpart count as large as all of
  // it.
  streaming::Interest& one = copies[slot];
  one.parts = parts;
  one.size.resize(parts.units.size(), one.size.front());
  one.target.resize(parts.units.size(), 0);
  streaming::choose(open, max_resident_bytes_);
  return one.target;
}

std::uint64_t World::bytesTaken() const {
  std::uint64_t bytes = 0;
  for (const std::optional<Bundle>& bundle : bundles_) {
    if (!bundle) continue;
    bytes += bytesOf(bundle->parts, bundle->steps);
    if (bundle->batch)
      for (const Piece& piece : bundle->batch->pieces) bytes += piece.bytes;
  }
  return bytes;
}

void World::retire(Bundle& bundle) {
  if (!bundle.batch) return;
  bundle.batch->loader->stop();
  residency_.cancel(bundle.options.bundle_index);
  retired_.push_back(std::move(bundle.batch->loader));
  bundle.batch.reset();
}

void World::dropTo(std::uint32_t slot, std::uint32_t unit, std::uint32_t steps) {
  Bundle& bundle = *bundles_[slot];
  bundle.steps[unit] = steps;
  if (bundle.parts.isImage(unit)) {
    residency_.dropLevels(slot, static_cast<std::uint32_t>(unit - bundle.parts.firstImageUnit()),
                          bundle.parts.levelsIn(unit, steps));
    return;
  }
  const bundle::GroupIndex group{unit - 1};
  if (steps == 0)
    residency_.dropTransfer(slot, group);
  else
    residency_.dropPlanes(slot, group, [&](bundle::CellIndex cell, bundle::TransferIndex transfer) {
      return bundle.parts.planesIn(group, steps, cell, transfer);
    });
}

void World::cancelBatch(std::uint32_t slot) {
  Bundle& bundle = *bundles_[slot];
  if (!bundle.batch) return;
  const Piece front = bundle.batch->pieces.front();
  retire(bundle);
  if (front.begun && front.unit != 0) dropTo(slot, front.unit, bundle.steps[front.unit]);
}

// Drops what is here or being loaded and should not be.
void World::evict(std::uint32_t slot) {
  Bundle& bundle = *bundles_[slot];
  if (!hasSurfaces(bundle.parts, bundle.target)) {
    if (residency_.present(slot)) endSurfaces(slot);
    if (bundle.target.front() == 0) dropProxyLod(bundle);
    return;
  }
  if (bundle.batch) {
    std::vector<std::uint32_t> coming = bundle.steps;
    for (const Piece& piece : bundle.batch->pieces) coming[piece.unit] += piece.steps;
    for (std::size_t u = 0; u < coming.size(); ++u)
      if (coming[u] > bundle.target[u]) {
        cancelBatch(slot);
        break;
      }
  }
  for (std::uint32_t u = 1; u < bundle.steps.size(); ++u)
    if (bundle.steps[u] > bundle.target[u]) dropTo(slot, u, bundle.target[u]);
}

bool World::startBatch(std::uint32_t slot) {
  Bundle& bundle = *bundles_[slot];
  std::uint64_t taken = bytesTaken(), bytes = 0;
  const std::vector<Next> list = missing(bundle, bundle.steps);
  // The surfaces of the largest bundle are always loaded.
  const bool only_proxy_lods =
      std::ranges::none_of(residency_.bundles(), &streaming::ResidentBundle::present);
  const auto fits = [&](const Next& next) {
    return !limited() || only_proxy_lods ||
           taken + bundle.parts.units[next.unit][next.step].bytes <= max_resident_bytes_;
  };
  if (list.empty() || !fits(list.front())) return false;
  if (!bundle.parts.isProxyLod(list.front().unit, list.front().step) && !residency_.present(slot)) {
    if (const Result<void> begun = beginSurfaces(slot); !begun) {
      bundle.error = inBundle(*bundle.reader, begun.error());
      return false;
    }
  }
  std::deque<Piece> pieces;
  for (const Next& next : list) {
    const streaming::Step& step = bundle.parts.units[next.unit][next.step];
    if (!fits(next)) break;
    if (!pieces.empty() && (bytes + step.bytes > kBatchBytes || pieces.front().unit == 0)) break;
    if (step.work.empty()) {  // a bundle that shows nothing
      ++bundle.steps[next.unit];
      ++proxy_lods_version_;
      continue;
    }
    taken += step.bytes;
    bytes += step.bytes;
    const auto coarser = std::ranges::find(pieces, next.unit, &Piece::unit);
    if (bundle.parts.isImage(next.unit) && coarser != pieces.end()) {  // the finer level brings all
      coarser->work = step.work;
      coarser->bytes += step.bytes;
      ++coarser->steps;
      continue;
    }
    pieces.push_back({.unit = next.unit, .work = step.work, .items = step.work.size(), .bytes = step.bytes});
  }
  if (pieces.empty()) return false;
  std::vector<streaming::Work> work;
  for (const Piece& piece : pieces) work.insert(work.end(), piece.work.begin(), piece.work.end());
  const unsigned workers = std::max(1u, std::thread::hardware_concurrency() / kBatches);
  bundle.batch.emplace(
      Batch{.loader = std::make_unique<streaming::Loader>(bundle.reader, std::move(work), threads_, workers),
            .pieces = std::move(pieces)});
  return true;
}

void World::request() {
  const auto running =
      std::ranges::count_if(bundles_, [](const auto& bundle) { return bundle && bundle->batch; });
  struct Waiting {
    float worth;
    std::uint32_t slot;
  };
  std::vector<Waiting> waiting;
  for (std::uint32_t i = 0; i < bundles_.size(); ++i) {
    if (!bundles_[i] || bundles_[i]->batch || settled(*bundles_[i])) continue;
    const Bundle& bundle = *bundles_[i];
    const std::vector<Next> next = missing(bundle, bundle.steps);
    if (!next.empty()) waiting.push_back({next.front().worth, i});
  }
  std::ranges::stable_sort(waiting, [](const Waiting& a, const Waiting& b) { return a.worth > b.worth; });
  auto room = static_cast<std::ptrdiff_t>(kBatches) - running;
  for (const Waiting& one : waiting) {
    if (room <= 0) break;
    if (startBatch(one.slot)) --room;
  }
}

void World::countOne(Bundle& bundle) {
  Piece& piece = bundle.batch->pieces.front();
  piece.begun = true;
  if (--piece.items > 0) return;
  bundle.steps[piece.unit] += piece.steps;
  if (piece.unit == 0) ++proxy_lods_version_;
  bundle.batch->pieces.pop_front();
}

void World::takeFrom(std::uint32_t slot, std::uint64_t& budget_bytes, gpu::Counters& counters) {
  Bundle& bundle = *bundles_[slot];
  const auto put = [&](streaming::Ready item) { return this->accept(slot, std::move(item)); };
  const auto arrived = [&] { countOne(bundle); };
  if (const auto error = receive({*bundle.batch->loader, slot, put, arrived}, budget_bytes, counters))
    bundle.error = inBundle(*bundle.reader, *error);
  if (!bundle.error && residency_.comes(slot)) return;
  if (const auto error = bundle.batch->loader->error()) bundle.error = *error;
  if (bundle.error || bundle.batch->pieces.empty()) retire(bundle);
}

void World::measureRate(std::uint64_t bytes) {
  constexpr double kWindow_s = 0.5;
  rate_.bytes += bytes;
  const auto now = std::chrono::steady_clock::now();
  const double seconds = std::chrono::duration<double>(now - rate_.since).count();
  if (seconds < kWindow_s) return;
  rate_ = {.since = now, .bytes = 0, .megabytes_per_s = 1e-6 * static_cast<double>(rate_.bytes) / seconds};
}

StreamingStatus World::streaming() const {
  StreamingStatus status{.budget_bytes = max_resident_bytes_,
                         .resident_bytes = residency_.bytesResident(),
                         .megabytes_per_s = rate_.megabytes_per_s,
                         .bundles = {}};
  for (const ProxyLod& proxy_lod : proxyLods())
    for (std::uint32_t g = 0; g < proxy_lod.proxies.size(); ++g)
      if (const auto& proxy = proxy_lod.proxies[g])
        status.proxy_lod_bytes += streaming::kProxyLodGroupBytes +
                                  streaming::kProxyLodTriangleBytes * proxy->levels.front().triangle_count;
  status.resident_bytes += status.proxy_lod_bytes;
  for (std::uint32_t i = 0; i < bundles_.size(); ++i) {
    if (!bundles_[i]) continue;
    const Bundle& bundle = *bundles_[i];
    status.bundles.push_back({.bundle = i,
                              .name = bundle.reader->path().filename().string(),
                              .whole_bytes = bytesOf(bundle.parts, allSteps(bundle.parts)),
                              .wanted_bytes = bytesOf(bundle.parts, bundle.target),
                              .resident_bytes = bytesOf(bundle.parts, bundle.steps),
                              .size = bundle.size.front(),
                              .state = this->status(i).state,
                              .shown = shownOf(bundle.parts, bundle.steps)});
    if (bundle.batch)
      for (const Piece& piece : bundle.batch->pieces) status.in_flight_bytes += piece.bytes;
    for (std::size_t u = 0; u < bundle.steps.size(); ++u)
      for (std::uint32_t s = bundle.steps[u]; s < bundle.target[u]; ++s)
        status.queued += static_cast<std::uint32_t>(bundle.parts.units[u][s].work.size());
  }
  return status;
}

// The part of World that shows a proxy level of detail for a bundle whose surfaces are not here.

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
              residency_.upload(slot, streaming::ProxyChunk{{bundle::GroupIndex{g}}, *bundle.proxies[g]});
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
