// The first answer to a scene: a bundle without transfer, made without a ray, in about the time that it takes
// to encode the meshes. The runtime shows it lit without shadows and bounces: A_l y(n) at vertices without a
// sample, and all of the light in volumes, which have one sample that sees everything. Glossy surfaces are
// shown as Lambert's: their tables of BRDFs take seconds to make. It is an ordinary bundle of the format;
// only its settings say "transfer": "none", so that no bake takes it for up to date. Lamps of the scene shine
// in it as lights from outside.
#pragma once

#include <filesystem>

#include "baker/bake/bake.hpp"

namespace lambent::baker {

// Of the options the orders, the effects and the longest edge count. Errors: as bake().
Result<BakeReport> bakeUnshadowed(const Scene& scene, const BakeOptions& options,
                                  const std::filesystem::path& output, const BakeContext& context);

}  // namespace lambent::baker
