// The room streaming loads bundles on worker threads (loader.hpp) and owns what is resident on the GPU.
// Residency is used on the render thread only. add() makes the tables of a bundle, and upload() puts items of
// the Loader into arenas and textures; nothing else writes there. A bundle may also be staged: it is loaded
// beside the shown ones and replaces one of them when it is complete. Effects and the frame read the tables
// (resident_tables.hpp). An error names a mesh or a group that is too large for one page (128 MiB).
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/gpu/arena.hpp"
#include "runtime/streaming/loader.hpp"
#include "runtime/streaming/resident_tables.hpp"

namespace lambent::streaming {

class Residency {
 public:
  // Pages are as large as a bundle needs, up to max_page_bytes.
  explicit Residency(std::uint64_t max_page_bytes = gpu::Arena::kMaxPageBytes);

  // Says where a bundle is: in a slot, or staged, so not in the tables yet.
  struct Place {
    Place(std::uint32_t slot) : index(slot) {}
    Place(bool is_staged, std::uint32_t number) : staged(is_staged), index(number) {}
    auto operator<=>(const Place&) const = default;

    bool staged = false;
    std::uint32_t index = 0;  // the slot, or the number of the staged bundle
  };

  // Adds a bundle in this slot, which must be empty.
  Result<void> add(const bundle::Description& description, std::uint32_t slot);
  // Releases all memory of the bundle. The slot is empty until the next add(); other slots do not change.
  void remove(std::uint32_t slot);
  // Returns whether the slot holds a bundle.
  bool present(std::uint32_t slot) const {
    return slot < tables_.bundles.size() && tables_.bundles[slot].present;
  }
  Result<Place> stage(const bundle::Description& description);
  void discard(const Place& staged);
  // Puts a staged bundle into a slot, and removes the bundle that is there, if any. No upload of the staged
  // bundle may be in progress.
  void show(const Place& staged, std::uint32_t slot);

  Result<void> upload(const Place& place, Ready item);
  // Returns whether an item can be uploaded in pieces over several frames. These are images, meshes and
  // codebooks. The item is shown when it is complete. Each bundle has at most one such item at a time.
  static bool comesInPieces(const Ready& item);
  // Begins the upload of an item in pieces.
  Result<void> begin(const Place& place, Ready item);
  // Returns whether such an upload is in progress.
  bool comes(const Place& place) const { return coming_.contains(place); }
  // Continues the upload with at most about max_bytes, and returns the number of bytes.
  Result<std::uint64_t> proceed(const Place& place, std::uint64_t max_bytes);
  void cancel(const Place& place);

  // Gives all cells and draws new versions, so that they are shaded again. Call this after other code wrote
  // into samples or radiance.
  void forgetShading();
  // Returns the number of planes of a transfer to keep.
  using PlanesToKeep = std::function<std::uint32_t(bundle::CellIndex, bundle::TransferIndex)>;
  void dropPlanes(std::uint32_t slot, bundle::GroupIndex group, const PlanesToKeep& keep);
  // Keeps only this many of the coarsest mip levels of an image.
  void dropLevels(std::uint32_t slot, std::uint32_t image, std::uint32_t levels);
  // Drops all transfer and light weights of a group, which is then shown without shadows.
  void dropTransfer(std::uint32_t slot, bundle::GroupIndex group);

  // Returns the bundles by slot. Some slots may be empty.
  const std::vector<ResidentBundle>& bundles() const { return tables_.bundles; }
  const std::vector<ResidentMesh>& meshes() const { return tables_.meshes; }
  const std::vector<ResidentGroup>& groups() const { return tables_.groups; }
  const std::vector<ResidentCell>& cells() const { return tables_.cells; }
  const std::vector<ResidentDraw>& draws() const { return tables_.draws; }
  const std::vector<ResidentVolume>& volumes() const { return tables_.volumes; }
  // Returns a number that rises with every upload. Entries have the value at which they last changed.
  std::uint64_t version() const { return version_; }
  // Returns a number that rises when entries are added or removed, so that indices into the tables change.
  std::uint64_t structureVersion() const { return structure_version_; }
  // Returns a number that rises when a capture proxy is loaded, or when groups are added or removed.
  std::uint64_t proxiesVersion() const { return proxies_version_; }

  gpu::Arena& geometry() { return geometry_; }
  gpu::Arena& transfer() { return transfer_; }
  gpu::Arena& samples() { return samples_; }
  gpu::Arena& rows() { return rows_; }
  gpu::Arena& radiance() { return radiance_; }

  // Returns the GPU memory in use by arenas and textures, including staged bundles and unfinished uploads.
  std::uint64_t bytesResident() const;

 private:
  Result<ResidentTables> make(const bundle::Description& description);
  void release(const ResidentTables& tables);
  void structureChanged();
  std::vector<const gpu::Arena*> arenas() const {
    return {&geometry_, &transfer_, &samples_, &rows_, &radiance_};
  }
  // Names the tables that hold a bundle, and its entry there.
  struct At {
    ResidentTables& tables;
    ResidentBundle& bundle;
  };
  At at(const Place& place);
  // An item that is uploaded piece by piece: its parts one after the other, in multiples of a granule.
  struct Upload {
    Ready item;
    std::vector<std::uint64_t> colors;  // of a mesh, as the GPU reads them
    gpu::Allocation block;              // of a mesh
    gpu::Texture color, linear;         // of an image
    std::vector<std::span<const std::byte>> parts;
    std::uint64_t granule = 1;
    std::size_t part = 0;         // the first that is not done
    std::uint64_t part_done = 0;  // bytes of it that are
    std::uint64_t all_done = 0;

    bool whole() const { return part == parts.size(); }
  };
  static std::uint64_t bytesOfTexture(const gpu::Texture& texture);  // 0 without one
  Result<Upload> makeUpload(At at, Ready item);
  std::uint64_t proceed(At at, Upload& upload, std::uint64_t max_bytes);
  void write(At at, const Upload& upload, std::span<const std::byte> piece);
  Result<void> finish(At at, Upload upload);
  Result<void> finishMesh(At at, const Upload& upload);
  Result<void> writeTables(At at, const CodebookChunk& item);
  Result<void> put(At at, const WeightsChunk& item);
  Result<void> put(At at, const PlaneChunk& item);
  Result<void> put(At at, const LightWeightsChunk& item);
  Result<void> put(At at, const ProxyChunk& item);
  Result<void> put(At at, const BrdfChunk& item);
  Result<void> put(At at, const DensityChunk& item);
  Result<void> put(At at, const VoxelsChunk& item);
  Result<void> reserveCell(ResidentCell& cell);
  // Moves a cell to a page with room for all its planes.
  Result<void> moveCell(ResidentCell& cell);
  // Clears the shaded samples of a group and causes it to be shaded again.
  void forgetShading(const ResidentGroup& group);

  std::uint64_t max_page_bytes_;
  ResidentTables tables_;
  std::map<std::uint32_t, ResidentTables> staged_;  // by number
  std::uint32_t next_staged_ = 0;
  std::map<Place, Upload> coming_;
  std::uint64_t next_id_ = 1;
  std::uint64_t version_ = 1, structure_version_ = 1, proxies_version_ = 1;
  std::shared_ptr<gpu::Staging> staging_ = std::make_shared<gpu::Staging>();
  gpu::Arena geometry_, transfer_, samples_, rows_, radiance_;
};

}  // namespace lambent::streaming
