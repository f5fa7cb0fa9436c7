// Parses the size of a picture, WIDTHxHEIGHT in pixels, as in --size. Both are in 1..kMaxPictureSide. Errors
// show the expected form.
#pragma once

#include <cstdint>
#include <string_view>

#include "runtime/base/result.hpp"

namespace lambent::spec {

inline constexpr std::uint32_t kMaxPictureSide = 16384;  // size of textures that OpenGL 4.5 guarantees

struct Size {
  std::uint32_t width = 1280, height = 720;
  float aspect() const { return static_cast<float>(width) / static_cast<float>(height); }
  bool operator==(const Size&) const = default;
};

Result<Size> parseSize(std::string_view word);

}  // namespace lambent::spec
