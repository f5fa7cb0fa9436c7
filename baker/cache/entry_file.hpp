// One entry of a cache as a file: a header, then the bytes, by zstd where that pays. Read and written whole.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "baker/cache/key.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

// Header and bytes, as the file holds them.
std::vector<std::byte> packEntry(const Key& key, std::span<const std::byte> bytes);
// Nothing if this is not, from its first byte to its last, the entry of `key`.
std::optional<std::vector<std::byte>> unpackEntry(const Key& key, std::span<const std::byte> file);

enum class ReadFailure { Absent, Unreadable };
// The whole file; its time becomes now, which is when it was last used.
tl::expected<std::vector<std::byte>, ReadFailure> readAndTouch(const std::filesystem::path& path);

// Written beside `path` under a name of its own for each call, then renamed. Error: the system's reason.
Result<void> writeBeside(const std::filesystem::path& path, std::span<const std::byte> bytes);
// Part of the names of files that are being written.
inline constexpr const char* kPartMark = ".part-";

}  // namespace lambent::baker
