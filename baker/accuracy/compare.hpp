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

}  // namespace lambent::baker
