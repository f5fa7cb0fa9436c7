// The bundles that are shown: their readers, loaders, entities and what of them is on the GPU. open() makes a
// bundle's entities at once and starts loading; upload() brings over what has arrived, within a budget;
// groups and draws are then asked for in the order of the residency's tables. A bundle keeps its slot until
// it is closed; replace() brings another file beside it and swaps that in when it is whole. Render thread
// only. What goes wrong with a bundle while it loads is told by status() and errors(), and the others are
// shown.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/bundle/reader.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/scene/animation.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/instantiate.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/streaming/loader.hpp"
#include "runtime/streaming/parts.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::frame {

struct WorldOptions {
  // Of GPU memory that the bundles may take together; what the camera sees large comes first (interest.hpp).
  // Beside that lie only a replacement on its way, a texture while it becomes finer, and the surfaces of one
  // bundle that are more by themselves.
  std::uint64_t max_resident_bytes = ~std::uint64_t{0};
};

// How much of the bundles has been brought.
struct LoadedParts {
  std::uint64_t bytes_loaded = 0, bytes_in_bundles = 0;  // of the files
  std::uint64_t planes_resident = 0, planes_in_bundles = 0;
};

struct OpenOptions {
  // What StableIds call the bundle by, whatever file it is in; empty: its path.
  std::string bundle_id{};
  // Of those with the same id; none: the first that is free.
  std::optional<std::uint32_t> instance{};
};

struct BundleStatus {
  enum class State {
    Closed,
    Loading,
    Partial,  // all that there is room for is here
    Whole,
    Damaged  // what came before the error is shown
  };
  State state = State::Closed;
  std::filesystem::path path;  // of what is shown
  std::string bundle_id;
  std::uint32_t instance = 0;
  std::filesystem::path replacement;  // on its way; empty: none
  std::optional<Error> error;         // of what is shown, else of the last replacement, which was given up
};

struct BundleError {
  std::uint32_t bundle = 0;
  Error error;
};

// How a bundle is in the picture.
enum class Shown : std::uint8_t {
  Nothing,
  ProxyLod,  // its groups as others see them: a few triangles, without shadows
  Partly,    // its surfaces, of whose transfer something is missing
  Full
};

struct BundleStreaming {
  std::uint32_t bundle = 0;
  std::string name;  // of the file
  // Of GPU memory: all of it, what is wanted now, what is here.
  std::uint64_t whole_bytes = 0, wanted_bytes = 0, resident_bytes = 0;
  float size = 0.0f;  // as the camera sees it: what is larger comes first
  BundleStatus::State state = BundleStatus::State::Closed;
  Shown shown = Shown::Nothing;
};

struct StreamingStatus {
  std::uint64_t budget_bytes = 0;    // all bits: without limit
  std::uint64_t resident_bytes = 0;  // proxy levels of detail among them
  std::uint64_t proxy_lod_bytes = 0;
  std::uint32_t queued = 0;  // items that are wanted and not here
  std::uint64_t in_flight_bytes = 0;
  double megabytes_per_s = 0.0;  // over the last second or so
  std::vector<BundleStreaming> bundles;

  std::size_t count(Shown shown) const;
};

// A bundle whose surfaces are not here: by group, as others see it; none: nothing to see.
struct ProxyLod {
  std::uint32_t bundle = 0;
  std::uint64_t id = 0;  // of these proxies; no others ever have it
  std::span<const std::optional<bundle::CaptureProxy>> proxies;
};

class World {
 public:
  explicit World(const WorldOptions& options = {}) : max_resident_bytes_(options.max_resident_bytes) {}

  // Returns the bundle's slot: the first that is free. Errors: a file that is no bundle; nothing has changed
  // then.
  Result<std::uint32_t> open(const std::filesystem::path& path, const OpenOptions& options = {});
  // Its entities, its memory and what was on its way. Others keep their slots.
  void close(std::uint32_t bundle);
  // Shows what is in this file in the place of the bundle, once all of it is here, in one frame; until then
  // the old one stays, and for good if the file turns out damaged. What was changed by hand stays
  // (exchange.hpp), and entities that are in both stay the same. Whatever else was to replace the bundle is
  // given up. Errors: a file that is no bundle; also in status().
  Result<void> replace(std::uint32_t bundle, const std::filesystem::path& path);

