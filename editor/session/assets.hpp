// Finds files that the editor can use: environment maps (.hdr, .exr), scenes (.gltf, .glb), bundles
// (.lmb.glb) and worlds (.json). Functions may run on any thread, classes on the main one. Folders that
// cannot be read have no assets.
#pragma once

#include <cstdint>
#include <filesystem>
#include <future>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "editor/session/scenes.hpp"
#include "runtime/base/change_gate.hpp"
#include "runtime/base/process.hpp"

namespace lambent::editor {

class Session;

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

// Lists environment maps to choose from: those in the folders of the ones in use, of the open scenes, and in
// folders that were added.
class EnvironmentMapShelf {
 public:
  void addFolder(const std::filesystem::path& folder);
  // Lists the files again if the folders may have changed.
  void update(const std::vector<std::string>& light_words, const Scenes& scenes);
  const std::vector<Asset>& environment_maps() const { return environment_maps_; }

 private:
  // Tells when the folders must be found again: it compares the light words, the version of the scenes and
  // the number of added folders.
  ChangeGate<std::vector<std::string>, std::uint64_t, std::size_t> changed_;
  std::vector<std::filesystem::path> added_, folders_;
  std::vector<Asset> environment_maps_;
};

struct AssetGroup {
  std::string title;
  std::vector<std::filesystem::path> folders;
  std::vector<Asset> assets;
};

// Lists the assets to choose from: those of the folder in use, which is that of what was opened last, and
// the samples that came with the program. Folders are read on another thread. It also holds what the Assets
// panel remembers.
class AssetBrowser {
 public:
  // Takes what was read, and reads the folders again if they or the open scenes have changed. Panels call it
  // in each frame in which they show assets.
  void update(const Session& session);
  // The same, but the list is complete when it returns.
  void updateNow(const Session& session);
  // Returns whether folders are being read.
  bool busy() const;

  const std::vector<AssetGroup>& groups() const { return groups_; }
  // Returns the group of the samples, or null if there are none or they have not been read.
  const AssetGroup* samples() const;
  // Returns the asset with this path or file name, or null if none is listed.
  const Asset* find(std::string_view name) const;

  std::string search;
  std::filesystem::path selected;
  bool large = false;  // large pictures

 private:
  void take();

  std::vector<std::filesystem::path> samples_ = sampleFolders();
  std::vector<AssetGroup> groups_;
  // Tells when folders must be read again: it compares them, their times, and the version of the scenes.
  ChangeGate<std::vector<std::filesystem::path>, std::vector<std::filesystem::file_time_type>, std::uint64_t>
      changed_;
  std::future<std::vector<AssetGroup>> coming_;
};

}  // namespace lambent::editor
