// Writes bundles: a valid GLB 2.0 whose binary chunk holds the views in the order given. The counterpart of
// reader.hpp.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::bundle {

using Blob = std::vector<std::byte>;

// `description.views` is filled here: blobs[i] becomes view i; the keyframes of the animations, which have at
// least one channel with keys each, follow in views of their own. The file appears whole or not at all.
// The same description and blobs give the same bytes. Errors: transfer that is not a number, which no reader
// takes; more than a GLB can hold; a file that cannot be written.
Result<void> write(const std::filesystem::path& path, Description description,
                   const std::vector<Blob>& blobs);

}  // namespace lambent::bundle
