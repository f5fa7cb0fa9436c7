#include "baker/sweep/jpeg.hpp"

#include <cstdint>

#include "baker/import/openimageio/module.hpp"

namespace lambent::baker {

std::string base64(std::string_view bytes) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k <= bytes.size() ? kDigits[word >> (18 - 6 * k) & 63u] : '=';
  }
  return out;
}

Result<std::string> jpegUri(const spec::Rgba8Image& picture) {
  constexpr int kQuality = 88;
  const auto writer = openImageIo();
  if (!writer) return failAgain(writer.error());
  Pixels rgb{.width = picture.width, .height = picture.height, .channels = 3, .values = {}};
  for (std::size_t i = 0; i < picture.texels.size(); i += 4)
    rgb.values.insert(rgb.values.end(), picture.texels.begin() + static_cast<std::ptrdiff_t>(i),
                      picture.texels.begin() + static_cast<std::ptrdiff_t>(i) + 3);
  const auto bytes = (*writer)->encodeJpeg(rgb, kQuality, "a picture");
  if (!bytes) return failAgain(bytes.error());
  return "data:image/jpeg;base64," +
         base64(std::string_view(reinterpret_cast<const char*>(bytes->data()), bytes->size()));
}

}  // namespace lambent::baker
