// Resolves relative URIs of a glTF file to files beside it. A scene may come from anywhere, so it may only
// name files in its own folder or below: absolute paths, ".." past the folder and links that lead out are
// refused unless ImportOptions::allow_outside is set. Other schemes (http:, file:) are always refused. Names
// that only differ in ways that other systems do not mind, such as backslashes or the case of letters, are
// found with a warning.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "baker/import/import_options.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

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
