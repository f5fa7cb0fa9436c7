// Owns the bundles that are shown: their readers, loaders and entities, and what of them is on the GPU.
// open() creates a bundle's entities at once and starts loading; upload() brings over what has arrived,
// within a budget. Groups and draws are numbered in the order of the residency's tables. A bundle keeps its
// slot until it is closed; replace() loads another file beside it and swaps that in when it is complete.
// Render thread only. Errors of a bundle that occur while it loads are reported by status() and errors(), and
// the other bundles are still shown.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/bundle/container.hpp"
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
  // The bundles may take this much GPU memory together; what the camera sees large comes first
  // (streaming/parts.hpp). Only a replacement being loaded, a texture while it gets finer levels, and a
  // single bundle whose surfaces alone exceed the limit come on top.
  std::uint64_t max_resident_bytes = ~std::uint64_t{0};
};

struct OpenOptions {
  // This is the name of the bundle in StableIds, whatever file it is in. If empty, it is the path.
  std::string bundle_id{};
  // This is the number among bundles with the same id. Without it, the first free one is taken.
  std::optional<std::uint32_t> instance{};
};

struct BundleStatus {
  enum class State {
    Closed,
    Loading,
    Partial,  // everything that fits into the memory is here
    Whole,
    Damaged  // what arrived before the error is shown
  };
  State state = State::Closed;
  std::filesystem::path path;  // of what is shown
  std::string bundle_id;
  std::uint32_t instance = 0;
  std::filesystem::path replacement;  // being loaded; empty: none
  std::optional<Error> error;         // of what is shown; otherwise of the last failed replacement
};

struct BundleError {
  std::uint32_t bundle = 0;
  Error error;
};

// States how a bundle appears in the picture.
enum class Shown : std::uint8_t {
  Nothing,
  ProxyLod,  // its groups as capture proxies: a few triangles without shadows
  Partly,    // its surfaces, but part of their transfer is missing
  Full
};

struct BundleStreaming {
  std::uint32_t bundle = 0;
  std::string name;  // of the file
  // These state the GPU memory for everything, for what is wanted now, and for what is here.
  std::uint64_t whole_bytes = 0, wanted_bytes = 0, resident_bytes = 0;
  float size = 0.0f;  // as seen by the camera; larger bundles come first
  BundleStatus::State state = BundleStatus::State::Closed;
  Shown shown = Shown::Nothing;
};

struct StreamingStatus {
  std::uint64_t budget_bytes = 0;    // all bits set: unlimited
  std::uint64_t resident_bytes = 0;  // includes proxy levels of detail
  std::uint64_t proxy_lod_bytes = 0;
  std::uint32_t queued = 0;  // wanted items that are not here yet
  std::uint64_t in_flight_bytes = 0;
  double megabytes_per_s = 0.0;  // over about the last second
  std::vector<BundleStreaming> bundles;

  std::size_t count(Shown shown) const;
};

// Describes a bundle whose surfaces are not here, as capture proxies indexed by group. A group without a
// proxy shows nothing.
struct ProxyLod {
  std::uint32_t bundle = 0;
  std::uint64_t id = 0;  // of this set of proxies; never reused
  std::span<const std::optional<bundle::CaptureProxy>> proxies;
};

class World {
 public:
  explicit World(const WorldOptions& options = {}) : max_resident_bytes_(options.max_resident_bytes) {}

  // Opens a bundle and returns its slot, the first free one. Fails if the file is not a bundle; nothing
  // changes then.
  Result<std::uint32_t> open(const std::filesystem::path& path, const OpenOptions& options = {});
  // Removes the bundle's entities, its memory and what was being loaded. Other bundles keep their slots.
  void close(std::uint32_t bundle);
  // Shows this file in place of the bundle, in one frame, once all of it is here. Until then the old one
  // stays, and it stays for good if the file turns out damaged. Changes made by hand are kept
  // (exchangeInstance), and entities that occur in both stay the same. An earlier replacement still being
  // loaded is cancelled. Fails if the file is not a bundle, which status() then reports too.
  Result<void> replace(std::uint32_t bundle, const std::filesystem::path& path);

  // Returns what positions count from in the world of the files, in m: the origin of the bundle that was
  // opened when no other was open.
  const glm::dvec3& origin() const { return origin_; }

  // Returns the number of slots, including closed ones, which have no description and no instance.
  std::size_t bundleCount() const { return bundles_.size(); }
  bool isOpen(std::uint32_t bundle) const { return bundle < bundles_.size() && bundles_[bundle].has_value(); }
  BundleStatus status(std::uint32_t bundle) const;
  std::vector<BundleError> errors() const;

