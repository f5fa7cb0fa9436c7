// Measures how much of a picture an eye sees as wrong, by the metric of Yee and Newman (2004): an error is
// visible if it exceeds what the eye can tell at the luminance that it is adapted to, raised where fine
// contrasts are hard to see or mask it. Pictures for a screen come in, as spec::displayed() makes them; the
// share of their pixels that differ visibly goes out. Pure. OpenImageIO has this metric too, but its
// compare_Yee() of version 2.4 sees colours alone: a picture twice as bright passes.
#pragma once

#include <string>

#include "runtime/base/result.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::baker {

// White is taken as 100 cd/m², and the picture as 45 degrees wide, as on a desktop screen that it fills.
// Errors name `subject`: sizes differ.
Result<double> visibleShare(const spec::Rgba8Image& picture, const spec::Rgba8Image& reference,
                            const std::string& subject);

}  // namespace lambent::baker
