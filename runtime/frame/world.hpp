// The bundles that are shown: their readers, loaders, entities and what of them is on the GPU. open() makes a
// bundle's entities at once and starts loading; upload() brings over what has arrived, within a budget;
// groups and draws are then asked for in the order of the residency's tables. Render thread only. Errors name
// the bundle.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/reader.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/scene/animation.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/instantiate.hpp"
#include "runtime/streaming/loader.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::frame {

struct WorldOptions {
  // Of GPU memory that the bundles may take together. Weight planes that have no room stay away: first those
  // of the bundles opened last. What is needed to show surfaces at all is always brought.
  std::uint64_t max_resident_bytes = ~std::uint64_t{0};
};

// How much of the bundles has been brought.
struct LoadedParts {
  std::uint64_t bytes_loaded = 0, bytes_in_bundles = 0;  // of the files
  std::uint64_t planes_resident = 0, planes_in_bundles = 0;
};

class World {
 public:
  explicit World(const WorldOptions& options = {}) : room_bytes_(options.max_resident_bytes) {}

  Result<void> open(const std::filesystem::path& path);

  // Up to about `budget_bytes` of what is ready; never waits.
  Result<void> upload(std::uint64_t budget_bytes, gpu::Counters& counters);
  // Waits until everything is resident.
  Result<void> uploadAll(gpu::Counters& counters);
  bool loaded() const;
  LoadedParts loadedParts() const;

  void updateTransforms();
  // All animations of the bundles, before updateTransforms.
  void playAnimations(float seconds);
  void setAnimationTime(float time_s);
  std::uint64_t transformsVersion() const { return registry_.version<scene::WorldTransform>(); }

  // In the order of residency().groups() and draws().
  // Where the group's frame stands now, with scale if it has any since it was baked.
  glm::mat4 worldFromGroup(std::size_t group) const;
  // Group frame, as baked.
  const scene::Box& groupBounds(std::size_t group) const { return group_bounds_[group]; }
  // What the group's own lights give now, by light column. A lamp that was moved out of its place in the
  // group gives nothing here: its column no longer holds.
  std::vector<glm::vec3> lampsOf(std::size_t group) const;
  // Whether the light is one of the group's own and stands in its place.
  bool litByColumn(std::size_t group, ecs::Entity light) const;
  glm::quat rotationOf(std::size_t group) const;
  glm::mat4 worldFromMesh(std::size_t draw) const;
  // Radiance that the draw's material gives off now, before its texture: its lamp's where it is one in its
  // group, else the material's own.
  glm::vec3 emission(std::size_t draw) const;
  // Rises when what an emissive material gives off changes.
  std::uint64_t lampsVersion() const { return registry_.version<scene::LampComponent>(); }
  // Multiplies the strength of all lights that the bundles bring with them.
  void scaleLamps(float factor);

  streaming::Residency& residency() { return residency_; }
  const streaming::Residency& residency() const { return residency_; }
  ecs::Registry& registry() { return registry_; }
  const ecs::Registry& registry() const { return registry_; }
  const bundle::Description& description(std::size_t bundle) const {
    return bundles_[bundle].reader->description();
  }
  const scene::SceneInstance& instance(std::size_t bundle) const { return bundles_[bundle].instance; }
  std::size_t bundleCount() const { return bundles_.size(); }

 private:
  struct Bundle {
    std::shared_ptr<const bundle::Reader> reader;
    streaming::Loader loader;
    scene::SceneInstance instance;
    std::vector<glm::mat4> world_from_node_at_rest;
  };
  std::vector<scene::AnimatedBundle> animatedBundles() const;
  const scene::RigidGroupComponent* rigidGroup(std::size_t group) const;
  bool inPlace(std::size_t group, std::size_t column) const;
  Result<std::uint64_t> uploadFrom(std::uint32_t bundle, std::uint64_t budget_bytes, gpu::Counters& counters);

  ecs::Registry registry_;
  streaming::Residency residency_;
  std::vector<Bundle> bundles_;
  std::vector<ecs::Entity> lamp_of_draw_;  // none: not a lamp of its group
  std::vector<scene::Box> group_bounds_;
  std::uint64_t room_bytes_;  // left for bundles yet to be opened
};

}  // namespace lambent::frame
