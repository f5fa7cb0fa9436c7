// Mends (mend.hpp) and checks a glTF document before anything reads it by index. tinygltf trusts much of what
// a file says: it follows bufferView numbers, offsets and Draco attributes unchecked, cuts 64-bit numbers to
// int, and silently drops broken primitives. So a document passes here first: types, ranges, references, byte
// extents of every view and accessor, and the node tree. After this, code in this room may follow any index.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "runtime/base/result.hpp"

namespace lambent::baker {

// Returns whether this room reads the extension. Others cause a warning, and are refused if they are required
// and hold geometry.
bool readsExtension(std::string_view name);

// Errors name `file` and the object, such as "accessor 3". Warnings are those of mends.
Result<void> checkDocument(nlohmann::json& document, const std::string& file,
                           std::vector<std::string>& warnings);

}  // namespace lambent::baker
