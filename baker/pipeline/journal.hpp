// The journal records which bakes were begun and not finished: one file for each in a folder, written when
// the bake begins and removed when it is done, failed or was cancelled. A program that was killed or lost its
// power leaves its files behind, and unfinished() finds them. While a bake runs, its file is locked, and the
// lock ends with the process, so no other process takes the bake for cut short. Any number of processes may
// use one folder.
//
// If the journal cannot be written, the bake runs all the same, and its entry says why it has no record.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "baker/pipeline/bake_request.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

// The folder lies in the work folder of a queue.
inline constexpr const char* kJournalFolder = "journal";

class Journal {
 public:
  // With an empty path nothing is recorded. The folder is made with the first entry.
  explicit Journal(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // An Entry lives while its bake runs. done() removes the record; otherwise it stays for a later run to
  // resume.
  class Entry {
   public:
    Entry() = default;
    Entry(Entry&& other) noexcept;
    Entry& operator=(Entry&& other) noexcept;
    ~Entry();
    void done();
    // Returns why the bake has no record, if that is not since another process bakes the same: were it cut
    // short, nothing would resume it.
    const std::optional<Error>& error() const { return error_; }

   private:
    friend class Journal;
    std::filesystem::path file_;
    int lock_ = -1;
    std::optional<Error> error_;
  };

  // Returns an entry without a record (file_ empty) if another process bakes the same, and one with an error
  // if the record cannot be written.
  Entry begin(const BakeRequest& request) const;
  // Returns the bakes that no process works on, in the order in which they began.
  std::vector<BakeRequest> unfinished() const;
  // Removes the record of a bake that was given up for good.
  void forget(const BakeRequest& request) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace lambent::baker
