// EXT_meshopt_compression: bufferViews whose bytes are coded by meshoptimizer (the codecs and filters of the
// glTF extension, which gltfpack writes). Checked before use like everything else; decoded into the buffer
// that the view names, so that accessors need not know.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "runtime/base/result.hpp"

namespace lambent::baker {

inline constexpr const char* kMeshopt = "EXT_meshopt_compression";

// The most that a coded byte can stand for: vertex blocks of equal bytes take 2 bits for 16 bytes, triangles
// one byte for 12. A file that claims more for an empty buffer is refused before memory is taken.
inline constexpr std::size_t kMeshoptLargestRatio = 256;

// Decodes one view by its (checked) extension object. `view` are its count * stride bytes.
// Errors name `subject` and `object`: bytes that are not what they should be.
Result<void> decodeMeshopt(const nlohmann::json& extension, std::span<const std::byte> coded,
                           std::span<std::byte> view, const std::string& subject, const std::string& object);

}  // namespace lambent::baker
