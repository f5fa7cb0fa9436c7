#include "editor/session/assets.hpp"

#include <algorithm>
#include <fstream>
#include <utility>

#include "baker/pipeline/source_watch.hpp"
#include "editor/document/world_file.hpp"
#include "editor/session/names.hpp"
#include "editor/session/session.hpp"
#include "runtime/base/lower_case.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::editor {

namespace {

std::optional<AssetKind> kindByName(const std::filesystem::path& file) {
  const std::string ending = lowerCase(file.extension().string());
  if (ending == ".hdr" || ending == ".exr") return AssetKind::EnvironmentMap;
  if (file.filename().string().ends_with(".lmb.glb")) return AssetKind::Bundle;
  if (baker::isSceneFile(file)) return AssetKind::Scene;
  if (ending == ".json") return AssetKind::World;
  return std::nullopt;
}

// Looks for the mark of world files in the beginning of the file.
bool holdsWorld(const std::filesystem::path& file) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  std::string head(kMostBytes, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  return head.find('"' + std::string(kWorldFileMark) + '"') != std::string::npos;
}

}  // namespace

std::string_view kindWord(AssetKind kind) {
  switch (kind) {
    case AssetKind::EnvironmentMap:
      return "environment map";
    case AssetKind::Scene:
      return "scene";
    case AssetKind::Bundle:
      return "bundle";
    case AssetKind::World:
      return "world";
  }
  return {};
}

std::string nameOf(const Asset& asset) {
  const std::filesystem::path stem = asset.file.stem();
  const std::string second = stem.extension().string();
  const bool told = (asset.kind == AssetKind::Bundle && second == ".lmb") ||
                    (asset.kind == AssetKind::World && second == ".world");
  return (told ? stem.stem() : stem).string();
}

std::optional<Asset> assetAt(const std::filesystem::path& file) {
  const auto kind = kindByName(file);
  std::error_code wrong;
  if (!kind || !std::filesystem::is_regular_file(file, wrong)) return std::nullopt;
  Asset asset{.file = std::filesystem::absolute(file, wrong).lexically_normal(), .kind = *kind};
  asset.bytes = std::filesystem::file_size(file, wrong);
  if (!wrong) asset.written = std::filesystem::last_write_time(file, wrong);
  if (wrong) return std::nullopt;  // it was removed in between
  return asset;
}

std::vector<Asset> listAssets(const std::filesystem::path& folder, std::optional<AssetKind> only) {
  std::vector<Asset> assets;
  std::error_code wrong;
  for (auto at = std::filesystem::directory_iterator(folder, wrong);
       !wrong && at != std::filesystem::directory_iterator(); at.increment(wrong))
    if (auto asset = assetAt(at->path()); asset && (!only || asset->kind == *only))
      if (asset->kind != AssetKind::World || holdsWorld(asset->file)) assets.push_back(std::move(*asset));
  std::ranges::sort(assets, {}, &Asset::file);
  return assets;
}

bool matches(const Asset& asset, std::string_view search) {
  return holdsWords(asset.file.filename().string() + ' ' + std::string(kindWord(asset.kind)), search);
}

namespace {

constexpr std::size_t kMostMaps = 64;

std::vector<std::filesystem::path> foldersOf(std::vector<std::filesystem::path> folders,
                                             const std::vector<std::string>& light_words,
                                             const Scenes& scenes) {
  for (const std::string& word : light_words)
    if (const auto light = spec::parseLight(word);
        light && std::holds_alternative<spec::EnvironmentMapLight>(*light))
      folders.push_back(std::filesystem::path(word).parent_path());
  for (const SceneEntry& entry : scenes.entries())
    folders.push_back((entry.source.empty() ? entry.bundle : entry.source).parent_path());
  for (std::filesystem::path& folder : folders) {
    std::error_code ignored;
    folder = std::filesystem::weakly_canonical(folder.empty() ? "." : folder, ignored);
  }
  std::sort(folders.begin(), folders.end());
  folders.erase(std::unique(folders.begin(), folders.end()), folders.end());
  return folders;
}

}  // namespace

void EnvironmentMapShelf::addFolder(const std::filesystem::path& folder) {
  if (std::find(added_.begin(), added_.end(), folder) == added_.end()) added_.push_back(folder);
}

void EnvironmentMapShelf::update(const std::vector<std::string>& light_words, const Scenes& scenes) {
  if (!changed_.renew(light_words, scenes.version(), added_.size())) return;
  std::vector<std::filesystem::path> folders = foldersOf(added_, light_words, scenes);
  if (folders == folders_) return;
  folders_ = std::move(folders);
  environment_maps_.clear();
  for (const std::filesystem::path& folder : folders_)
    for (Asset& asset : listAssets(folder, AssetKind::EnvironmentMap))
      if (environment_maps_.size() < kMostMaps) environment_maps_.push_back(std::move(asset));
}

namespace {

// Returns the folder of what was opened last, which may be a folder itself, or an empty path.
std::filesystem::path folderInUse(const Preferences& preferences) {
  if (preferences.recent.empty()) return {};
  const std::filesystem::path last = std::filesystem::path(preferences.recent.front()).lexically_normal();
  std::error_code ignored;
  return std::filesystem::is_directory(last, ignored) ? last : last.parent_path();
}

std::vector<AssetGroup> listed(std::vector<AssetGroup> groups) {
  for (AssetGroup& group : groups)
    for (const std::filesystem::path& folder : group.folders)
      for (Asset& asset : listAssets(folder)) group.assets.push_back(std::move(asset));
  return groups;
}

}  // namespace

void AssetBrowser::take() {
  groups_ = coming_.get();
}

void AssetBrowser::update(const Session& session) {
  if (coming_.valid()) {
    if (busy()) return;
    take();
  }
  std::vector<AssetGroup> groups;
  const std::filesystem::path folder = folderInUse(session.preferences);
  if (!folder.empty() && std::ranges::find(samples_, folder) == samples_.end())
    groups.push_back({.title = folder.string(), .folders = {folder}, .assets = {}});
  if (!samples_.empty()) groups.push_back({.title = "Samples", .folders = samples_, .assets = {}});
  std::vector<std::filesystem::path> folders;
  std::vector<std::filesystem::file_time_type> times;
  for (const AssetGroup& group : groups)
    for (const std::filesystem::path& one : group.folders) {
      std::error_code ignored;
      folders.push_back(one);
      times.push_back(std::filesystem::last_write_time(one, ignored));
    }
  if (changed_.renew(folders, times, session.scenes.version()))
    coming_ = std::async(std::launch::async, listed, std::move(groups));
}

void AssetBrowser::updateNow(const Session& session) {
  if (coming_.valid()) take();
  update(session);
  if (coming_.valid()) take();
}

bool AssetBrowser::busy() const {
  return coming_.valid() && coming_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
}

const AssetGroup* AssetBrowser::samples() const {
  const auto found = std::ranges::find(groups_, samples_, &AssetGroup::folders);
  return found == groups_.end() ? nullptr : &*found;
}

const Asset* AssetBrowser::find(std::string_view name) const {
  for (const AssetGroup& group : groups_)
    for (const Asset& asset : group.assets)
      if (asset.file == name || asset.file.filename() == name) return &asset;
  return nullptr;
}

}  // namespace lambent::editor
