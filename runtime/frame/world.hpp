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
#include "runtime/scene/components.hpp"
#include "runtime/scene/instantiate.hpp"
#include "runtime/streaming/loader.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::frame {

class World {
 public:
  Result<void> open(const std::filesystem::path& path);

  // Up to about `budget_bytes` of what is ready; never waits.
  Result<void> upload(std::uint64_t budget_bytes, gpu::Counters& counters);
  // Waits until everything is resident.
  Result<void> uploadAll(gpu::Counters& counters);
  bool loaded() const;

  void updateTransforms();
  std::uint64_t transformsVersion() const { return registry_.version<scene::WorldTransform>(); }

  // In the order of residency().groups() and draws().
  std::vector<lighting::GroupPlace> groupPlaces() const;
  glm::mat4 worldFromMesh(std::size_t draw) const;

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
  };
  Result<std::uint64_t> uploadFrom(std::uint32_t bundle, std::uint64_t budget_bytes, gpu::Counters& counters);

  ecs::Registry registry_;
  streaming::Residency residency_;
  std::vector<Bundle> bundles_;
};

}  // namespace lambent::frame
