// Finds what a dialog for files lists: places where files are likely to be, and what is in its folder. Disks
// are asked once when the dialog opens, and again only when the folder or the filter changes. Main thread.
// Folders that cannot be read are empty.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/base/change_gate.hpp"

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

class DialogFiles {
 public:
  // Call it in each frame in which the dialog is drawn.
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

}  // namespace lambent::editor
