// How far a picture lies from a reference, in linear radiance, over the pixels that both cover (alpha of at
// least spec::kLeastCoverage in every picture; no sky, no tone map). What a cloud or a blended surface lets
// through of the sky counts with it: it is the same in all pictures, or should be. With a second reference
// that was made independently (another seed), the noise of the references cancels: errors are products of two
// differences whose noise is not correlated. Where all pictures have depths, pixels in which they show
// different surfaces are told apart by these, whatever their colours: rays through the cracks of a mesh, or
// an outline that moved by the rounding of positions.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "runtime/base/result.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::baker {

struct PictureError {
  std::uint64_t pixels = 0;  // covered in all pictures
  // Covered in one, sky in another (less than half of kLeastCoverage): more than the odd pixel of an outline
  // says that scene, camera or size differ.
  std::uint64_t pixels_apart = 0;
  double relative_rms =
      0.0;  // sqrt( sum (X-A)² / sum A² ); with B: sqrt( sum (X-A)(X-B) / sum AB ), 0 if negative
  // Standard error of relative_rms²: what is left of two references' noise. relative_rms is a figure only
  // where its square is well above. 0 with one reference, whose noise cannot be told from error.
  double relative_square_error = 0.0;
  std::array<double, 3> bias{};  // per channel: sum (X-A) / sum A; A the mean of both references
  // Over pixels, of the root mean square difference of the channels, relative to that of the reference over
  // the picture. Noise of the references is in these.
  double median = 0.0, percentile_95 = 0.0, percentile_99 = 0.0, largest = 0.0;
  // Of `pixels`: depths of two pictures differ by more than kSameDepth, or only one of them has a depth. None
  // where a picture has no depths.
  std::optional<std::uint64_t> pixels_of_other_surfaces = {};
  // relative_rms over the other pixels, by their own energy; none also where these are none or black.
  std::optional<double> same_surface_rms = {};
};

// Relative to the smaller of two depths. Above what rounded positions and the steps of the runtime's depth
// buffer (1e-4 at worst, runtime/spec/camera.cpp) make of one surface unless it is seen edge on, and below
// how far most things stand before others.
inline constexpr float kSameDepth = 1.0f / 512.0f;

// reference2: null where there is none. Errors name `subject`: sizes that differ, values that are not finite,
// no pixel that all cover, a black reference.
Result<PictureError> comparePictures(const spec::RgbaImage& picture, const spec::RgbaImage& reference,
                                     const spec::RgbaImage* reference2, const std::string& subject);

}  // namespace lambent::baker
