#include "editor/session/desktop_dialog.hpp"

#include <chrono>
#include <cstdlib>
#include <string_view>
#include <utility>

#include <unistd.h>

#include "runtime/base/process.hpp"

namespace lambent::editor {

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
