// What of the loaded bundles lies on the GPU, and where. add() makes the tables of a bundle, upload() takes
// what the Loader hands on, one item at a time, and puts it into arenas and textures; nothing else writes
// there. A bundle may also be staged: brought beside those that are shown, and put in the place of one of
// them when it is whole. Effects and the frame read the tables (resident_tables.hpp). Render thread only.
// Errors: a mesh or a group too large for one page (128 MiB), named.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
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

  // Returns the bundle's slot: the first that is empty.
  Result<std::uint32_t> add(const bundle::Description& description);
  // Into this one, which must be empty.
  Result<void> add(const bundle::Description& description, std::uint32_t slot);
  Result<void> upload(std::uint32_t bundle, Ready item);
  // Samples and radiance were written by others: cells and draws get new versions, so that whoever shades
  // them does it anew.
  void forgetShading();
  // Gives back all that it took. The slot is empty until the next add(); those of others stay.
  void remove(std::uint32_t bundle);
  // Whether the slot holds a bundle.
  bool present(std::uint32_t slot) const {
    return slot < tables_.bundles.size() && tables_.bundles[slot].present;
  }
  // How many planes of a transfer to keep.
  using PlanesToKeep = std::function<std::uint32_t(std::uint32_t cell, std::uint32_t transfer)>;
  void dropPlanes(std::uint32_t bundle, std::uint32_t group, const PlanesToKeep& keep);
  // What is larger than a frame has room for comes in pieces and is shown when it is whole: an image in place
  // of a coarser one, a mesh, the means and axes of a transfer. One at a time of each bundle.
  static bool comesInPieces(const Ready& item);
  Result<void> begin(std::uint32_t bundle, Ready item);
  bool comes(std::uint32_t bundle) const { return coming_.contains({false, bundle}); }
  // At most about so many bytes more of it; returns how many.
  Result<std::uint64_t> proceed(std::uint32_t bundle, std::uint64_t max_bytes);
  void cancel(std::uint32_t bundle);
  // Keeps the coarsest of its mip levels, so many.
  void dropLevels(std::uint32_t bundle, std::uint32_t image, std::uint32_t levels);
  // All of the group's transfer, light weights too: it is shown without shadows from now on.
  void dropTransfer(std::uint32_t bundle, std::uint32_t group);

  // A bundle that is not in the tables yet, named by what stage() returns.
  using Staged = std::uint32_t;
  Result<Staged> stage(const bundle::Description& description);
  Result<void> uploadStaged(Staged staged, Ready item);
  void discard(Staged staged);
  // As begin(), comes(), proceed(): pieces of what is staged.
  Result<void> beginStaged(Staged staged, Ready item);
  bool comesStaged(Staged staged) const { return coming_.contains({true, staged}); }
  Result<std::uint64_t> proceedStaged(Staged staged, std::uint64_t max_bytes);
  // In the place of `bundle`, which goes; the slot may be empty. Nothing of it may still be coming.
  void show(Staged staged, std::uint32_t bundle);

  // By slot; some may be empty.
  const std::vector<ResidentBundle>& bundles() const { return tables_.bundles; }
  const std::vector<ResidentMesh>& meshes() const { return tables_.meshes; }
  const std::vector<ResidentGroup>& groups() const { return tables_.groups; }
  const std::vector<ResidentCell>& cells() const { return tables_.cells; }
  const std::vector<ResidentDraw>& draws() const { return tables_.draws; }
  const std::vector<ResidentVolume>& volumes() const { return tables_.volumes; }
  // Rises with every upload; entries carry the value at which they last changed.
  std::uint64_t version() const { return version_; }
  // Rises when entries come or go: indices into the tables are others then.
  std::uint64_t structureVersion() const { return structure_version_; }
  // Rises with every capture proxy that arrives and every group that comes or goes.
  std::uint64_t proxiesVersion() const { return proxies_version_; }

  gpu::Arena& geometry() { return geometry_; }
  gpu::Arena& transfer() { return transfer_; }
  gpu::Arena& samples() { return samples_; }
  gpu::Arena& rows() { return rows_; }
  gpu::Arena& radiance() { return radiance_; }

  // What is in use on the GPU: arenas and textures, staged bundles and images on their way included.
  std::uint64_t bytesResident() const;
  // What the arenas hold for it, with what is free in their pages.
  std::uint64_t bytesReserved() const;
  std::uint64_t planesResident() const;
  // Bytes of an item as they are uploaded.
  static std::uint64_t uploadBytes(const Ready& item);

 private:
  Result<ResidentTables> make(const bundle::Description& description);
  void release(const ResidentTables& tables);
  void structureChanged();
  std::vector<const gpu::Arena*> arenas() const {
    return {&geometry_, &transfer_, &samples_, &rows_, &radiance_};
  }
  // Into the tables that hold the bundle.
  struct At {
    ResidentTables& tables;
    ResidentBundle& bundle;
  };
  struct ImageUpload {
    ImageChunk item;  // of one that comes in pieces
    gpu::Texture color, linear;
    std::uint32_t rows_done = 0;
  };
  static ImageUpload begin(const ResidentBundle& owner, const ImageChunk& item);
  static void write(ImageUpload& upload, const ImageChunk& item, std::uint32_t rows);
  static void finish(ResidentBundle& owner, ImageUpload upload, std::uint32_t image);
  struct MeshUpload {
    MeshChunk item;
    std::vector<std::uint64_t> colors;
    gpu::Allocation block;
    std::uint64_t bytes_done = 0;
  };
  struct CodebookUpload {
    CodebookChunk item;
    std::uint64_t bytes_done = 0;  // of its vectors
  };
  using Coming = std::variant<ImageUpload, MeshUpload, CodebookUpload>;
  struct Whose {
    bool staged = false;
    std::uint32_t index = 0;  // slot, or Staged
    auto operator<=>(const Whose&) const = default;
  };
  At at(const Whose& whose);
  Result<void> begin(const Whose& whose, Ready item);
  Result<std::uint64_t> proceed(const Whose& whose, std::uint64_t max_bytes);
  void cancel(const Whose& whose);
  std::uint64_t proceed(ImageUpload& upload, std::uint64_t max_bytes);
  std::uint64_t proceed(MeshUpload& upload, std::uint64_t max_bytes);
  std::uint64_t proceed(At at, CodebookUpload& upload, std::uint64_t max_bytes);
  Result<MeshUpload> begin(MeshChunk item);
  Result<void> finish(At at, const MeshUpload& upload);
  Result<void> writeTables(At at, const CodebookChunk& item);
  void finish(At at, const CodebookUpload& upload);
  std::uint64_t comingBytes() const;
  Result<void> put(At at, MeshChunk item);
  Result<void> put(At at, const ImageChunk& item);
  Result<void> put(At at, const WeightsChunk& item);
  Result<void> put(At at, CodebookChunk item);
  Result<void> put(At at, const PlaneChunk& item);
  Result<void> put(At at, const LightWeightsChunk& item);
  Result<void> put(At at, const ProxyChunk& item);
  Result<void> put(At at, const BrdfChunk& item);
  Result<void> put(At at, const DensityChunk& item);
  Result<void> put(At at, const VoxelsChunk& item);
  Result<void> reserveCell(ResidentCell& cell);
  // To a page that has room for all of it.
  Result<void> moveCell(ResidentCell& cell);
  // Shades all of the group anew, from nothing.
  void forgetShading(const ResidentGroup& group);

  std::uint64_t max_page_bytes_;
  ResidentTables tables_;
  std::map<Staged, ResidentTables> staged_;
  Staged next_staged_ = 0;
  std::map<Whose, Coming> coming_;
  std::uint64_t next_id_ = 1;
  std::uint64_t version_ = 1, structure_version_ = 1, proxies_version_ = 1;
  std::shared_ptr<gpu::Staging> staging_ = std::make_shared<gpu::Staging>();
  gpu::Arena geometry_, transfer_, samples_, rows_, radiance_;
};

}  // namespace lambent::streaming
