#include <algorithm>
#include <chrono>
#include <thread>

#include "runtime/gpu/objects.hpp"
#include "runtime/scene/instantiate.hpp"
#include "runtime/scene/transforms.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

namespace {

// Returns whether everything was taken without an error; a loader also finishes at its first error.
bool isWhole(const streaming::Loader& loader) {
  return loader.finished() && !loader.error();
}

}  // namespace

// Reports an error in a part of a bundle as an error of the bundle.
Error World::inBundle(const bundle::Reader& reader, const Error& error) {
  return {reader.path().string(), error.subject + ": " + error.problem, error.hint};
}

std::uint32_t World::freeInstance(const std::string& bundle_id) const {
  std::uint32_t instance = 0;
  const auto taken = [&](const std::optional<Bundle>& other) {
    return other && other->options.bundle_id == bundle_id && other->options.instance == instance;
  };
  while (std::ranges::any_of(bundles_, taken)) ++instance;
  return instance;
}

Result<std::uint32_t> World::open(const std::filesystem::path& path, const OpenOptions& options) {
  const auto slot = static_cast<std::uint32_t>(
      std::ranges::find_if(bundles_, [](const auto& bundle) { return !bundle; }) - bundles_.begin());
  Result<bundle::Reader> opened = bundle::Reader::open(path);
  if (!opened) return failAgain(opened.error());
  const bool first = std::ranges::none_of(bundles_, [](const auto& bundle) { return bundle.has_value(); });
  const glm::dvec3 origin = first ? opened->description().origin : origin_;
  opened->countFrom(origin);
  Result<streaming::Parts> parts = streaming::partsOf(*opened, limited());
  if (!parts) return failAgain(parts.error());
  Bundle bundle;
  bundle.reader = std::make_shared<const bundle::Reader>(std::move(*opened));
  bundle.options = {.bundle_index = slot, .bundle_id = options.bundle_id};
  const bundle::Description& description = bundle.reader->description();
  if (bundle.options.bundle_id.empty()) bundle.options.bundle_id = path.string();
  bundle.options.instance = options.instance ? *options.instance : freeInstance(bundle.options.bundle_id);
  Result<scene::SceneInstance> instance = scene::instantiate(registry_, description, bundle.options);
  if (!instance) return failAgain(instance.error());
  bundle.instance = std::move(*instance);
  if (!limited()) {
    if (const Result<void> added = residency_.add(description, slot); !added) {
      scene::destroyInstance(registry_, bundle.instance);
      return failAgain(inBundle(*bundle.reader, added.error()));
    }
  }
  bundle.world_from_node_at_rest = gltf::worldTransforms(description.nodes);
  bundle.materials = description.materials;
  setParts(bundle, std::move(*parts));
  if (slot == bundles_.size()) bundles_.emplace_back();
  bundles_[slot].emplace(std::move(bundle));
  origin_ = origin;
  ++bundles_version_;
  ++proxy_lods_version_;
  rebuildTables();
  return slot;
}

void World::close(std::uint32_t bundle) {
  if (!isOpen(bundle)) return;
  dropReplacement(*bundles_[bundle]);
  retire(*bundles_[bundle]);
  scene::destroyInstance(registry_, bundles_[bundle]->instance);
  if (residency_.present(bundle)) residency_.remove(bundle);
  bundles_[bundle].reset();
  ++bundles_version_;
  ++proxy_lods_version_;
  scene::updateTransforms(registry_);
  rebuildTables();
}

Result<void> World::replace(std::uint32_t bundle, const std::filesystem::path& path) {
  if (!isOpen(bundle)) return fail(path.string(), "there is no bundle to replace", "open it instead");
  Bundle& old = *bundles_[bundle];
  dropReplacement(old);
  old.replacement_error.reset();
  const auto giveUp = [&](Error error) {
    old.replacement_error = error;
    return failAgain(std::move(error));
  };
  Result<bundle::Reader> opened = bundle::Reader::open(path);
  if (!opened) return giveUp(opened.error());
  opened->countFrom(origin_);
  const auto reader = std::make_shared<const bundle::Reader>(std::move(*opened));
  Result<streaming::Parts> parts = streaming::partsOf(*reader, limited());
  if (!parts) return giveUp(parts.error());
  const Result<streaming::Residency::Place> staged = residency_.stage(reader->description());
  if (!staged) return giveUp(inBundle(*reader, staged.error()));
  std::vector<std::uint32_t> steps = stepsForReplacement(bundle, *parts);
  std::vector<streaming::Work> work = parts->workOf(steps);
  old.replacement.emplace(
      Replacement{.reader = reader,
                  .parts = std::move(*parts),
                  .proxies = Proxies(reader->description().groups.size()),
                  .steps = std::move(steps),
                  .loader = std::make_unique<streaming::Loader>(
                      reader, std::move(work), threads_, std::max(1u, std::thread::hardware_concurrency())),
                  .staged = *staged});
  return {};
}

