// Reads accessors of a checked document as floats or indices: plain, interleaved, normalised, sparse, or
// without a bufferView (zeros). Integers become what glTF says: value / max if normalised, else the value
// itself.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "baker/import/document.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

// Holds a scalar, vector or 4 x 4 matrix per element, with `components` floats each; components that the file
// lacks (VEC3 colours in a VEC4) are 1. Errors name the accessor and `use` ("POSITION").
struct Floats {
  std::vector<float> values;
  std::size_t components = 0;
  std::size_t count() const { return components == 0 ? 0 : values.size() / components; }
};
Result<Floats> readFloats(const Document& document, int accessor, const std::string& use,
                          const std::vector<int>& allowed_components, std::size_t components);

// Reads an index accessor, sparse or not.
Result<std::vector<std::uint32_t>> readIndices(const Document& document, int accessor);

}  // namespace lambent::baker
