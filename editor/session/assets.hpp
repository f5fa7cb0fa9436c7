// Finds files that the editor can use: environment maps (.hdr, .exr), scenes (.gltf, .glb), bundles
// (.lmb.glb) and worlds (.json). Functions may run on any thread, classes on the main one. Folders that
// cannot be read have no assets.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <future>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "editor/session/scenes.hpp"
#include "runtime/base/change_gate.hpp"
#include "runtime/base/process.hpp"
#include "runtime/spec/image.hpp"

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
bool matches(const Asset& asset, std::string_view search);

struct AssetGroup {
  std::string title;
  std::vector<std::filesystem::path> folders;
  std::vector<Asset> assets;
};

// Lists the assets to choose from: those of the folder in use, which is that of what was opened last, those
// beside open scenes and environment maps in use, and the samples that came with the program. It also holds
// what the Assets panel remembers.
class AssetBrowser {
 public:
  // Reads the folders again if they or the open scenes have changed. Panels call it in each frame in which
  // they show assets.
  void update(const Session& session);

  const std::vector<AssetGroup>& groups() const { return groups_; }
  // Returns the group of the samples, or null if there are none.
  const AssetGroup* samples() const;
  // Returns the asset with this path or file name, or null if none is listed.
  const Asset* find(std::string_view name) const;

  std::string search;
  std::filesystem::path selected;

 private:
  std::vector<std::filesystem::path> samples_ = sampleFolders();
  std::vector<AssetGroup> groups_;
  // Tells when folders must be read again: it compares them, their times, and the version of the scenes.
  ChangeGate<std::vector<std::filesystem::path>, std::vector<std::filesystem::file_time_type>, std::uint64_t>
      changed_;
};

// Brings the pictures of assets: those of environment maps are made of their files, those of scenes, bundles
// and worlds are PNGs of their names that lie beside them. Panels ask for them; they are made on
// another thread, one for each update(), in the order in which they were asked for. The renderer turns them
// into textures. AssetPictures belongs to the main thread.

// Exposes the environment map so that its median becomes middle grey.
spec::Rgba8Image smallPictureOf(const spec::RgbImage& environment_map);
// Averages the middle of a picture, which is cut to 16:9. Alpha becomes 1.
spec::Rgba8Image smallPictureOf(const spec::Rgba8Image& view);

class AssetPictures {
 public:
  struct Picture {
    spec::Rgba8Image image{};   // empty: not there yet, or on the GPU
    std::string error{};        // why an environment map cannot be read
    std::uint32_t texture = 0;  // OpenGL name; 0: none yet
    float aspect = 1.0f;        // width / height of the texture
  };

  struct Made {
    Asset asset;
    spec::Rgba8Image image{};
    std::string error{};
  };

  // Returns the picture as far as it is there. The first call for a file, or for a file that changed, asks
  // for it.
  const Picture& of(const Asset& asset);
  void update();
  bool busy() const { return coming_.valid() || !wanted_.empty(); }

  std::map<std::filesystem::path, Picture>& pictures() { return pictures_; }

 private:
  std::map<std::filesystem::path, Picture> pictures_;
  std::map<std::filesystem::path, Asset> asked_;  // the files as they were when their pictures were asked for
  std::deque<Asset> wanted_;
  std::future<Made> coming_;
};

}  // namespace lambent::editor
