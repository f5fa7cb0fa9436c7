// The word for a picture's size, WIDTHxHEIGHT in pixels, as --size takes it. Both 1..kMaxPictureSide; errors
// show the form that was expected.
#pragma once

#include <cstdint>
#include <string_view>

#include "runtime/base/result.hpp"

namespace lambent::spec {

inline constexpr std::uint32_t kMaxPictureSide = 16384;  // what OpenGL 4.5 guarantees for textures

struct Size {
  std::uint32_t width = 1280, height = 720;
  float aspect() const { return static_cast<float>(width) / static_cast<float>(height); }
  bool operator==(const Size&) const = default;
};

Result<Size> parseSize(std::string_view word);

}  // namespace lambent::spec
