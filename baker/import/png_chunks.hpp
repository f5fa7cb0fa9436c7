// Looks at the chunks of a PNG before it is decoded.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::baker {

// Returns the PNG with only the chunks that its pixels need. The decoder writes its own lines to stderr about
// others (colour profiles, above all) and about wrong checksums, and leaks memory if the file ends early, so
// those are errors here. They name `subject`.
Result<std::vector<std::byte>> essentialPng(std::span<const std::byte> png, const std::string& subject);

}  // namespace lambent::baker
