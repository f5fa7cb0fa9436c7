// Writes bundles, the counterpart of reader.hpp. A bundle is a valid GLB 2.0 file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::bundle {

using Blob = std::vector<std::byte>;

// Looks at a whole bundle before it takes the place of the old one.
using PartCheck = std::function<Result<void>(const std::filesystem::path& part)>;

// Writes a bundle and fills `description.views`: blobs[i] becomes view i, and each animation gets another
// view for its keyframes after them. Every animation must have at least one channel with keys. The file
// appears whole or not at all, and equal input gives equal bytes. Fails if transfer is not finite, if the
// file would exceed the 4 GiB of a GLB, if it cannot be written, or if `check` finds fault with it.
Result<void> write(const std::filesystem::path& path, Description description, const std::vector<Blob>& blobs,
                   const PartCheck& check = {});

}  // namespace lambent::bundle
