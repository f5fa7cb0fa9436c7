// Pass 0 of the diffuse effect: direct, shadowed transfer (Sloan 2002, the first pass of section 4):
//   t_p,i = (1/pi) ∫ V_p(s) max(n·s, 0) y_i(s) ds.
// Rays are cosine-distributed about the shading normal; the geometric normals of the faces around a sample
// decide what lies below its horizon.
#pragma once

#include <optional>
#include <stop_token>

#include "baker/effects/diffuse/transfer_field.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/samples.hpp"
#include "baker/work/progress.hpp"

namespace lambent::baker {

struct DirectSettings {
  int order = 5;           // 1..8
  std::size_t rays = 512;  // per sample over its hemisphere, at least 128
};

// Nothing if stopped. The result does not depend on the number of threads. Progress counts samples.
std::optional<TransferField> bakeDirect(const GroupGeometry& geometry, const SampleSet& samples,
                                        const RayScene& rays, const DirectSettings& settings,
                                        Progress& progress, std::stop_token stop);

}  // namespace lambent::baker
