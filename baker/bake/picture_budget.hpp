// Divides a bound on the error of pictures (BakeOptions::picture_bound) among its three causes: noise of
// rays, interpolation between vertices, and codes. Squares of the three add up. Rays and refinement come from
// the bound alone; codes come last and get what the others left. All functions are pure.
#pragma once

#include <cstdint>
#include <optional>

#include "runtime/bundle/description.hpp"

namespace lambent::baker {

// The parts of the bound that codes, and codes of glossy surfaces, get before more is known. Codes take few:
// half their error costs a bit a weight, half the noise four times the rays.
inline constexpr float kCodesShare = 0.35f, kGlossyCodesShare = 0.7f;

// Returns the rays of a sample, and the bound on refinement, with which most pictures meet theirs.
std::uint32_t raysFor(float picture_bound);
float refineBoundFor(float picture_bound);

// Returns the bound on codes with which pictures meet theirs, if codes err at eyes as they do everywhere.
float codesBound(const bundle::PictureError& without_codes, float picture_bound);
// Returns that on codes of glossy surfaces beside it: theirs are dearer for the same error.
float glossyCodesBound(float codes_bound);
// Returns a better one after codes with `bound` showed this, or nothing if they are as they should be.
std::optional<float> nextCodesBound(float bound, const bundle::PictureError& shown, float picture_bound);

}  // namespace lambent::baker
