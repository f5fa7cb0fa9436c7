#include "lambent/scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include "runtime/library/convert.hpp"
#include "runtime/library/state.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/scene/instantiate.hpp"
#include "runtime/scene/transforms.hpp"

namespace lambent {

namespace {

using library::failureOf;
using library::fromGlm;
using library::toGlm;
using Component = scene::LocalLightComponent;

// These convert an entity to one number, and back.
std::uint64_t idOf(ecs::Entity entity) {
  return std::uint64_t{entity.generation} << 32 | entity.index;
}
ecs::Entity entityOf(std::uint64_t id) {
  return {.index = static_cast<std::uint32_t>(id), .generation = static_cast<std::uint32_t>(id >> 32)};
}

static_assert(static_cast<int>(Component::Kind::Disc) == static_cast<int>(Light::Kind::Disc));

Expected<void> checkLight(const Light& light) {
  const auto wrong = [](const char* what) { return Failure{"light", what, {}}; };
  for (const Vec3& v : {light.position, light.direction, light.color})
    if (!std::isfinite(v.x + v.y + v.z))
      return wrong("has a position, direction or colour that is not finite");
  if (std::min({light.color.x, light.color.y, light.color.z}) < 0.0f) return wrong("has a negative colour");
  if (!(light.strength >= 0.0f) || !(light.radius >= 0.0f) || !(light.range >= 0.0f))
    return wrong("has a strength, radius or range that is negative or not a number");
  if (light.strength * std::max({light.color.x, light.color.y, light.color.z}) > spec::kMostRadiance ||
      !std::isfinite(light.radius) || !std::isfinite(light.range))
    return wrong("is stronger than 1e15, or its radius or range is not finite");
  if (!(glm::length(toGlm(light.direction)) > 0.0f)) return wrong("has a direction of length 0");
  if (!(light.inner_cone_deg >= 0.0f && light.inner_cone_deg <= light.outer_cone_deg &&
        light.outer_cone_deg <= 90.0f))
    return wrong("has cones that are not 0 <= inner <= outer <= 90 degrees");
  return {};
}

void writeLight(ecs::Registry& registry, ecs::Entity entity, const Light& light) {
  scene::Transform place;
  place.translation = toGlm(light.position);
  place.rotation = scene::facing(toGlm(light.direction));
  registry.emplace<scene::Transform>(entity, place);
  registry.emplace<Component>(entity, Component{.kind = static_cast<Component::Kind>(light.kind),
                                                .color = toGlm(light.color),
                                                .strength = light.strength,
                                                .radius_m = light.radius,
                                                .range_m = light.range,
                                                .inner_cone_rad = glm::radians(light.inner_cone_deg),
                                                .outer_cone_rad = glm::radians(light.outer_cone_deg)});
}

}  // namespace

Scene::Scene(std::unique_ptr<State> state) : state_(std::move(state)) {}
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

Expected<Scene> Scene::create(std::uint64_t max_gpu_bytes) {
  const Result<gpu::Context> context = gpu::Context::attachToCurrent({.debug = false});
  if (!context) return failureOf(context.error());
  Result<lighting::Environment> environment = lighting::Environment::create({});
  if (!environment) return failureOf(environment.error());
  return Scene(std::make_unique<State>(State{.world = frame::World({.max_resident_bytes = max_gpu_bytes}),
                                             .environment = std::move(*environment)}));
}

Expected<BundleId> Scene::open(const std::string& path) {
  const Result<std::uint32_t> opened = state_->world.open(path);
  if (!opened) return failureOf(opened.error());
  return BundleId{*opened};
}

void Scene::close(BundleId bundle) {
  if (state_->world.isOpen(bundle.value)) state_->world.close(bundle.value);
}

bool Scene::loading() const {
  return !state_->world.loaded();
}

Expected<void> Scene::finishLoading() {
  const library::HostState host;
  gpu::Counters counters;
  if (const Result<void> done = state_->world.uploadAll(counters); !done) return failureOf(done.error());
  return {};
}

Expected<void> Scene::setEnvironment(const std::vector<std::string>& words) {
  const auto lights = library::distantLights(
      words, {"environment", "spheres and discs stand in the scene", "add them with addLight()"});
  if (!lights) return lights.failure();
  if (const Result<void> set = state_->environment.setLights(*lights); !set) return failureOf(set.error());
  return {};
}

void Scene::turnEnvironment(float degrees) {
  state_->environment.setTurn(degrees);
}

void Scene::scaleEnvironment(float factor) {
  state_->environment.setIntensity(factor);
}

Expected<LightId> Scene::addLight(const Light& light) {
  if (auto checked = checkLight(light); !checked) return checked.failure();
  ecs::Registry& registry = state_->world.registry();
  const ecs::Entity entity = registry.create();
  writeLight(registry, entity, light);
  return LightId{idOf(entity)};
}

Expected<void> Scene::setLight(LightId id, const Light& light) {
  if (auto checked = checkLight(light); !checked) return checked;
  ecs::Registry& registry = state_->world.registry();
  const ecs::Entity entity = entityOf(id.value);
  if (!registry.alive(entity) || !registry.has<Component>(entity))
    return Failure{"light", "is no longer there", "add it again"};
  writeLight(registry, entity, light);
  return {};
}

void Scene::removeLight(LightId id) {
  ecs::Registry& registry = state_->world.registry();
  const ecs::Entity entity = entityOf(id.value);
  if (registry.alive(entity) && registry.has<Component>(entity)) registry.destroy(entity);
}

std::vector<Body> Scene::bodies() const {
  std::vector<Body> bodies;
  frame::World& world = state_->world;
  world.updateTransforms();
  for (auto [entity, group] : world.registry().view<const scene::RigidGroupComponent>()) {
    Body body{.id = {idOf(group.node)},
              .bundle = {group.bundle},
              .name = world.description(group.bundle).groups[group.group].name};
    if (const auto* place = world.registry().tryGet<scene::WorldTransform>(group.node))
      body.world_from_body = fromGlm(place->world_from_node);
    bodies.push_back(std::move(body));
  }
  return bodies;
}

Expected<void> Scene::place(BodyId id, const Matrix4& world_from_body) {
  float sum = 0.0f;
  for (const float entry : world_from_body) sum += entry;
  if (!std::isfinite(sum)) return Failure{"matrix", "has an entry that is not finite", {}};
  if (world_from_body[3] != 0.0f || world_from_body[7] != 0.0f || world_from_body[11] != 0.0f ||
      world_from_body[15] != 1.0f)
    return Failure{"matrix", "is not affine", "its last row is 0, 0, 0, 1"};
  frame::World& world = state_->world;
  ecs::Registry& registry = world.registry();
  const ecs::Entity entity = entityOf(id.value);
  if (!registry.alive(entity) || !registry.has<scene::Transform>(entity))
    return Failure{"body", "is no longer there", "ask for bodies() again"};
  world.updateTransforms();
  glm::mat4 parent_from_body = toGlm(world_from_body);
  if (const auto* parent =
          registry.tryGet<scene::WorldTransform>(registry.get<scene::Transform>(entity).parent)) {
    if (glm::determinant(glm::mat3(parent->world_from_node)) == 0.0f)
      return Failure{"body", "has a parent that is scaled flat", {}};
    parent_from_body = glm::inverse(parent->world_from_node) * parent_from_body;
  }
  scene::setLocalMatrix(registry.edit<scene::Transform>(entity), parent_from_body);
  return {};
}

void Scene::play(float seconds) {
  state_->world.playAnimations(seconds);
}

void Scene::setAnimationTime(float seconds) {
  state_->world.setAnimationTime(seconds);
}

std::array<double, 3> Scene::origin() const {
  const glm::dvec3& origin = state_->world.origin();
  return {origin.x, origin.y, origin.z};
}

Box Scene::bounds() const {
  state_->world.updateTransforms();
  const scene::Box box = scene::worldBounds(state_->world.registry());
  return box.empty() ? Box{} : Box{fromGlm(box.min), fromGlm(box.max)};
}

}  // namespace lambent
