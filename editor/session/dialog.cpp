#include "editor/session/dialog.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string_view>
#include <tuple>
#include <utility>

#include <unistd.h>

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

namespace {

constexpr int kChosen = 0, kCancelled = 1;  // exit codes of both programs

bool isSet(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

std::filesystem::path inPath(const char* program) {
  const char* folders = std::getenv("PATH");
  std::string_view left = folders != nullptr ? folders : "";
  while (!left.empty()) {
    const std::size_t end = left.find(':');
    const std::filesystem::path file = std::filesystem::path(left.substr(0, end)) / program;
    if (file.is_absolute() && ::access(file.c_str(), X_OK) == 0) return file;
    left = end == std::string_view::npos ? std::string_view() : left.substr(end + 1);
  }
  return {};
}

struct Filter {
  std::string name, patterns;  // "Scenes", "*.gltf *.glb"
};

// Returns the kinds of the question: all of them first, if there are several, and all files last.
std::vector<Filter> filtersOf(const Dialog& question) {
  std::vector<Filter> filters;
  std::string all;
  for (const FileKind& kind : question.kinds) {
    std::string patterns;
    for (const std::string& ending : kind.endings) patterns += (patterns.empty() ? "*" : " *") + ending;
    all += (all.empty() ? "" : " ") + patterns;
    filters.push_back({kind.name, std::move(patterns)});
  }
  if (filters.size() > 1) filters.insert(filters.begin(), {kAllKinds, std::move(all)});
  filters.push_back({kAllFiles, "*"});
  return filters;
}

std::vector<std::string> zenityWords(const Dialog& question) {
  // A folder ends in a slash, so that it is entered.
  const std::filesystem::path start = question.folder / question.name;
  std::vector<std::string> words = {"--file-selection", "--title=" + question.title,
                                    "--filename=" + start.string()};
  if (question.kind == Dialog::Kind::SaveFile) words.emplace_back("--save");
  if (question.kind == Dialog::Kind::Folder) words.emplace_back("--directory");
  if (question.kind == Dialog::Kind::Folder) return words;
  for (const Filter& filter : filtersOf(question))
    words.push_back("--file-filter=" + filter.name + " | " + filter.patterns);
  return words;
}

std::vector<std::string> kdialogWords(const Dialog& question) {
  const std::filesystem::path start = question.folder / question.name;
  std::vector<std::string> words = {"--title", question.title};
  if (question.kind == Dialog::Kind::Folder) {
    words.insert(words.end(), {"--getexistingdirectory", start.string()});
    return words;
  }
  words.emplace_back(question.kind == Dialog::Kind::SaveFile ? "--getsavefilename" : "--getopenfilename");
  words.push_back(start.string());
  std::string filters;
  for (const Filter& filter : filtersOf(question))
    filters += (filters.empty() ? "" : "\n") + filter.name + " (" + filter.patterns + ")";
  words.push_back(std::move(filters));
  return words;
}

DesktopDialog::Answer answerOf(const std::filesystem::path& program, const std::vector<std::string>& words,
                               const std::stop_token& stop) {
  auto ran = runToAnyEnd(program, words, stop);
  if (!ran) return failAgain(ran.error());
  if (ran->exit_code == kCancelled) return std::string();
  if (ran->exit_code != kChosen)
    return fail(program.filename().string(), "ended with code " + std::to_string(ran->exit_code));
  if (ran->out.ends_with('\n')) ran->out.pop_back();
  return std::move(ran->out);
}

}  // namespace

std::filesystem::path desktopDialogProgram() {
  if (!isSet("DISPLAY") && !isSet("WAYLAND_DISPLAY")) return {};
  for (const char* name : {"zenity", "kdialog"})
    if (std::filesystem::path program = inPath(name); !program.empty()) return program;
  return {};
}

std::vector<std::string> desktopDialogWords(const std::filesystem::path& program, const Dialog& question) {
  return program.filename() == "kdialog" ? kdialogWords(question) : zenityWords(question);
}

void DesktopDialog::ask(std::filesystem::path program, Dialog question) {
  std::promise<Answer> promise;
  answer_ = promise.get_future();
  std::vector<std::string> words = desktopDialogWords(program, question);
  question_ = std::move(question);
  thread_ = std::jthread([program = std::move(program), words = std::move(words),
                          promise = std::move(promise)](const std::stop_token& stop) mutable {
    promise.set_value(answerOf(program, words, stop));
  });
}

std::optional<DesktopDialog::Closed> DesktopDialog::closed() {
  if (!open() || answer_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  return Closed{std::move(question_), answer_.get()};
}

}  // namespace lambent::editor
