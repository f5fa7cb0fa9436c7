// A file that appears whole or not at all: written beside its final place and renamed on commit, so that an
// interrupted or failed program never leaves half a file nor loses the old one.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "runtime/base/result.hpp"

namespace lambent {

class AtomicFile {
 public:
  // Opens PATH.part-PID for writing. Fails if the folder is missing or not writable.
  static Result<AtomicFile> open(const std::filesystem::path& path);

  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&& other) noexcept;
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();  // without commit(): removes the part file

  Result<void> write(std::span<const std::byte> bytes);
  Result<void> write(const std::string& text);
  // Flushes to disk and renames over PATH. The object is empty afterwards.
  Result<void> commit();

 private:
  AtomicFile(std::filesystem::path path, std::filesystem::path part, int descriptor);
  void discard() noexcept;

  std::filesystem::path path_;
  std::filesystem::path part_;
  int descriptor_ = -1;
};

// The whole file, or an error that says whether it is missing, a folder or unreadable.
Result<std::string> readTextFile(const std::filesystem::path& path);

}  // namespace lambent
