// The room baker/accuracy owns error figures between linear pictures. This file measures how far a picture is
// from a reference, in linear radiance, over the pixels that both cover (alpha of at least
// spec::kLeastCoverage in every picture), without sky and tone map. The part of the sky that shows through
// clouds and blended surfaces counts with them, since it should be the same in all pictures. With a second,
// independent reference (another seed) the noise of the references cancels, because errors are products of
// two differences with uncorrelated noise. If all pictures have depths, pixels that show different surfaces
// are told apart, whatever their colours: these are rays through cracks of a mesh, or outlines that moved by
// rounding of positions. All functions here are pure and work on the calling thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "runtime/base/result.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::baker {

struct PictureError {
  std::uint64_t pixels = 0;  // covered in all pictures
  // Counts pixels that one picture covers and that are sky in another (less than half of kLeastCoverage).
  // More than the odd pixel of an outline means that scene, camera or size differ.
  std::uint64_t pixels_apart = 0;
  // It is sqrt( sum (X-A)² / sum A² ), and with B sqrt( sum (X-A)(X-B) / sum AB ), 0 if negative.
  double relative_rms = 0.0;
  // This is the standard error of relative_rms²: the remaining noise of two references. relative_rms is
  // meaningful only if its square is well above this. It is 0 with one reference, whose noise cannot be told
  // from error.
  double relative_square_error = 0.0;
  std::array<double, 3> bias{};  // per channel: sum (X-A) / sum A; A the mean of both references
  // These are percentiles over pixels of the RMS difference of the channels, relative to the reference's RMS
  // over the picture. They include the noise of the references.
  double median = 0.0, percentile_95 = 0.0, percentile_99 = 0.0, largest = 0.0;
  // Counts those of `pixels` that show different surfaces: depths of two pictures differ by more than
  // kSameDepth, or only one of them has a depth. Nothing if a picture has no depths.
  std::optional<std::uint64_t> pixels_of_other_surfaces = {};
  // This is relative_rms over the other pixels, by their own energy. It is also nothing if there are none or
  // they are black.
  std::optional<double> same_surface_rms = {};
};

// The bound is relative to the smaller of two depths. It is above the differences that rounded positions and
// the steps of the runtime's depth buffer (1e-4 at worst, runtime/spec/camera.cpp) make on one surface,
// unless it is seen edge on, and below the distance between most objects.
inline constexpr float kSameDepth = 1.0f / 512.0f;

// `reference2` is null if there is none. Errors name `subject`: sizes differ, values are not finite, no pixel
// is covered in all pictures, or a reference is black.
Result<PictureError> comparePictures(const spec::RgbaImage& picture, const spec::RgbaImage& reference,
                                     const spec::RgbaImage* reference2, const std::string& subject);

// Averages pictures with many samples per pixel. If a picture and a reference both sample only the centres of
// pixels, they differ wherever a centre lies on an edge, and errors that no eye can see count in full. The
// mean of n x n pixels is what a screen with as many samples per pixel shows.

// Makes every pixel the mean of n x n, coverage too. Depths are dropped, since they have no mean; n = 1
// returns the picture as it is, with depths. Errors name `subject`: n is less than 1, or the size is no
// multiple of n.
Result<spec::RgbaImage> shrunk(const spec::RgbaImage& picture, std::uint32_t n, const std::string& subject);

// Shows where and by how much a picture differs from a reference, as colours and in the figures of
// comparePictures(). Two linear pictures of one size come in, with an optional second independent reference,
// whose noise then cancels in the figures (though not in single pixels). An 8-bit picture and the range of
// its colours go out. Calls are safe from any thread; 1280 x 720 takes less than 0.2 s.

struct Difference {
  PictureError figures;
  // The luminance (Y - Y_ref) / max(Y_ref, 5 % of the picture's RMS luminance): red where the picture is too
  // bright, white where it is right, blue where it is too dark. The floor keeps near-black pixels from
  // filling the map. Pixels that no picture covers are dark grey; those that only some cover are violet.
  spec::Rgba8Image heat;
  double range = 0.0;  // the end of the colours, as a share (0.1 is 10 %)
};

// Returns the sRGB colour for a share of the range, -1..1; clamped.
std::array<std::uint8_t, 3> heatColor(double share);

// `reference2` is null if there is none. Without a range, it is the value that 99 of 100 pixels are below,
// rounded up to 1, 2 or 5 times a power of ten. Errors: those of comparePictures(), or a range that is not
// above 0.
Result<Difference> differenceOf(const spec::RgbaImage& picture, const spec::RgbaImage& reference,
                                const spec::RgbaImage* reference2, std::optional<double> range,
                                const std::string& subject);

// Measures how much of a picture an eye sees as wrong, by the metric of Yee and Newman (2004): an error is
// visible if it exceeds what the eye can tell at the luminance that it is adapted to, raised where fine
// contrasts are hard to see or mask it. Pictures for a screen come in, as spec::displayed() makes them; the
// share of their pixels that differ visibly goes out. Pure. OpenImageIO has this metric too, but its
// compare_Yee() of version 2.4 sees colours alone: a picture twice as bright passes.

// White is taken as 100 cd/m², and the picture as 45 degrees wide, as on a desktop screen that it fills.
// Errors name `subject`: sizes differ.
Result<double> visibleShare(const spec::Rgba8Image& picture, const spec::Rgba8Image& reference,
                            const std::string& subject);

}  // namespace lambent::baker
