// Asks for a file in the desktop's own dialog: zenity or kdialog, run as a program of its own with arguments
// and without a shell, on a thread, so that the window lives on. At most one is open at a time. Main thread.
#pragma once

#include <filesystem>
#include <future>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "editor/session/dialog.hpp"
#include "runtime/base/result.hpp"

namespace lambent::editor {

// Returns the desktop's program for file dialogs, or an empty path without a desktop session or such a
// program in PATH.
std::filesystem::path desktopDialogProgram();
// Returns the program's arguments for a question that asks for a file or a folder.
std::vector<std::string> desktopDialogWords(const std::filesystem::path& program, const Dialog& question);

class DesktopDialog {
 public:
  // An empty answer is a cancel. Errors: the program cannot be started, or was ended.
  using Answer = Result<std::string>;

  DesktopDialog() = default;
  bool open() const { return answer_.valid(); }
  void ask(std::filesystem::path program, Dialog question);
  // Returns the answer once it is there, with the question, and is closed then.
  struct Closed {
    Dialog question;
    Answer answer;
  };
  std::optional<Closed> closed();

 private:
  Dialog question_;
  std::future<Answer> answer_;
  std::jthread thread_;  // last: it is stopped, which ends the program, before the rest is destroyed
};

}  // namespace lambent::editor
