// Finds and opens the files of a scene, and the options of importScene() that say which it may name.
#pragma once

#include <cstddef>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::baker {

struct ImportOptions {
  // Lets buffers and images lie outside the scene's folder: absolute paths, "..", links that lead out. This
  // is for scenes from a trusted place only, since a scene chooses which files are read.
  bool allow_outside = false;
};

// For files that break the rules of glTF.
inline constexpr const char* kExportAgain = "export the scene again";

// Returns the exception's text without the tag that nlohmann::json puts in front.
inline std::string reasonOf(const std::exception& exception) {
  if (dynamic_cast<const std::bad_alloc*>(&exception)) return "it needs more memory than there is";
  const std::string text = exception.what();
  const std::size_t tag = text.starts_with("[json.") ? text.find("] ") : std::string::npos;
  return tag == std::string::npos ? text : text.substr(tag + 2);
}

// Opens a glTF file. It tells .gltf text from a .glb container by the first bytes and takes the container
// apart. The JSON text and, for a .glb, its binary chunk go out; every length is compared with the file's
// before use. Source: glTF 2.0 specification, section 4 (GLB).

struct Container {
  std::string json;
  std::vector<std::byte> binary;  // empty if there is no binary chunk
};

// Errors: missing or empty file, damaged container, glTF 1.
Result<Container> openContainer(const std::filesystem::path& path);

// Returns the bytes of a file. Errors name `subject`: the file is missing, a folder or unreadable.
Result<std::vector<std::byte>> readBytes(const std::filesystem::path& path, const std::string& subject);

// Resolves relative URIs of a glTF file to files beside it. A scene may come from anywhere, so it may only
// name files in its own folder or below: absolute paths, ".." past the folder and links that lead out are
// refused unless ImportOptions::allow_outside is set. Other schemes (http:, file:) are always refused. Names
// that only differ in ways that other systems do not mind, such as backslashes or the case of letters, are
// found with a warning.

// Undoes percent-encoding: "Box%20With%20Spaces.bin" becomes "Box With Spaces.bin".
std::string decodePercent(const std::string& uri);

// Returns the file that `uri` of the scene `file` names. Errors name the scene and `object` ("buffer 0").
Result<std::filesystem::path> resolveUri(const std::filesystem::path& file, const std::string& uri,
                                         const ImportOptions& options, const std::string& object,
                                         std::vector<std::string>& warnings);

// Returns the bytes behind a URI of the scene `file`: a data: URI (base64 or percent-encoded, of any media
// type) or a file. Errors name the scene and `object`.
Result<std::vector<std::byte>> readUri(const std::filesystem::path& file, const std::string& uri,
                                       const ImportOptions& options, const std::string& object,
                                       std::vector<std::string>& warnings);

}  // namespace lambent::baker
