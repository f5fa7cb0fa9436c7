// Computes a hash of everything that decides a picture's bytes: scene, light, view, options and program. A
// checkpoint with the same digest can be resumed.
#pragma once

#include <cstdint>

#include "baker/import/scene.hpp"
#include "reference/options.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/distant_lights.hpp"

namespace lambent::baker::reference {

std::uint64_t digestOf(const Scene& scene, const spec::DistantLights& lights,
                       const std::vector<spec::LocalLight>& shapes, const spec::View& view,
                       const Options& options);

}  // namespace lambent::baker::reference
