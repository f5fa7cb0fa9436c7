// An AtomicFile appears whole or not at all. It is written beside its final path and renamed on commit, so an
// interrupted or failed program neither leaves half a file nor loses the old one.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "runtime/base/result.hpp"

namespace lambent {

class AtomicFile {
 public:
  // Opens PATH.part-PID for writing, and removes parts of PATH that killed programs left behind. Fails if the
  // folder is missing or not writable.
  static Result<AtomicFile> open(const std::filesystem::path& path);

  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&& other) noexcept;
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();  // removes the part file if commit() was not called

  Result<void> write(std::span<const std::byte> bytes);
  Result<void> write(const std::string& text);
  // Returns where what was written lies until commit().
  const std::filesystem::path& part() const { return part_; }
  // Flushes to disk and renames the part file to PATH. The object is empty afterwards.
  Result<void> commit();

 private:
  AtomicFile(std::filesystem::path path, std::filesystem::path part, int descriptor);
  void discard() noexcept;

  std::filesystem::path path_;
  std::filesystem::path part_;
  int descriptor_ = -1;
};

// Writes a whole file that way.
Result<void> writeFile(const std::filesystem::path& path, std::span<const std::byte> bytes);

// Checks that there is a regular file to read, before anything opens it: a pipe would wait for its other end
// for ever. `kind` is what to name instead, as "a file".
Result<void> checkRegularFile(const std::filesystem::path& path, const std::string& kind);

// Returns the whole file. The error says whether it is missing, not a regular file or unreadable.
Result<std::string> readTextFile(const std::filesystem::path& path);

}  // namespace lambent
