// Encodes pictures for the page, where twenty lossless ones would be too many bytes.
#pragma once

#include <string>

#include "runtime/base/result.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::baker {

// Returns a data URI of the picture as JPEG.
Result<std::string> jpegUri(const spec::Rgba8Image& picture);

// Returns the bytes in base 64 (RFC 4648).
std::string base64(std::string_view bytes);

}  // namespace lambent::baker
