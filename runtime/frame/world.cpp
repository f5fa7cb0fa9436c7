#include "runtime/frame/world.hpp"

#include <algorithm>
#include <thread>

#include "runtime/scene/transforms.hpp"

namespace lambent::frame {

Result<void> World::open(const std::filesystem::path& path) {
  Result<bundle::Reader> opened = bundle::Reader::open(path);
  if (!opened) return failAgain(opened.error());
  auto reader = std::make_shared<const bundle::Reader>(std::move(*opened));
  const auto index = static_cast<std::uint32_t>(bundles_.size());
  // The same file twice is two instances of it.
  const auto instance_number = static_cast<std::uint32_t>(std::count_if(
      bundles_.begin(), bundles_.end(), [&](const Bundle& other) { return other.reader->path() == path; }));
  Result<scene::SceneInstance> instance =
      scene::instantiate(registry_, reader->description(),
                         {.bundle_index = index, .bundle_id = path.string(), .instance = instance_number});
  if (!instance) return failAgain(instance.error());
  if (const Result<std::uint32_t> added = residency_.add(reader->description()); !added)
    return fail(path.string(), added.error().subject + ": " + added.error().problem, added.error().mend);
  const unsigned threads = std::max(1u, std::thread::hardware_concurrency());
  bundles_.push_back(
      {.reader = reader, .loader = streaming::Loader(reader, threads), .instance = std::move(*instance)});
  return {};
}

Result<std::uint64_t> World::uploadFrom(std::uint32_t bundle, std::uint64_t budget_bytes,
                                        gpu::Counters& counters) {
  std::uint64_t bytes = 0;
  const std::string subject = bundles_[bundle].reader->path().string();
  for (const streaming::Ready& item : bundles_[bundle].loader.take(budget_bytes)) {
    bytes += streaming::Residency::uploadBytes(item);
    if (const Result<void> done = residency_.upload(bundle, item); !done)
      return fail(subject, done.error().subject + ": " + done.error().problem, done.error().mend);
  }
  if (const auto error = bundles_[bundle].loader.error()) return failAgain(*error);
  counters.uploaded_bytes += bytes;
  return bytes;
}

Result<void> World::upload(std::uint64_t budget_bytes, gpu::Counters& counters) {
  for (std::uint32_t i = 0; i < bundles_.size() && budget_bytes > 0; ++i) {
    const Result<std::uint64_t> bytes = uploadFrom(i, budget_bytes, counters);
    if (!bytes) return failAgain(bytes.error());
    budget_bytes -= std::min(budget_bytes, *bytes);
  }
  return {};
}

Result<void> World::uploadAll(gpu::Counters& counters) {
  constexpr std::uint64_t kPieceBytes = std::uint64_t{64} << 20;
  for (std::uint32_t i = 0; i < bundles_.size(); ++i)
    while (!bundles_[i].loader.finished()) {
      bundles_[i].loader.waitForMore();
      if (const Result<std::uint64_t> bytes = uploadFrom(i, kPieceBytes, counters); !bytes)
        return failAgain(bytes.error());
    }
  return {};
}

bool World::loaded() const {
  return std::all_of(bundles_.begin(), bundles_.end(),
                     [](const Bundle& bundle) { return bundle.loader.finished(); });
}

void World::updateTransforms() {
  scene::updateTransforms(registry_);
}

std::vector<lighting::GroupPlace> World::groupPlaces() const {
  std::vector<lighting::GroupPlace> places;
  places.reserve(residency_.groups().size());
  for (const streaming::ResidentGroup& group : residency_.groups()) {
    const ecs::Entity entity = bundles_[group.bundle].instance.groups[group.index];
    const auto* rigid = registry_.tryGet<scene::RigidGroupComponent>(entity);
    places.push_back({.world_from_group = rigid ? rigid->rotation : glm::quat(1.0f, 0.0f, 0.0f, 0.0f),
                      .order = group.order,
                      .light_columns = group.light_columns});
  }
  return places;
}

glm::mat4 World::worldFromMesh(std::size_t draw) const {
  const streaming::ResidentDraw& resident = residency_.draws()[draw];
  const auto* item =
      registry_.tryGet<scene::DrawItem>(bundles_[resident.bundle].instance.draws[resident.index]);
  const auto* place = item ? registry_.tryGet<scene::WorldTransform>(item->node) : nullptr;
  return place ? place->world_from_node : glm::mat4(1.0f);
}

}  // namespace lambent::frame