  // Sets the view that decides what is loaded first, and what is kept when there is not room for everything:
  // what looks larger. Without it all bundles are equal.
  void look(const spec::View& view) { view_ = view; }
  const std::optional<spec::View>& view() const { return view_; }
  StreamingStatus streaming() const;

  // Returns what stands in for surfaces. With limited memory, surfaces are shown once all of a bundle's are
  // here, and a proxy level of detail until then, never both. Valid until the world changes.
  std::vector<ProxyLod> proxyLods() const;
  // Rises when the set of stand-ins changes.
  std::uint64_t proxyLodsVersion() const { return proxy_lods_version_; }
  bool showsSurfaces(std::uint32_t bundle) const;

  // Uploads up to about `budget_bytes` of what is ready. It waits for more, for about this many seconds at
  // most, while there is budget left; 0: it never waits.
  Result<void> upload(std::uint64_t budget_bytes, gpu::Counters& counters, double most_wait_s = 0.0);
  // Waits until everything that there is room for is resident and every replacement is shown. Fails with the
  // first of errors(), after everything else has arrived.
  Result<void> uploadAll(gpu::Counters& counters);
  // Returns whether nothing is being loaded.
  bool loaded() const;

  void updateTransforms();
  // Plays all animations of the bundles. Call it before updateTransforms().
  void playAnimations(float seconds);
  void setAnimationTime(float time_s);
  std::uint64_t transformsVersion() const { return registry_.version<scene::WorldTransform>(); }

  // Takes over changes of MaterialComponents. Each component that was touched gives a new version.
  void updateMaterials();
  std::uint64_t materialsVersion() const { return materials_version_; }
  // Return the material as it is now and as it was baked; for draws without a material, glTF's default.
  const gltf::Material& material(std::size_t draw) const;
  const gltf::Material& bakedMaterial(std::size_t draw) const;

  // Groups and draws below are indices into residency().groups() and draws().
  //
  // Returns the key that identifies a group. A group of a replacement has the key of the group whose entity
  // it takes over; otherwise keys are unique.
  std::uint64_t keyOf(std::size_t group) const;
  // Returns the current placement of the group's frame, with any scale that it was given since the bake.
  glm::mat4 worldFromGroup(std::size_t group) const;
  // Returns the same for a group of a bundle's description, resident or not.
  glm::mat4 worldFromGroup(std::uint32_t bundle, bundle::GroupIndex group) const;
  // Returns the bounds in the group's frame, as baked.
  const scene::Box& groupBounds(std::size_t group) const { return group_bounds_[group]; }
  // Returns the current strength of the group's own lights, by light column. A lamp that was moved from its
  // place in the group gives 0 here, because its column is no longer valid.
  std::vector<glm::vec3> lampsOf(std::size_t group) const;
  std::vector<glm::vec3> lampsOf(std::uint32_t bundle, bundle::GroupIndex group) const;
  // Returns whether the light is one of the group's own and stands in its place.
  bool litByColumn(std::size_t group, ecs::Entity light) const;
  // Returns the entity of the draw's material as a lamp of its group; null if it is none.
  ecs::Entity lampOfDraw(std::size_t draw) const { return lamp_of_draw_[draw]; }
  glm::quat rotationOf(std::size_t group) const;
  glm::mat4 worldFromMesh(std::size_t draw) const;
  // Returns the current radiance emitted by the draw's material, before its texture: that of its lamp if it
  // is a lamp of its group, else the material's own.
  glm::vec3 emission(std::size_t draw) const;
  // Rises when the emission of an emissive material changes.
  std::uint64_t lampsVersion() const { return registry_.version<scene::LampComponent>(); }
  // Multiplies the strength of all lights in the bundles.
  void scaleLamps(float factor);

  streaming::Residency& residency() { return residency_; }
  const streaming::Residency& residency() const { return residency_; }
  ecs::Registry& registry() { return registry_; }
  const ecs::Registry& registry() const { return registry_; }
  const bundle::Description& description(std::size_t bundle) const {
    return bundles_[bundle]->reader->description();
  }
  // Returns what that says of a resident group.
  const bundle::Group& describedGroup(std::size_t group) const {
    const streaming::ResidentGroup& resident = residency().groups()[group];
    return description(resident.bundle).groups[resident.index.value];
  }
  const bundle::Reader& reader(std::uint32_t bundle) const { return *bundles_[bundle]->reader; }
  const scene::SceneInstance& instance(std::size_t bundle) const { return bundles_[bundle]->instance; }

