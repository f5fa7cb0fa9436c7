// Helpers that the picture formats of this room share.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include <glm/mat3x3.hpp>

#include "runtime/base/atomic_file.hpp"
#include "runtime/base/result.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::spec {

// Fails if width x height is 0, more than kMaxImageTexels, or more than `file_bytes` could hold at
// `texels_per_byte`. So a small file with a false header cannot make us reserve gigabytes.
Result<void> checkImageSize(const std::filesystem::path& path, std::uint64_t width, std::uint64_t height,
                            std::uint64_t file_bytes, std::uint64_t texels_per_byte);

// An OpenEXR picture in the colours of its file.
struct CodedExr {
  RgbaImage image;
  std::optional<glm::mat3> rec709_from_file;  // nothing if the primaries that it names span no colours
};
Result<CodedExr> readCodedExr(const std::filesystem::path& path);

inline Result<void> writeWholeFile(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  Result<AtomicFile> file = AtomicFile::open(path);
  if (!file) return failAgain(std::move(file.error()));
  if (Result<void> written = file->write(bytes); !written) return written;
  return file->commit();
}

}  // namespace lambent::spec
