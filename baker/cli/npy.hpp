// Writes arrays as .npy files of version 1.0, which NumPy and most tools for numbers read: little-endian, in
// the order of C. Errors: the file cannot be written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::baker {

using ArrayShape = std::vector<std::size_t>;  // its product is the number of values

Result<void> writeNpy(const std::filesystem::path& path, const ArrayShape& shape,
                      std::span<const float> values);
Result<void> writeNpy(const std::filesystem::path& path, const ArrayShape& shape,
                      std::span<const std::uint32_t> values);

}  // namespace lambent::baker
