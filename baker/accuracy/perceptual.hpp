// Measures how much of a picture an eye sees as wrong, by the visible difference predictor of Yee and Newman
// (2004), which knows how contrast sensitivity falls with frequency, adaptation and masking. Pictures for a
// screen come in, as spec::displayed() makes them; the share of their pixels that differ visibly goes out.
// Calls are safe from any thread.
#pragma once

#include <string>

#include "runtime/base/result.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::baker {

// White is taken as 100 cd/m², and the picture as filling 45 degrees of the field of view: a picture as wide
// as a desktop screen. Errors name `subject`: sizes differ.
Result<double> visibleShare(const spec::Rgba8Image& picture, const spec::Rgba8Image& reference,
                            const std::string& subject);

}  // namespace lambent::baker
