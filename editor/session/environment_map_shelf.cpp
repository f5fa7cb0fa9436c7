#include "editor/session/environment_map_shelf.hpp"

#include <algorithm>

#include "runtime/spec/light.hpp"

namespace lambent::editor {

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

}  // namespace lambent::editor
