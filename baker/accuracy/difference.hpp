// Shows where and by how much a picture differs from a reference, as colours and in the figures of
// comparePictures(). Two linear pictures of one size come in, with an optional second independent reference,
// whose noise then cancels in the figures (though not in single pixels). An 8-bit picture and the range of
// its colours go out. Calls are safe from any thread; 1280 x 720 takes less than 0.2 s.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "baker/accuracy/compare.hpp"

namespace lambent::baker {

enum class HeatMap {
  // (Y - Y_ref) / max(Y_ref, 5 % of the picture's RMS luminance): red where the picture is too bright, white
  // where it is right, blue where it is too dark. The floor keeps near-black pixels from filling the map.
  Signed,
  // The length of the difference over the channels, relative to the reference's RMS over the picture: black
  // where it is right, then red, yellow, white. These are the values whose percentiles comparePictures()
  // returns.
  Magnitude,
};

// Parses "signed" or "magnitude".
Result<HeatMap> parseHeatMap(std::string_view word);

struct HeatOptions {
  HeatMap map = HeatMap::Signed;
  // The end of the colour range, as a share (0.1 is 10 %). By default it is the value that 99 of 100 pixels
  // are below, rounded up to 1, 2 or 5 times a power of ten.
  std::optional<double> range = {};
};

struct Difference {
  PictureError figures;
  // Pixels that no picture covers are dark grey; those that only some cover are violet.
  spec::Rgba8Image heat;
  double range = 0.0;
};

// Returns the sRGB colour for a share of the range, e.g. for a legend: -1..1 if signed, else 0..1; clamped.
std::array<std::uint8_t, 3> heatColor(HeatMap map, double share);

// `reference2` is null if there is none. Errors: those of comparePictures(), or a range that is not above 0.
Result<Difference> differenceOf(const spec::RgbaImage& picture, const spec::RgbaImage& reference,
                                const spec::RgbaImage* reference2, const HeatOptions& options,
                                const std::string& subject);

}  // namespace lambent::baker