  // Slots, closed ones among them: these have no description and no instance.
  std::size_t bundleCount() const { return bundles_.size(); }
  bool isOpen(std::uint32_t bundle) const { return bundle < bundles_.size() && bundles_[bundle].has_value(); }
  BundleStatus status(std::uint32_t bundle) const;
  std::vector<BundleError> errors() const;

  // From where the world is seen: what is larger in sight is brought first, and stays where there is no room
  // for all. Without it all bundles are alike.
  void look(const spec::View& view) { view_ = view; }
  StreamingStatus streaming() const;

  // Where room is limited, surfaces are shown from when all of a bundle's are here, and something stands in
  // for them until then: never both. Valid until the world changes.
  std::vector<ProxyLod> proxyLods() const;
  // Rises when others stand in.
  std::uint64_t proxyLodsVersion() const { return proxy_lods_version_; }
  bool showsSurfaces(std::uint32_t bundle) const;

  // Up to about `budget_bytes` of what is ready; never waits.
  Result<void> upload(std::uint64_t budget_bytes, gpu::Counters& counters);
  // Waits until everything is resident that there is room for, and every replacement is shown. Errors: the
  // first of errors(), after all else has come.
  Result<void> uploadAll(gpu::Counters& counters);
  // Nothing is on its way.
  bool loaded() const;
  LoadedParts loadedParts() const;

  void updateTransforms();
  // All animations of the bundles, before updateTransforms.
  void playAnimations(float seconds);
  void setAnimationTime(float time_s);
  std::uint64_t transformsVersion() const { return registry_.version<scene::WorldTransform>(); }

  // Takes over what was changed in MaterialComponents; each that was touched gives a new version.
  void updateMaterials();
  std::uint64_t materialsVersion() const { return materials_version_; }
  // As it is now, and as the bundle was baked with; of draws without a material glTF's default.
  const gltf::Material& material(std::size_t draw) const;
  const gltf::Material& bakedMaterial(std::size_t draw) const;

