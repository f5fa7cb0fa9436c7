// Decodes EXT_meshopt_compression: bufferViews coded by meshoptimizer (with the codecs and filters of the
// glTF extension, which gltfpack writes). The bytes are checked before use and decoded into the buffer that
// the view names, so accessors read them like any others.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "runtime/base/result.hpp"

namespace lambent::baker {

inline constexpr const char* kMeshopt = "EXT_meshopt_compression";

// The most decoded bytes per coded byte: vertex blocks of equal bytes take 2 bits for 16 bytes, triangles one
// byte for 12. A file that claims more is refused before memory is taken.
inline constexpr std::size_t kMeshoptLargestRatio = 256;

// Decodes one view by its checked extension object. `view` has its count * stride bytes. Errors name
// `subject` and `object`: the bytes are damaged.
Result<void> decodeMeshopt(const nlohmann::json& extension, std::span<const std::byte> coded,
                           std::span<std::byte> view, const std::string& subject, const std::string& object);

}  // namespace lambent::baker