void World::dropReplacement(Bundle& bundle) {
  if (!bundle.replacement) return;
  residency_.discard(bundle.replacement->staged);
  bundle.replacement->loader->stop();
  retired_.push_back(std::move(bundle.replacement->loader));
  bundle.replacement.reset();
}

std::optional<Error> World::receive(const Arrivals& from, std::uint64_t& budget_bytes,
                                    gpu::Counters& counters) {
  std::optional<Error> error;
  const auto spend = [&](std::uint64_t bytes) {
    budget_bytes -= std::min(budget_bytes, bytes);
    counters.uploaded_bytes += bytes;
  };
  // Large items are uploaded over several frames.
  const auto proceed = [&] {
    const Result<std::uint64_t> bytes =
        gpu::orOutOfMemory([&] { return residency_.proceed(from.place, budget_bytes); });
    if (!bytes) {
      error = bytes.error();
      return;
    }
    spend(*bytes);
    if (!residency_.comes(from.place)) from.arrived();
  };
  if (residency_.comes(from.place)) proceed();
  std::vector<streaming::Ready> items;
  if (!error && !residency_.comes(from.place) && budget_bytes > 0) items = from.loader.take(budget_bytes);
  for (streaming::Ready& item : items) {
    const std::uint64_t bytes = streaming::bytesOf(item);
    // An item larger than the budget is uploaded alone.
    const bool in_pieces =
        bytes > budget_bytes && items.size() == 1 && streaming::Residency::comesInPieces(item);
    if (!in_pieces) spend(bytes);
    const Result<void> done = gpu::orOutOfMemory([&] {
      return in_pieces ? residency_.begin(from.place, std::move(item)) : from.accept(std::move(item));
    });
    if (!done) {
      error = done.error();
      break;
    }
    if (in_pieces)
      proceed();
    else
      from.arrived();
  }
  return error;
}

void World::uploadReplacement(Bundle& bundle, std::uint64_t& budget_bytes, gpu::Counters& counters) {
  Replacement& next = *bundle.replacement;
  const auto put = [&](streaming::Ready item) {
    if (const auto* ready = std::get_if<streaming::ProxyChunk>(&item))
      next.proxies[ready->group.value] = ready->proxy;
    return residency_.upload(next.staged, std::move(item));
  };
  if (const auto error = receive({*next.loader, next.staged, put, [] {}}, budget_bytes, counters))
    bundle.replacement_error = inBundle(*next.reader, *error);
  if (const auto error = next.loader->error()) bundle.replacement_error = *error;
  if (bundle.replacement_error) dropReplacement(bundle);
}

void World::swapIn(std::uint32_t slot) {
  Bundle& bundle = *bundles_[slot];
  Replacement next = std::move(*bundle.replacement);
  bundle.replacement.reset();
  retire(bundle);
  if (hasSurfaces(next.parts, next.steps)) {
    residency_.show(next.staged, slot);
  } else {  // nothing of it is wanted now
    residency_.discard(next.staged);
    if (residency_.present(slot)) residency_.remove(slot);
  }
  const bundle::Description& now = next.reader->description();
  bundle.instance =
      scene::exchangeInstance(registry_, bundle.instance, bundle.reader->description(), now, bundle.options);
  bundle.reader = next.reader;
  bundle.world_from_node_at_rest = gltf::worldTransforms(now.nodes);
  setParts(bundle, std::move(next.parts));
  bundle.steps = next.steps;
  bundle.proxies = std::move(next.proxies);
  bundle.proxies_id = next_proxies_id_++;
  if (limited()) bundle.target = next.steps;
  bundle.materials = now.materials;
  bundle.error.reset();
  retired_.push_back(std::move(next.loader));
  ++bundles_version_;
  ++proxy_lods_version_;
  rebuildTables();
  playAnimations(0.0f);  // moves nodes that the old bundle's animations had placed
}

