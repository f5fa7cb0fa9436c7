#include "baker/sweep/jpeg.hpp"

#include <cstdint>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

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
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  OIIO::ImageSpec spec(static_cast<int>(picture.width), static_cast<int>(picture.height), 3,
                       OIIO::TypeDesc::UINT8);
  spec.attribute("Compression", "jpeg:" + std::to_string(kQuality));
  std::vector<std::uint8_t> rgb;
  for (std::size_t i = 0; i < picture.texels.size(); i += 4)
    rgb.insert(rgb.end(), picture.texels.begin() + static_cast<std::ptrdiff_t>(i),
               picture.texels.begin() + static_cast<std::ptrdiff_t>(i) + 3);
  const auto output = OIIO::ImageOutput::create("picture.jpg", &memory);
  if (!output || !output->set_ioproxy(&memory) || !output->open("picture.jpg", spec) ||
      !output->write_image(OIIO::TypeDesc::UINT8, rgb.data()) || !output->close())
    return fail("a picture", "cannot be encoded: " + (output ? output->geterror() : OIIO::geterror()));
  return "data:image/jpeg;base64," +
         base64(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace lambent::baker
