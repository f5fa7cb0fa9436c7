// Names the pictures of a sequence: a run of # in the file name stands for the frame's number with as many
// digits.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>

#include <fmt/format.h>

namespace lambent::demo {

inline bool isNumbered(const std::filesystem::path& path) {
  return path.filename().string().find('#') != std::string::npos;
}

// Returns, for "frame-###.png" and 7, "frame-007.png". Only the first run counts; a path without one is
// unchanged.
inline std::filesystem::path numberedPath(const std::filesystem::path& path, std::uint32_t number) {
  std::string name = path.filename().string();
  const std::size_t first = name.find('#');
  if (first == std::string::npos) return path;
  const std::size_t end = std::min(name.find_first_not_of('#', first), name.size());
  name.replace(first, end - first, fmt::format("{:0{}}", number, end - first));
  return path.parent_path() / name;
}

}  // namespace lambent::demo
