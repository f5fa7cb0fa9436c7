// Describes questions to the user: which file, which text, or whether to go on. panels/dialogs.cpp draws
// them, and the rest of the editor keeps running. Main thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "runtime/base/change_gate.hpp"

namespace lambent::editor {

class Session;

struct DialogPlace {
  std::string name;
  std::filesystem::path folder;
};

struct DialogFile {
  std::string name;
  bool is_folder = false;
};

// Names a kind of file by the endings of its names.
struct FileKind {
  std::string name;
  std::vector<std::string> endings;
};

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

  // What the window lists: places where files are likely to be, found when the dialog opens, and the contents
  // of the folder. Disks are not asked in every frame.
  std::vector<DialogPlace> places{};
  std::vector<DialogFile> files{};
  ChangeGate<std::filesystem::path, std::filesystem::file_time_type, std::size_t> listed{};
};

// Holds what commands request from the window: a dialog, panels to bring to the front, or the end of the
// program. The window reads and clears them once a frame.
struct WindowRequests {
  std::optional<Dialog> dialog;            // at most one at a time
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
