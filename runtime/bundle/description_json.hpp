// Converts a Description to and from the JSON chunk of a bundle, a glTF 2.0 document with the extension
// LAMBENT_radiance_transfer. gltf_json.cpp writes and reads the glTF part, transfer_json.cpp the extension.
#pragma once

#include <cstdint>
#include <string>

#include "runtime/base/result.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::bundle {

// The last bufferView of the file is not one of Description::views. It is 16 bytes at the start of the binary
// chunk: the checksum of the JSON chunk and its complement. With it no byte of the file can change unnoticed.
inline constexpr std::uint64_t kIntegrityBytes = 16;

// Returns the JSON text. Views must lie inside `binary_bytes`.
std::string toJson(const Description& description, std::uint64_t binary_bytes);

// Fails, naming `file`, if the text is not JSON or has no extension (so it is not a bundle), if this program
// does not know the version, or if anything is missing, of the wrong type or out of range. Keyframes of
// animations get their sizes only; their values are in the binary chunk (gltf_parts.hpp).
Result<Description> fromJson(const std::string& text, std::uint64_t binary_bytes, const std::string& file);

}  // namespace lambent::bundle
