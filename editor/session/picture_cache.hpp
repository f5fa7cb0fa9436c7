// Keeps the small pictures of assets on disk, within a number of bytes: those that were not used for longest
// go first. A picture belongs to a file as it was, by path, size and time, so a file that changed has none.
// Any thread. Nothing fails: what cannot be kept is not found again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "baker/cache/cache.hpp"
#include "editor/session/assets.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::editor {

inline constexpr std::uint64_t kPictureCacheBytes = std::uint64_t{32} << 20;  // about 400 views

class PictureCache {
 public:
  // Without a folder, or if it cannot be made, nothing is kept.
  explicit PictureCache(const std::filesystem::path& folder, std::uint64_t most_bytes = kPictureCacheBytes);

  std::optional<spec::Rgba8Image> find(const Asset& asset) const;
  void put(const Asset& asset, const spec::Rgba8Image& picture);

 private:
  std::optional<baker::Cache> cache_;
};

}  // namespace lambent::editor
