// Puts what a fuzzer made into a file, since readers take paths.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

#include <unistd.h>

namespace lambent::fuzz {

// Returns a folder of this process, which is removed at its end.
inline const std::filesystem::path& folder() {
  struct Folder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("lambent-fuzz-" + std::to_string(::getpid()));
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
  };
  static const Folder folder;
  return folder.path;
}

// Returns a folder for what is slow to make, which scripts/fuzz keeps between runs.
inline std::filesystem::path keptFolder() {
  const char* kept = std::getenv("LAMBENT_FUZZ_KEPT");
  return kept ? std::filesystem::path(kept) : folder() / "kept";
}

inline std::filesystem::path inputFile(const std::string& name, std::span<const std::uint8_t> bytes) {
  std::filesystem::path path = folder() / name;
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return path;
}

// Ends the process with a message, as a failed assertion does, if a promise is broken.
inline void require(bool kept, const std::string& promise) {
  if (kept) return;
  std::fprintf(stderr, "broken promise: %s\n", promise.c_str());
  std::abort();
}

}  // namespace lambent::fuzz
