// Names of picture sequences: a run of # in the file name stands for the number of the frame, with as many
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

// "frame-###.png" and 7: "frame-007.png". The first run counts; without one the path is as it was.
inline std::filesystem::path numberedPath(const std::filesystem::path& path, std::uint32_t number) {
  std::string name = path.filename().string();
  const std::size_t first = name.find('#');
  if (first == std::string::npos) return path;
  const std::size_t end = std::min(name.find_first_not_of('#', first), name.size());
  name.replace(first, end - first, fmt::format("{:0{}}", number, end - first));
  return path.parent_path() / name;
}

}  // namespace lambent::demo
