// Stores one cache entry as a file: a header, then the bytes, compressed by zstd if that saves enough. Files
// are read and written as a whole.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "baker/cache/key.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

// Returns the content of the file: header and bytes.
std::vector<std::byte> packEntry(const Key& key, std::span<const std::byte> bytes);
// Returns nothing unless `file`, from its first byte to its last, is the entry of `key`.
std::optional<std::vector<std::byte>> unpackEntry(const Key& key, std::span<const std::byte> file);

enum class ReadFailure { Absent, Unreadable };
// Returns the whole file, and sets its time to now, since that is when it was last used.
tl::expected<std::vector<std::byte>, ReadFailure> readAndTouch(const std::filesystem::path& path);

// Writes a file beside `path`, under a different name for each call, then renames it. Error: the system's
// reason.
Result<void> writeBeside(const std::filesystem::path& path, std::span<const std::byte> bytes);
// This is a part of the names of files that are being written.
inline constexpr const char* kPartMark = ".part-";

}  // namespace lambent::baker
