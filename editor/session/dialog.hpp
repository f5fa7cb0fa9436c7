// Describes a question to the user: which file, which text, or whether to go on. panels/dialogs.cpp draws it,
// and the rest of the editor keeps running.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "editor/session/dialog_files.hpp"

namespace lambent::editor {

class Session;

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
  std::string title, question;
  std::vector<FileKind> kinds;                   // of files to list; empty: all files
  std::size_t filter = 0;                        // 0: all these kinds; n: the nth; past the last: all files
  std::filesystem::path folder;                  // the folder that is shown
  std::string name;                              // the text typed so far
  std::string yes = "OK", no = "Cancel", third;  // button texts; an empty third one has no button
  std::function<void(Session&, const std::string& answer)> answered;
  std::function<void(Session&)> third_chosen;
  DialogFiles found;  // what the window lists for it
};

}  // namespace lambent::editor