 private:
  // Lists steps that are being loaded, in the order in which they were requested.
  struct Piece {
    std::uint32_t unit = 0;
    std::vector<streaming::Work> work;
    std::size_t items = 0;  // items that are still to come
    bool begun = false;
    std::uint64_t bytes = 0;
    std::uint32_t steps = 1;  // an image may bring several at once
  };
  struct Batch {
    std::unique_ptr<streaming::Loader> loader;
    std::deque<Piece> pieces;
  };
  using Proxies = std::vector<std::optional<bundle::CaptureProxy>>;  // indexed by group
  struct Replacement {
    std::shared_ptr<const bundle::Reader> reader;
    streaming::Parts parts;
    Proxies proxies;
    std::vector<std::uint32_t> steps;  // for each unit, the steps that are loaded
    std::unique_ptr<streaming::Loader> loader;
    streaming::Residency::Place staged;
  };
  struct Bundle : streaming::Interest {
    std::shared_ptr<const bundle::Reader> reader;
    scene::InstantiateOptions options;
    scene::SceneInstance instance;
    std::vector<glm::mat4> world_from_node_at_rest;
    std::vector<std::uint32_t> steps;  // of each unit that are here
    Proxies proxies;                   // for its proxy level of detail
    std::uint64_t proxies_id = 0;
    std::optional<Batch> batch;
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
  // What a loader brings, and where it goes.
  struct Arrivals {
    streaming::Loader& loader;
    streaming::Residency::Place place;
    std::function<Result<void>(streaming::Ready)> accept;  // uploads an item at once
    std::function<void()> arrived;                         // is called for each item that is complete
  };
  // Uploads what is ready within the budget. Returns the first error.
  std::optional<Error> receive(const Arrivals& from, std::uint64_t& budget_bytes, gpu::Counters& counters);
  void uploadReplacement(Bundle& bundle, std::uint64_t& budget_bytes, gpu::Counters& counters);
  void swapIn(std::uint32_t slot);
  // Rebuilds what is kept per group and draw after the residency's tables have changed.
  void rebuildTables();

  // These follow the camera: they choose what should be here, drop, request and receive.
  void chooseTargets();
  void seeBundle(Bundle& bundle) const;
  void evict(std::uint32_t slot);
  void dropTo(std::uint32_t slot, std::uint32_t unit, std::uint32_t steps);
  void cancelBatch(std::uint32_t slot);
  void retire(Bundle& bundle);
  void request();
  bool startBatch(std::uint32_t slot);
  void countOne(Bundle& bundle);  // counts an arrived item of its batch
  void takeFrom(std::uint32_t slot, std::uint64_t& budget_bytes, gpu::Counters& counters);
  std::uint64_t bytesTaken() const;  // by what is here or being loaded
  static bool settled(const Bundle& bundle) {
    return bundle.error || (bundle.steps == bundle.target && !bundle.batch);
  }
  void measureRate(std::uint64_t bytes);
  std::vector<scene::AnimatedBundle> animatedBundles() const;
  const scene::RigidGroupComponent* rigidGroup(std::uint32_t bundle, bundle::GroupIndex group) const;
  const scene::RigidGroupComponent* rigidGroup(std::size_t group) const;
  bool inPlace(std::uint32_t bundle, bundle::GroupIndex group, std::size_t column) const;
  // These handle proxy levels of detail.
  static bool hasSurfaces(const streaming::Parts& parts, const std::vector<std::uint32_t>& steps) {
    return steps.front() == parts.surfaceSteps();
  }
  Result<void> accept(std::uint32_t slot, streaming::Ready item);
  Result<void> beginSurfaces(std::uint32_t slot);
  void endSurfaces(std::uint32_t slot);
  void dropProxyLod(Bundle& bundle);

  ecs::Registry registry_;
  streaming::Residency residency_;
  ThreadPool threads_;                          // for the loaders below
  std::vector<std::optional<Bundle>> bundles_;  // indexed by slot
  glm::dvec3 origin_{0.0};
  std::vector<ecs::Entity> lamp_of_draw_;  // null: not a lamp of its group
  std::vector<scene::Box> group_bounds_;
  std::uint64_t materials_seen_ = 0, materials_version_ = 1;
  std::uint64_t max_resident_bytes_;
  std::optional<spec::View> view_;
  struct Chosen {  // the inputs of the last choice
    std::optional<spec::View> view;
    std::uint64_t transforms = 0, bundles = 0;
  };
  Chosen chosen_;
  std::uint64_t bundles_version_ = 1;  // rises when a bundle is opened, closed or replaced
  std::uint64_t proxy_lods_version_ = 1, next_proxies_id_ = 1;
  std::vector<std::unique_ptr<streaming::Loader>> retired_;  // kept until their workers have ended
  struct Rate {
    std::chrono::steady_clock::time_point since = std::chrono::steady_clock::now();
    std::uint64_t bytes = 0;
    double megabytes_per_s = 0.0;
  };
  Rate rate_;
};

}  // namespace lambent::frame
