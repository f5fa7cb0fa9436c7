// A digest of everything in a scene that a bake reads, and what of it also counts in keys of the cache.
#pragma once

#include <cstdint>

#include "baker/cache/key.hpp"
#include "baker/import/scene.hpp"

namespace lambent::baker {

template <>
inline constexpr bool kPlainBytes<BrdfMeasurement> = sizeof(BrdfMeasurement) == 7 * sizeof(float);

void addMesh(const bundle::MeshData& mesh, KeyMaker& key);

std::uint64_t sceneDigest(const Scene& scene);

}  // namespace lambent::baker
