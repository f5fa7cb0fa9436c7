#include "baker/accuracy/perceptual.hpp"

#include <cmath>
#include <vector>

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <fmt/format.h>

namespace lambent::baker {

namespace {

constexpr float kWhite = 100.0f;  // cd/m²
constexpr float kFieldDeg = 45.0f;

float linearFromSrgb(float c) {
  return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

// Returns the light that a screen sends out, 1 for white. The predictor takes linear values.
OIIO::ImageBuf lightOf(const spec::Rgba8Image& picture) {
  const auto width = static_cast<int>(picture.width), height = static_cast<int>(picture.height);
  OIIO::ImageBuf light(OIIO::ImageSpec(width, height, 3, OIIO::TypeDesc::FLOAT));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::uint8_t* texel =
          &picture.texels[4 * (static_cast<std::size_t>(y) * picture.width + static_cast<std::size_t>(x))];
      const float rgb[3] = {linearFromSrgb(static_cast<float>(texel[0]) / 255.0f),
                            linearFromSrgb(static_cast<float>(texel[1]) / 255.0f),
                            linearFromSrgb(static_cast<float>(texel[2]) / 255.0f)};
      light.setpixel(x, y, rgb);
    }
  return light;
}

}  // namespace

Result<double> visibleShare(const spec::Rgba8Image& picture, const spec::Rgba8Image& reference,
                            const std::string& subject) {
  if (picture.width != reference.width || picture.height != reference.height)
    return fail(subject,
                fmt::format("is {} x {}, the reference {} x {}", picture.width, picture.height,
                            reference.width, reference.height),
                "draw both with the same --size");
  OIIO::ImageBufAlgo::CompareResults result{};
  // One thread, so that the figure does not depend on their number.
  const int visible = OIIO::ImageBufAlgo::compare_Yee(lightOf(picture), lightOf(reference), result, kWhite,
                                                      kFieldDeg, {}, /*nthreads=*/1);
  return static_cast<double>(visible) /
         (static_cast<double>(picture.width) * static_cast<double>(picture.height));
}

}  // namespace lambent::baker
