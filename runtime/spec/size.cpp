#include "runtime/spec/size.hpp"

#include <charconv>
#include <string>

namespace lambent::spec {

Result<Size> parseSize(std::string_view word) {
  Size size;
  const char* const end = word.data() + word.size();
  const auto [cross, width_code] = std::from_chars(word.data(), end, size.width);
  const bool has_cross = width_code == std::errc{} && cross != end && *cross == 'x';
  const auto [stop, height_code] = std::from_chars(has_cross ? cross + 1 : end, end, size.height);
  const std::string subject = "size \"" + std::string(word) + "\"";
  const std::string form = "write WIDTHxHEIGHT in pixels, each 1.." + std::to_string(kMaxPictureSide);
  if (!has_cross || height_code != std::errc{} || stop != end)
    return fail(subject, "is not a picture size", form);
  if (size.width < 1 || size.height < 1 || size.width > kMaxPictureSide || size.height > kMaxPictureSide)
    return fail(subject, "is out of range", form);
  return size;
}

}  // namespace lambent::spec
