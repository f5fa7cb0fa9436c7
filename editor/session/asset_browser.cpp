#include "editor/session/asset_browser.hpp"

#include <algorithm>
#include <utility>

#include "editor/session/session.hpp"

namespace lambent::editor {

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
