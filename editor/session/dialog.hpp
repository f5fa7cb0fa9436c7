// Asks the user something: which file, or whether to go on. panels/dialogs.cpp draws it; the rest of the
// editor goes on meanwhile.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace lambent::editor {

class Session;

struct Dialog {
  enum class Kind : std::uint8_t { OpenFile, SaveFile, Folder, Confirm, Text };
  Kind kind = Kind::Confirm;
  std::string title, question;
  std::vector<std::string> endings;              // of files; empty: all
  std::filesystem::path folder;                  // where it looks
  std::string name;                              // typed so far
  std::string yes = "OK", no = "Cancel", third;  // third: a way between, no button where empty
  std::function<void(Session&, const std::string& answer)> answered;
  std::function<void(Session&)> third_chosen;
};

}  // namespace lambent::editor
