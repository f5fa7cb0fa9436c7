// Reads the GLB container: a 12-byte header, a JSON chunk and a binary chunk (glTF 2.0 specification, section
// 4). It finds the chunks of a file and reads byte ranges, but does not interpret them. All const calls may
// come from any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "runtime/base/result.hpp"

namespace lambent::bundle {

inline constexpr std::uint32_t kGlbMagic = 0x46546C67;      // "glTF"
inline constexpr std::uint32_t kGlbJsonChunk = 0x4E4F534A;  // "JSON"
inline constexpr std::uint32_t kGlbBinChunk = 0x004E4942;   // "BIN\0"
inline constexpr std::uint64_t kGlbHeaderBytes = 12, kGlbChunkHeaderBytes = 8;

class GlbFile {
 public:
  // Reads the headers and the JSON text. Fails if the file is missing, unreadable, not a GLB or truncated,
  // has trailing bytes, or if the chunks do not fill it.
  static Result<GlbFile> open(const std::filesystem::path& path);

  GlbFile(GlbFile&& other) noexcept;
  GlbFile& operator=(GlbFile&&) = delete;
  ~GlbFile();

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t fileBytes() const { return file_bytes_; }
  const std::string& json() const { return json_; }  // including its padding
  std::uint64_t binaryBytes() const { return bin_length_; }
  // Fills `out` with bytes from `offset` of the binary chunk. The range must lie within binaryBytes().
  Result<void> readBinary(std::uint64_t offset, std::span<std::byte> out) const;

 private:
  GlbFile(std::filesystem::path path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
  Result<void> readAt(std::uint64_t offset, std::span<std::byte> out) const;
  Result<void> readHeaders();

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t file_bytes_ = 0, bin_offset_ = 0, bin_length_ = 0;
  std::string json_;
};

}  // namespace lambent::bundle
