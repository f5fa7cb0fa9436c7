// Where a picture differs from a reference, as colours, and by how much, in the figures of comparePictures().
// Comes in: two linear pictures of one size and, where there is one, a second independent reference, whose
// noise then cancels in the figures (of a single pixel it cannot be told from error). Goes out: a picture of
// eight bits with a range that its colours span. Any thread; 1280 x 720 in less than 0.2 s.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "baker/accuracy/compare.hpp"

namespace lambent::baker {

enum class HeatMap {
  // (Y - Y_ref) / max(Y_ref, 5 % of the picture's RMS luminance): red where the picture is too bright, white
  // where it is right, blue where it is too dark. The floor keeps what is next to black from filling the map.
  Signed,
  // The length of the difference over the channels, relative to the reference's RMS over the picture: black
  // where it is right, then red, yellow, white. What comparePictures() has percentiles of.
  Magnitude,
};

// "signed" or "magnitude".
Result<HeatMap> parseHeatMap(std::string_view word);

struct HeatOptions {
  HeatMap map = HeatMap::Signed;
  // Where the colours end, as a share (0.1: 10 %); none: what 99 of 100 pixels are below, rounded up to
  // 1, 2 or 5 times a power of ten.
  std::optional<double> range = {};
};

struct Difference {
  PictureError figures;
  // Pixels that no picture covers are dark grey; those that one covers and another does not are violet.
  spec::Rgba8Image heat;
  double range = 0.0;
};

// For the bar beside the map: share of the range, -1..1 where signed, else 0..1; clamped. sRGB.
std::array<std::uint8_t, 3> heatColor(HeatMap map, double share);

// reference2: null where there is none. Errors: those of comparePictures(); a range that is not above 0.
Result<Difference> differenceOf(const spec::RgbaImage& picture, const spec::RgbaImage& reference,
                                const spec::RgbaImage* reference2, const HeatOptions& options,
                                const std::string& subject);

}  // namespace lambent::baker
