// Describes questions to the user: which file, which text, or whether to go on. panels/dialogs.cpp draws
// them, or the desktop's own dialog asks, and the rest of the editor keeps running. Main thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"

namespace lambent::editor {

class Session;
struct Dialog;

struct DialogPlace {
  std::string name;
  std::filesystem::path folder;
};

struct DialogFile {
  std::string name;
  bool is_folder = false;
};

// Finds what a dialog for files lists: places where files are likely to be, and what is in its folder. Disks
// are asked once when the dialog opens, and again only when the folder or the filter changes. Folders that
// cannot be read are empty.
class DialogFiles {
 public:
  void update(const Session& session, const Dialog& dialog);

  // Home, beside what is open and what was opened, among the samples. Each folder is named once.
  const std::vector<DialogPlace>& places() const { return places_; }
  // Folders first, then the files of the kinds that the dialog's filter shows, by name.
  const std::vector<DialogFile>& files() const { return files_; }

 private:
  std::vector<DialogPlace> places_;
  std::vector<DialogFile> files_;
  ChangeGate<> placed_;
  ChangeGate<std::filesystem::path, std::filesystem::file_time_type, std::size_t> listed_;
};

// Names a kind of file by the endings of its names.
struct FileKind {
  std::string name;
  std::vector<std::string> endings;
};

// The choices beside the kinds of a question, in its filter.
inline constexpr const char *kAllKinds = "All that can be opened", *kAllFiles = "All files";

struct Dialog {
  enum class Kind : std::uint8_t { OpenFile, SaveFile, Folder, Confirm, Text };
  Kind kind = Kind::Confirm;
  std::string title{}, question{};
  std::vector<FileKind> kinds{};                   // of files to list; empty: all files
  std::size_t filter = 0;                          // 0: all these kinds; n: the nth; past the last: all files
  std::filesystem::path folder{};                  // the folder that is shown
  std::string name{};                              // the text typed so far
  std::string yes = "OK", no = "Cancel", third{};  // button texts; an empty third one has no button
  std::function<void(Session&, const std::string& answer)> answered{};
  std::function<void(Session&)> third_chosen{};
  DialogFiles found{};  // what the window lists for it
};

// Returns the desktop's program for file dialogs, or an empty path without a desktop session or such a
// program in PATH.
std::filesystem::path desktopDialogProgram();
std::vector<std::string> desktopDialogWords(const std::filesystem::path& program, const Dialog& question);

// Asks for a file in the desktop's own dialog: zenity or kdialog, run as a program of its own with arguments
// and without a shell, on a thread, so that the window lives on. At most one is open at a time.
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

// Holds what commands request from the window: a dialog, panels to bring to the front, or the end of the
// program. The window reads and clears them once a frame.
struct WindowRequests {
  std::optional<Dialog> dialog;  // at most one at a time
  // The program for the desktop's own file dialogs. Empty: there is none, or a script drives the window.
  std::filesystem::path desktop_program;
  DesktopDialog desktop_dialog;
  std::vector<std::string> wanted_panels;  // names of panels to bring to the front
  bool raise_tabs = true;                  // also bring the preferences' tabs to the front
  // Ids of commands to run in the next frame, when fields that were open have taken over what was typed.
  std::vector<std::string> wanted_commands;
  bool palette = false;  // the list of commands is open
  bool keys = false;     // the list of keys is open
  std::string palette_words;
  bool quit = false;
  std::uint64_t frames = 0;  // how many the window has drawn
};

}  // namespace lambent::editor
