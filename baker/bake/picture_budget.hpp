// Divides a bound on the error of pictures (BakeOptions::picture_bound) among its three causes: noise of
// rays, interpolation between vertices, and codes. Squares of the three add up. Before anything is known of a
// scene, rays and refinement come from the bound alone, so few that most bakes begin too cheap and not too
// dear; what a try then shows says what the next one needs. Codes come last and get what the others left. All
// functions are pure.
#pragma once

#include <cstdint>
#include <optional>

#include "runtime/bundle/description.hpp"

namespace lambent::baker {

// The parts of the bound that codes, and codes of glossy surfaces, get before more is known. Codes take few:
// half their error costs a bit a weight, half the noise four times the rays.
inline constexpr float kCodesShare = 0.35f, kGlossyCodesShare = 0.7f;

inline constexpr int kMostTries = 4;

std::uint32_t firstRays(float picture_bound);
float firstRefineBound(float picture_bound);

struct PictureSettings {
  std::uint32_t rays = 0;
  float refine_bound = 0.0f;
  bool operator==(const PictureSettings&) const = default;
};

// A PictureTry is a bake of all but codes: what it was made with and what it showed.
struct PictureTry {
  PictureSettings made_with;
  double refined_to = 0.0;     // refinement's own figure; nothing is split for a bound above it
  bundle::PictureError shown;  // codes are 0
  // Rays were asked for, or refinement was or has reached its limit of vertices: they stay as they are.
  bool keeps_rays = false, keeps_refinement = false;
};

// Returns whether what a try shows leaves enough of the bound to codes.
bool leavesEnough(const bundle::PictureError& shown, float picture_bound);
// Returns the settings of the next try, or nothing if none is worth it.
std::optional<PictureSettings> nextTry(const PictureTry& tried, float picture_bound);

// Returns the bound on codes with which pictures meet theirs, if codes err at eyes as they do everywhere.
float codesBound(const bundle::PictureError& without_codes, float picture_bound);
// Returns that on codes of glossy surfaces beside it: theirs are dearer for the same error.
float glossyCodesBound(float codes_bound);
// Returns a better one after codes with `bound` showed this, or nothing if they are as they should be.
std::optional<float> nextCodesBound(float bound, const bundle::PictureError& shown, float picture_bound);

}  // namespace lambent::baker
