// Which bakes were begun and not finished: a file for each in a folder, written when it begins and removed
// when it is done, failed or was cancelled. A program that was killed or lost its power leaves its files
// behind; unfinished() finds them. While a bake runs its file is locked, which ends with the process however
// that ends: no other process takes it for cut short. Any number of processes may use one folder.
//
// A journal that cannot be written does not keep a bake from being made.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "baker/pipeline/bake_request.hpp"

namespace lambent::baker {

// In the work folder of a queue.
inline constexpr const char* kJournalFolder = "journal";

class Journal {
 public:
  // An empty path: nothing is recorded. Makes the folder with the first entry.
  explicit Journal(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // While it lives, the bake runs. done() removes the record; else it stays, for a later run to take up.
  class Entry {
   public:
    Entry() = default;
    Entry(Entry&& other) noexcept;
    Entry& operator=(Entry&& other) noexcept;
    ~Entry();
    void done();

   private:
    friend class Journal;
    std::filesystem::path file_;
    int lock_ = -1;
  };

  // Without a record (file_ empty) where another process bakes the same, or nothing can be written.
  Entry begin(const BakeRequest& request) const;
  // Of bakes that no process works at; in the order in which they began.
  std::vector<BakeRequest> unfinished() const;
  // The bake of that scene and output was given up for good.
  void forget(const BakeRequest& request) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace lambent::baker
