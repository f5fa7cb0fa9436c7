// Opens a glTF file: tells .gltf text from a .glb container by its first bytes and takes the container apart.
// Out come the JSON text and, for a .glb, its binary chunk; every length is compared with the file's before
// use. Source: glTF 2.0 specification, section 4 (GLB).
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::baker {

struct Container {
  std::string json;
  std::vector<std::byte> binary;  // empty: no binary chunk
};

// Errors: missing or empty file, damaged container, glTF 1.
Result<Container> openContainer(const std::filesystem::path& path);

// The bytes of a file, an error if it is missing, a folder or unreadable. `subject` goes into the error.
Result<std::vector<std::byte>> readBytes(const std::filesystem::path& path, const std::string& subject);

}  // namespace lambent::baker
