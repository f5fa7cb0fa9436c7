// The bundle room owns the file format in both directions: the container, its description, the payload codecs
// and the decoding of meshes. It needs neither a GPU nor the baker. A Reader owns an open bundle. Opening
// reads the JSON and the keyframes of animations; other calls read only the byte ranges that they need, and
// may come from any thread. All results have been checked: lengths against the file, checksums against the
// bytes, and indices and counts of the description against the lists that they refer to. Damaged or
// unreadable files are reported as an Error that names the file and the place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/brdf_table.hpp"
#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/bundle/mesh.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::bundle {

// Constants of the GLB container, which is little endian.
inline constexpr std::uint32_t kGlbMagic = 0x46546C67;      // "glTF"
inline constexpr std::uint32_t kGlbJsonChunk = 0x4E4F534A;  // "JSON"
inline constexpr std::uint32_t kGlbBinChunk = 0x004E4942;   // "BIN\0"
inline constexpr std::uint64_t kGlbHeaderBytes = 12, kGlbChunkHeaderBytes = 8;

// XXH3-64 is the checksum and the digest of the whole format. It is fast enough to be checked on every read.
// It detects accidents, not forgery.
std::uint64_t checksum(std::span<const std::byte> bytes);

// Holds the bytes of a view or a payload.
using Blob = std::vector<std::byte>;

// Compresses and decompresses all payloads, with zstd. Damaged or truncated bytes are reported as an Error
// that names `subject`.
std::vector<std::byte> compressZstd(std::span<const std::byte> bytes, int level);
Result<std::vector<std::byte>> decompressZstd(std::span<const std::byte> bytes, std::size_t raw_length,
                                              const std::string& subject);

// Holds the codebook of a cell's transfer, and the cluster of each sample.
struct CellCodebook {
  transfer::Codebook codebook;
  std::vector<std::uint32_t> cluster_of;
};

class Reader {
 public:
  // Fails if the file is missing, truncated, not a GLB, not a bundle, too new, or if its JSON is damaged or
  // has indices out of range.
  static Result<Reader> open(const std::filesystem::path& path);

  // Makes the description count from another origin; that of a file that was opened is the file's.
  void countFrom(const glm::dvec3& origin) { bundle::countFrom(origin, file_->description); }

  const std::filesystem::path& path() const { return file_->path; }
  const Description& description() const { return file_->description; }
  std::uint64_t fileBytes() const { return file_->file_bytes; }

  // Returns the bytes of a view without padding, after checking their checksum.
  Result<std::vector<std::byte>> readView(std::uint32_t view) const;
  // Returns the decompressed bytes of a payload, raw_length of them.
  Result<std::vector<std::byte>> readPayload(std::uint32_t payload) const;
  // Decodes a primitive and checks its digest.
  Result<MeshData> readMesh(std::uint32_t mesh, std::uint32_t primitive) const;
  // Returns the rows of a draw. All their samples belong to cells with the draw's outputs.
  Result<transfer::VertexWeights> readRows(std::uint32_t draw) const;
  // Returns the codebook of Cell::transfers[transfer]. Its clusters agree with the lengths of the planes.
  Result<CellCodebook> readCodebook(GroupIndex group, CellIndex cell, TransferIndex transfer) const;
  // Returns the codes of a plane in the order of positionsOf().
  Result<std::vector<std::uint32_t>> readPlane(GroupIndex group, CellIndex cell, TransferIndex transfer,
                                               PlaneIndex plane) const;
  // Returns one entry per sample of the cell. If the cell has only one light probe, all entries are
  // kOneLight.
  Result<std::vector<transfer::LightWeights>> readLightWeights(GroupIndex group, CellIndex cell) const;
  // Returns a code per sample of the cell (importanceCode()); empty if the bundle has none.
  Result<std::vector<std::uint8_t>> readImportance(GroupIndex group, CellIndex cell) const;
  Result<BrdfTable> readBrdfTable(std::uint32_t index) const;
  // Returns a proxy without levels if the group has none.
  Result<CaptureProxy> readProxy(GroupIndex group) const;
  // Reads, decodes and checks everything in the file.
  Result<void> checkAll() const;

 private:
  // Reads the GLB container: a 12-byte header, a JSON chunk and a binary chunk (glTF 2.0 specification,
  // section 4). All const calls may come from any thread.
  struct File {
    explicit File(const std::filesystem::path& file) : path(file) {}
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    ~File();

    // Opens the file and returns the JSON text, including its padding. Fails if the file is missing,
    // unreadable, not a GLB or truncated, has trailing bytes, or if the chunks do not fill it.
    Result<std::string> open();
    // Fills `out` with bytes from `offset` of the file.
    Result<void> readAt(std::uint64_t offset, std::span<std::byte> out) const;
    // Checks the JSON chunk against the integrity view, which holds its checksum and the complement of that
    // (description_json.hpp).
    Result<void> checkJson(const std::string& json) const;

    std::filesystem::path path;
    int descriptor = -1;
    std::uint64_t file_bytes = 0, bin_offset = 0, bin_length = 0;
    Description description;
  };
  explicit Reader(const std::filesystem::path& path) : file_(std::make_unique<File>(path)) {}

  std::unique_ptr<File> file_;
};

// Looks at a whole bundle before it takes the place of the old one.
using PartCheck = std::function<Result<void>(const std::filesystem::path& part)>;

// Writes a bundle, which is a valid GLB 2.0 file, and fills `description.views`: blobs[i] becomes view i, and
// each animation gets another view for its keyframes after them. Every animation must have at least one
// channel with keys. The file appears whole or not at all, and equal input gives equal bytes. Fails if
// transfer is not finite, if the file would exceed the 4 GiB of a GLB, if it cannot be written, or if `check`
// finds fault with it.
Result<void> write(const std::filesystem::path& path, Description description, const std::vector<Blob>& blobs,
                   const PartCheck& check = {});

}  // namespace lambent::bundle
