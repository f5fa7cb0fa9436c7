#include "runtime/frame/world.hpp"

#include <algorithm>
#include <thread>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "runtime/scene/transforms.hpp"
#include "runtime/streaming/budget.hpp"

namespace lambent::frame {

namespace {

ecs::Entity lampOf(const bundle::Description& description, const scene::SceneInstance& instance,
                   const bundle::Draw& draw) {
  const std::int32_t material = description.meshes[draw.mesh].primitives[draw.primitive].material;
  const auto& lights = description.groups[draw.group].lights;
  for (std::size_t k = 0; k < lights.size(); ++k)
    if (lights[k].kind == bundle::GroupLight::Kind::Material &&
        static_cast<std::int32_t>(lights[k].index) == material)
      return instance.lamps[draw.group][k];
  return {};
}

// What a light column of a group is multiplied with. A lamp that was taken out of the scene is dark.
glm::vec3 radianceOf(const ecs::Registry& registry, ecs::Entity entity) {
  if (const auto* material = registry.tryGet<scene::LampComponent>(entity)) return material->radiance();
  const auto* lamp = registry.tryGet<scene::LocalLightComponent>(entity);
  return lamp ? lamp->power() : glm::vec3(0.0f);
}

}  // namespace

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
  bundle::Description wanted = reader->description();
  if (room_bytes_ != ~std::uint64_t{0}) {
    Result<streaming::Budgeted> budgeted = streaming::withinBudget(*reader, room_bytes_);
    if (!budgeted) return failAgain(budgeted.error());
    room_bytes_ -= std::min(room_bytes_, budgeted->bytes);
    wanted = std::move(budgeted->description);
  }
  if (const Result<std::uint32_t> added = residency_.add(wanted); !added)
    return fail(path.string(), added.error().subject + ": " + added.error().problem, added.error().mend);
  const unsigned threads = std::max(1u, std::thread::hardware_concurrency());
  for (const bundle::Group& group : wanted.groups)
    group_bounds_.push_back({group.bounds_min, group.bounds_max});
  for (const bundle::Draw& draw : wanted.draws)
    lamp_of_draw_.push_back(lampOf(reader->description(), *instance, draw));
  bundles_.push_back({.reader = reader,
                      .loader = streaming::Loader(reader, std::move(wanted), threads),
                      .instance = std::move(*instance),
                      .world_from_node_at_rest = gltf::worldTransforms(reader->description().nodes)});
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

std::vector<scene::AnimatedBundle> World::animatedBundles() const {
  std::vector<scene::AnimatedBundle> animated;
  for (std::size_t i = 0; i < bundles_.size(); ++i)
    animated.push_back({.bundle = static_cast<std::uint32_t>(i),
                        .description = &bundles_[i].reader->description(),
                        .instance = &bundles_[i].instance});
  return animated;
}

void World::playAnimations(float seconds) {
  scene::playAnimations(registry_, animatedBundles(), seconds);
}

void World::setAnimationTime(float time_s) {
  scene::setAnimationTime(registry_, animatedBundles(), time_s);
}

void World::updateTransforms() {
  scene::updateTransforms(registry_);
}

const scene::RigidGroupComponent* World::rigidGroup(std::size_t group) const {
  const streaming::ResidentGroup& resident = residency_.groups()[group];
  return registry_.tryGet<scene::RigidGroupComponent>(
      bundles_[resident.bundle].instance.groups[resident.index]);
}

glm::quat World::rotationOf(std::size_t group) const {
  const auto* rigid = rigidGroup(group);
  return rigid ? rigid->rotation : glm::quat(1.0f, 0.0f, 0.0f, 0.0f);
}

glm::mat4 World::worldFromGroup(std::size_t group) const {
  const auto* rigid = rigidGroup(group);
  if (!rigid) return glm::mat4(1.0f);
  glm::mat4 rest = glm::mat4_cast(rigid->rest_rotation);
  rest[3] = glm::vec4(rigid->rest_translation, 1.0f);
  return rigid->world_from_rest * rest;
}

bool World::inPlace(std::size_t group, std::size_t column) const {
  const streaming::ResidentGroup& resident = residency_.groups()[group];
  const Bundle& bundle = bundles_[resident.bundle];
  const bundle::GroupLight& light = bundle.reader->description().groups[resident.index].lights[column];
  if (light.kind == bundle::GroupLight::Kind::Material) return true;
  const auto* now = registry_.tryGet<scene::WorldTransform>(bundle.instance.nodes[light.index]);
  const auto* rigid = rigidGroup(group);
  if (!now || !rigid) return false;
  const glm::mat4 expected = rigid->world_from_rest * bundle.world_from_node_at_rest[light.index];
  // Rounding of matrices that were composed another way round.
  constexpr float kTolerance = 1e-4f;
  const scene::Box& bounds = group_bounds_[group];
  const float size = bounds.empty() ? 0.0f : bounds.radius();
  if (glm::distance(glm::vec3(expected[3]), glm::vec3(now->world_from_node[3])) > kTolerance * size)
    return false;
  const auto axis = [](const glm::mat4& matrix) {
    const glm::vec3 z(matrix[2]);
    const float length = glm::length(z);
    return length > 0.0f ? z / length : z;
  };
  return glm::distance(axis(expected), axis(now->world_from_node)) <= kTolerance;
}

std::vector<glm::vec3> World::lampsOf(std::size_t group) const {
  const streaming::ResidentGroup& resident = residency_.groups()[group];
  std::vector<glm::vec3> lamps;
  for (const ecs::Entity lamp : bundles_[resident.bundle].instance.lamps[resident.index])
    lamps.push_back(inPlace(group, lamps.size()) ? radianceOf(registry_, lamp) : glm::vec3(0.0f));
  return lamps;
}

bool World::litByColumn(std::size_t group, ecs::Entity light) const {
  const streaming::ResidentGroup& resident = residency_.groups()[group];
  const auto& lamps = bundles_[resident.bundle].instance.lamps[resident.index];
  for (std::size_t k = 0; k < lamps.size(); ++k)
    if (lamps[k] == light) return inPlace(group, k);
  return false;
}

glm::vec3 World::emission(std::size_t draw) const {
  if (lamp_of_draw_[draw] != ecs::Entity{}) return radianceOf(registry_, lamp_of_draw_[draw]);
  const streaming::ResidentDraw& resident = residency_.draws()[draw];
  const auto& materials = residency_.bundles()[resident.bundle].materials;
  return resident.material >= 0 ? materials[static_cast<std::size_t>(resident.material)].emissive
                                : glm::vec3(0.0f);
}

void World::scaleLamps(float factor) {
  for (auto [entity, lamp] : registry_.view<const scene::LampComponent>())
    registry_.edit<scene::LampComponent>(entity).strength *= factor;
  for (const Bundle& bundle : bundles_)
    for (const ecs::Entity node : bundle.instance.nodes)
      if (registry_.has<scene::LocalLightComponent>(node))
        registry_.edit<scene::LocalLightComponent>(node).strength *= factor;
}

LoadedParts World::loadedParts() const {
  LoadedParts parts{.planes_resident = residency_.planesResident()};
  for (const Bundle& bundle : bundles_) {
    parts.bytes_loaded += bundle.loader.bytesRead();
    parts.bytes_in_bundles += bundle.reader->fileBytes();
    for (const bundle::Group& group : bundle.reader->description().groups)
      for (const bundle::Cell& cell : group.cells)
        for (const bundle::CellTransfer& transfer : cell.transfers)
          parts.planes_in_bundles += transfer.planes.size();
  }
  return parts;
}

glm::mat4 World::worldFromMesh(std::size_t draw) const {
  const streaming::ResidentDraw& resident = residency_.draws()[draw];
  const auto* item =
      registry_.tryGet<scene::DrawItem>(bundles_[resident.bundle].instance.draws[resident.index]);
  const auto* place = item ? registry_.tryGet<scene::WorldTransform>(item->node) : nullptr;
  return place ? place->world_from_node : glm::mat4(1.0f);
}

}  // namespace lambent::frame
