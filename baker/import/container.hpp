// Opens a glTF file. It tells .gltf text from a .glb container by the first bytes and takes the container
// apart. The JSON text and, for a .glb, its binary chunk go out; every length is compared with the file's
// before use. Source: glTF 2.0 specification, section 4 (GLB).
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::baker {

struct Container {
  std::string json;
  std::vector<std::byte> binary;  // empty if there is no binary chunk
};

// Errors: missing or empty file, damaged container, glTF 1.
Result<Container> openContainer(const std::filesystem::path& path);

// Returns the bytes of a file. Errors name `subject`: the file is missing, a folder or unreadable.
Result<std::vector<std::byte>> readBytes(const std::filesystem::path& path, const std::string& subject);

}  // namespace lambent::baker
