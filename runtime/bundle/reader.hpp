// Reads bundles: the JSON once, and with it the keyframes of animations, then only the byte ranges that are
// asked for. Owns the open file; every call is safe from any thread. What comes out has been checked: lengths
// against the file, checksums against the bytes, every index and count of the description against the lists
// that it points into. No GL, no baker.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/brdf_table.hpp"
#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/bundle/light_weights.hpp"
#include "runtime/bundle/mesh.hpp"
#include "runtime/bundle/transfer_codec.hpp"

namespace lambent::bundle {

// The codebook of a cell's transfer, and the cluster of each sample.
struct CellCodebook {
  Codebook codebook;
  std::vector<std::uint32_t> cluster_of;
};

class Reader {
 public:
  // Errors: missing file, not a GLB, truncated, not a bundle, too new, damaged JSON, indices out of range.
  static Result<Reader> open(const std::filesystem::path& path);

  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;
  ~Reader();

  const std::filesystem::path& path() const;
  const Description& description() const;
  std::uint64_t fileBytes() const;

  // The bytes of a view, without padding; the checksum is compared.
  Result<std::vector<std::byte>> readView(std::uint32_t view) const;
  // The bytes of a payload, decompressed to raw_length.
  Result<std::vector<std::byte>> readPayload(std::uint32_t payload) const;
  // Decodes a primitive and compares its digest.
  Result<MeshData> readMesh(std::uint32_t mesh, std::uint32_t primitive) const;
  // Of a draw; its samples are of cells with as many outputs.
  Result<VertexWeights> readRows(std::uint32_t draw) const;
  // Of Cell::transfers[transfer]; it agrees with the counts of the planes.
  Result<CellCodebook> readCodebook(std::uint32_t group, std::uint32_t cell, std::uint32_t transfer) const;
  // Codes in the order of positionsOf.
  Result<std::vector<std::uint32_t>> readPlane(std::uint32_t group, std::uint32_t cell,
                                               std::uint32_t transfer, std::uint32_t plane) const;
  // One per sample of the cell; of a cell with one light probe, that one whole.
  Result<std::vector<LightWeights>> readLightWeights(std::uint32_t group, std::uint32_t cell) const;
  Result<BrdfTable> readBrdfTable(std::uint32_t index) const;
  // Without a level where the group has none.
  Result<CaptureProxy> readProxy(std::uint32_t group) const;
  // Reads, decodes and compares everything in the file.
  Result<void> checkAll() const;

 private:
  struct File;
  explicit Reader(std::unique_ptr<File> file);
  std::unique_ptr<File> file_;
};

}  // namespace lambent::bundle
