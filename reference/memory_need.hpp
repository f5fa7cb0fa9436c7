// Says beforehand how much memory a picture needs, so that one that is too large is refused before hours of
// tracing, and not ended by the system in the middle. Bytes are those of the whole program.
#pragma once

#include <cstdint>

#include "baker/import/scene.hpp"
#include "reference/options.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker::reference {

// Returns the bytes of the samples' sums, and of the picture or a checkpoint beside them.
std::uint64_t bytesOfPicture(const spec::Size& size);
// Returns about the bytes of the scene as it is traced: surfaces and the ray hierarchy, without textures.
std::uint64_t bytesOfTracing(const Scene& scene);

// Fails if `more` bytes beside what the program has now come to more than the options allow. `what` needs
// them, as "a picture of 64 x 64".
Result<void> checkMemory(const Options& options, std::uint64_t more, const std::string& what);

}  // namespace lambent::baker::reference