  // In the order of residency().groups() and draws().
  // By which a group is known: that of a replaced bundle has the key of the one whose entity it shares, and
  // no other group ever has it.
  std::uint64_t keyOf(std::size_t group) const;
  // Where the group's frame stands now, with scale if it has any since it was baked.
  glm::mat4 worldFromGroup(std::size_t group) const;
  // Of a group of a bundle's description, resident or not: the same.
  glm::mat4 worldFromGroup(std::uint32_t bundle, std::uint32_t group) const;
  // Group frame, as baked.
  const scene::Box& groupBounds(std::size_t group) const { return group_bounds_[group]; }
  // What the group's own lights give now, by light column. A lamp that was moved out of its place in the
  // group gives nothing here: its column no longer holds.
  std::vector<glm::vec3> lampsOf(std::size_t group) const;
  std::vector<glm::vec3> lampsOf(std::uint32_t bundle, std::uint32_t group) const;
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
    return bundles_[bundle]->reader->description();
  }
  const scene::SceneInstance& instance(std::size_t bundle) const { return bundles_[bundle]->instance; }

 private:
  // Steps on their way, in the order in which they were asked for.
  struct Piece {
    std::uint32_t unit = 0;
    std::vector<streaming::Work> work;
    std::size_t items = 0;  // still to come
    bool begun = false;
    std::uint64_t bytes = 0;
    std::uint32_t steps = 1;  // of an image it may bring several at once
  };
  struct Batch {
    streaming::Loader loader;
    std::deque<Piece> pieces;
  };
  using Proxies = std::vector<std::optional<bundle::CaptureProxy>>;  // by group
  struct Replacement {
    std::shared_ptr<const bundle::Reader> reader;
    streaming::Parts parts;
    Proxies proxies;
    std::vector<std::uint32_t> steps;  // of each unit that are brought
    streaming::Loader loader;
    streaming::Residency::Staged staged = 0;
  };
  struct Bundle {
    std::shared_ptr<const bundle::Reader> reader;
    scene::InstantiateOptions options;
    scene::SceneInstance instance;
    std::vector<glm::mat4> world_from_node_at_rest;
    streaming::Parts parts;
    std::vector<float> size;                   // by unit, as the camera sees it
    std::vector<std::uint32_t> target, steps;  // by unit: that should be here, that are
    Proxies proxies;                           // of its proxy level of detail
    std::uint64_t proxies_id = 0;
    std::optional<Batch> batch;
    std::uint64_t bytes_read = 0;           // before the batch
    std::vector<gltf::Material> materials;  // as they are now
    std::optional<Replacement> replacement;
    std::optional<Error> error, replacement_error;
  };
  static Error inBundle(const bundle::Reader& reader, const Error& error);
  bool limited() const { return max_resident_bytes_ != ~std::uint64_t{0}; }
  std::uint32_t freeInstance(const std::string& bundle_id) const;
  void setParts(Bundle& bundle, streaming::Parts parts) const;
  std::vector<std::uint32_t> stepsForReplacement(std::uint32_t slot, const streaming::Parts& parts) const;
  void dropReplacement(Bundle& bundle);
  void uploadReplacement(Bundle& bundle, std::uint64_t& budget_bytes, gpu::Counters& counters);
  void swapIn(std::uint32_t slot);
  // What is kept per group and draw, after the residency's tables have changed.
  void rebuildTables();

  // Following the camera: what should be here; what goes; what is asked for; what has come.
  void chooseTargets();
  void seeBundle(Bundle& bundle) const;
  void evict(std::uint32_t slot);
  void dropTo(std::uint32_t slot, std::uint32_t unit, std::uint32_t steps);
  void cancelBatch(std::uint32_t slot);
  void retire(Bundle& bundle);
  void request();
  bool startBatch(std::uint32_t slot);
  void countOne(Bundle& bundle);  // of the items of its batch has come
  void takeFrom(std::uint32_t slot, std::uint64_t& budget_bytes, gpu::Counters& counters);
  std::uint64_t bytesTaken() const;  // by what is here or on its way
  static bool settled(const Bundle& bundle) {
    return bundle.error || (bundle.steps == bundle.target && !bundle.batch);
  }
  void measureRate(std::uint64_t bytes);
  std::vector<scene::AnimatedBundle> animatedBundles() const;
  const scene::RigidGroupComponent* rigidGroup(std::uint32_t bundle, std::uint32_t group) const;
  const scene::RigidGroupComponent* rigidGroup(std::size_t group) const;
  bool inPlace(std::uint32_t bundle, std::uint32_t group, std::size_t column) const;
  // Proxy levels of detail.
  static bool hasSurfaces(const streaming::Parts& parts, const std::vector<std::uint32_t>& steps) {
    return steps.front() == parts.surfaceSteps();
  }
  Result<void> accept(std::uint32_t slot, streaming::Ready item);
  Result<void> beginSurfaces(std::uint32_t slot);
  void endSurfaces(std::uint32_t slot);
  void dropProxyLod(Bundle& bundle);

  ecs::Registry registry_;
  streaming::Residency residency_;
  ThreadPool threads_;                          // of the loaders below
  std::vector<std::optional<Bundle>> bundles_;  // by slot
  std::vector<ecs::Entity> lamp_of_draw_;       // none: not a lamp of its group
  std::vector<scene::Box> group_bounds_;
  std::uint64_t materials_seen_ = 0, materials_version_ = 1;
  std::uint64_t max_resident_bytes_;
  std::optional<spec::View> view_;
  struct Chosen {  // for what
    std::optional<spec::View> view;
    std::uint64_t transforms = 0, bundles = 0;
  };
  Chosen chosen_;
  std::uint64_t bundles_version_ = 1;  // rises when one is opened, closed or replaced
  std::uint64_t proxy_lods_version_ = 1, next_proxies_id_ = 1;
  std::vector<streaming::Loader> retired_;  // until their workers have ended
  struct Rate {
    std::chrono::steady_clock::time_point since = std::chrono::steady_clock::now();
    std::uint64_t bytes = 0;
    double megabytes_per_s = 0.0;
  };
  Rate rate_;
};

}  // namespace lambent::frame
