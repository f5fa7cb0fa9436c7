// Relative URIs of a glTF file to files beside it. A scene may come from anywhere, so it may only name files
// in its own folder or below: absolute paths, other schemes, ".." past the folder and links that lead out are
// refused.
#pragma once

#include <filesystem>
#include <string>

#include "runtime/base/result.hpp"

namespace lambent::baker {

// Undoes percent-encoding: "Box%20With%20Spaces.bin" -> "Box With Spaces.bin".
std::string decodePercent(const std::string& uri);

// The file that `uri` names, inside `folder`. Errors name `subject` and `object` ("buffer 0").
Result<std::filesystem::path> resolveUri(const std::filesystem::path& folder, const std::string& uri,
                                         const std::string& subject, const std::string& object);

}  // namespace lambent::baker
