// Finds files that the editor can use, their kinds and what a search finds among them: environment maps
// (.hdr, .exr), scenes (.gltf, .glb), bundles (.lmb.glb) and worlds (.json). Any thread. Folders that cannot
// be read have no assets.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lambent::editor {

enum class AssetKind : std::uint8_t { EnvironmentMap, Scene, Bundle, World };
std::string_view kindWord(AssetKind kind);  // "environment map"

struct Asset {
  std::filesystem::path file{};  // absolute
  AssetKind kind{};
  std::uint64_t bytes = 0;
  std::filesystem::file_time_type written{};
  bool operator==(const Asset&) const = default;
};

// Returns the file's name without what only tells its kind: "hall" for hall.world.json.
std::string nameOf(const Asset& asset);
// Returns the file as an asset by its name, or nothing if it is no file of these kinds. It is not read, so
// any .json passes for a world.
std::optional<Asset> assetAt(const std::filesystem::path& file);
// Returns the assets of a folder by name, of one kind or of all, without the folders in it. Files .json are
// read as far as it takes to tell worlds from others.
std::vector<Asset> listAssets(const std::filesystem::path& folder, std::optional<AssetKind> only = {});
// Returns whether all words of the search are parts of the file's name or its kind. Case does not count.
bool matches(const Asset& asset, std::string_view search);

}  // namespace lambent::editor
