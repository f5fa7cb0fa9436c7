#include "editor/session/dialog_files.hpp"

#include <algorithm>
#include <cstdlib>
#include <tuple>

#include "editor/session/session.hpp"
#include "runtime/base/process.hpp"

namespace lambent::editor {

namespace {

constexpr std::size_t kMostPlaces = 8;

std::vector<DialogPlace> dialogPlacesOf(const Session& session) {
  std::vector<DialogPlace> places;
  const auto add = [&](std::string name, const std::filesystem::path& folder) {
    std::error_code ignored;
    const bool known = std::ranges::find(places, folder, &DialogPlace::folder) != places.end();
    if (!known && !folder.empty() && std::filesystem::is_directory(folder, ignored))
      places.push_back({std::move(name), folder});
  };
  if (const char* home = std::getenv("HOME")) add("Home", home);
  for (const SceneEntry& entry : session.scenes.entries()) add("Scene", entry.source.parent_path());
  if (const auto samples = sampleFolders(); !samples.empty()) add("Samples", samples.front());
  for (const std::string& recent : session.preferences.recent) {
    const std::filesystem::path folder = std::filesystem::path(recent).parent_path();
    add(folder.filename().string(), folder);
  }
  places.resize(std::min(places.size(), kMostPlaces));
  return places;
}

bool shown(const Dialog& dialog, const DialogFile& file) {
  if (file.name.starts_with('.')) return false;
  if (file.is_folder) return true;
  if (dialog.kind == Dialog::Kind::Folder) return false;
  if (dialog.kinds.empty() || dialog.filter > dialog.kinds.size()) return true;
  const auto isOf = [&](const FileKind& kind) {
    return std::ranges::any_of(kind.endings,
                               [&](const std::string& end) { return file.name.ends_with(end); });
  };
  return dialog.filter == 0 ? std::ranges::any_of(dialog.kinds, isOf) : isOf(dialog.kinds[dialog.filter - 1]);
}

std::vector<DialogFile> filesOf(const Dialog& dialog) {
  std::vector<DialogFile> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(dialog.folder, ignored)) {
    DialogFile file{entry.path().filename().string(), entry.is_directory(ignored)};
    if (shown(dialog, file)) files.push_back(std::move(file));
  }
  std::ranges::sort(files, {}, [](const DialogFile& file) {
    return std::tuple(!file.is_folder, std::string_view(file.name));
  });
  return files;
}

}  // namespace

void DialogFiles::update(const Session& session, const Dialog& dialog) {
  if (placed_.renew()) places_ = dialogPlacesOf(session);
  std::error_code ignored;
  if (listed_.renew(dialog.folder, std::filesystem::last_write_time(dialog.folder, ignored), dialog.filter))
    files_ = filesOf(dialog);
}

}  // namespace lambent::editor