Result<void> World::upload(std::uint64_t budget_bytes, gpu::Counters& counters, double most_wait_s) {
  const std::uint64_t uploaded_before = counters.uploaded_bytes;
  std::erase_if(retired_, [](const auto& loader) { return loader->idle(); });
  chooseTargets();
  for (std::uint32_t i = 0; i < bundles_.size(); ++i)
    if (bundles_[i]) evict(i);
  request();
  const auto take = [&] {
    for (std::uint32_t i = 0; i < bundles_.size() && budget_bytes > 0; ++i)
      if (bundles_[i] && bundles_[i]->batch) takeFrom(i, budget_bytes, counters);
  };
  take();
  // A batch is small, so that what matters most can change from frame to frame. Where frames take long,
  // several of them come in one.
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begun = Clock::now();
  const auto left = [&] {
    const std::chrono::duration<double> most(most_wait_s);
    return std::chrono::duration_cast<std::chrono::milliseconds>(most - (Clock::now() - begun));
  };
  while (budget_bytes > 0 && left().count() > 0) {
    request();
    const auto loading =
        std::ranges::find_if(bundles_, [](const auto& bundle) { return bundle && bundle->batch; });
    if (loading == bundles_.end()) break;
    (*loading)->batch->loader->waitForMore(left());
    take();
  }
  for (std::uint32_t i = 0; i < bundles_.size(); ++i) {
    if (!bundles_[i] || !bundles_[i]->replacement) continue;
    if (budget_bytes > 0) uploadReplacement(*bundles_[i], budget_bytes, counters);
    const std::optional<Replacement>& next = bundles_[i]->replacement;
    if (next && isWhole(*next->loader) && !residency_.comes(next->staged)) swapIn(i);
  }
  measureRate(counters.uploaded_bytes - uploaded_before);
  return {};
}

Result<void> World::uploadAll(gpu::Counters& counters) {
  constexpr std::uint64_t kPieceBytes = std::uint64_t{64} << 20;
  // What arrives in one call makes room for what the next one requests. If two calls bring nothing and
  // nothing is being loaded, nothing more will come.
  constexpr int kIdleCalls = 2;
  chooseTargets();  // the camera may have moved since everything had arrived
  for (int idle = 0; !loaded() && idle < kIdleCalls;) {
    const std::uint64_t before = residency_.version();
    if (Result<void> done = upload(kPieceBytes, counters); !done) return done;
    idle = residency_.version() == before ? idle + 1 : 0;
    for (std::optional<Bundle>& bundle : bundles_) {
      if (bundle && bundle->batch) bundle->batch->loader->waitForMore();
      if (bundle && bundle->replacement) bundle->replacement->loader->waitForMore();
      if (bundle && (bundle->batch || bundle->replacement)) idle = 0;
    }
  }
  const std::vector<BundleError> wrong = errors();
  return wrong.empty() ? Result<void>{} : failAgain(wrong.front().error);
}

bool World::loaded() const {
  return chosen_.bundles == bundles_version_ &&
         std::ranges::all_of(bundles_, [](const std::optional<Bundle>& bundle) {
           return !bundle || (settled(*bundle) && !bundle->replacement);
         });
}

BundleStatus World::status(std::uint32_t bundle) const {
  BundleStatus status;
  if (!isOpen(bundle)) return status;
  const Bundle& one = *bundles_[bundle];
  using State = BundleStatus::State;
  const auto whole = [&] {
    return std::ranges::equal(one.steps, one.parts.units, {}, {}, &streaming::Unit::size);
  };
  status.state = one.error       ? State::Damaged
                 : !settled(one) ? State::Loading
                 : whole()       ? State::Whole
                                 : State::Partial;
  status.path = one.reader->path();
  status.bundle_id = one.options.bundle_id;
  status.instance = one.options.instance;
  if (one.replacement) status.replacement = one.replacement->reader->path();
  status.error = one.error ? one.error : one.replacement_error;
  return status;
}

std::vector<BundleError> World::errors() const {
  std::vector<BundleError> errors;
  for (std::uint32_t i = 0; i < bundles_.size(); ++i)
    if (const std::optional<Error> error = status(i).error) errors.push_back({i, *error});
  return errors;
}

}  // namespace lambent::frame
