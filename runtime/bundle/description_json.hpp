// Description <-> the JSON chunk of a bundle: a glTF 2.0 document with the extension
// LAMBENT_radiance_transfer. Writer and parser stand side by side by subject: gltf_json.cpp holds the glTF
// part, transfer_json.cpp the extension.
#pragma once

#include <cstdint>
#include <string>

#include "runtime/base/result.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::bundle {

// The file's last bufferView is not one of Description::views: 16 bytes at the start of the binary chunk, the
// checksum of the JSON chunk and its complement. So that no byte of the file can change unseen.
inline constexpr std::uint64_t kIntegrityBytes = 16;

// Views must lie inside `binary_bytes`.
std::string toJson(const Description& description, std::uint64_t binary_bytes);

// Errors name `file`: not JSON, not glTF 2.0, no extension (not a bundle), a version that this program does
// not know, anything missing, of the wrong type or out of range. Keyframes of animations have their sizes but
// not their values, which stand in the binary chunk (gltf_parts.hpp).
Result<Description> fromJson(const std::string& text, std::uint64_t binary_bytes, const std::string& file);

}  // namespace lambent::bundle
