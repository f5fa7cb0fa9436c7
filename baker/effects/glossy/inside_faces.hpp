// Holds glossy samples inside the faces over which direct light changes. The values at vertices are fitted to
// what arrives there, directly and in every pass of bounces (trace/vertex_fit.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "baker/effects/glossy/traced_points.hpp"
#include "baker/trace/vertex_fit.hpp"
#include "baker/transport/face_points.hpp"

namespace lambent::baker {

class GlossyInsideFaces {
 public:
  // Places one sample in each triangle; all triangles must belong to glossy draws. Rays and orders are those
  // of `vertices`, which must outlive this.
  GlossyInsideFaces(const GlossyPass& vertices, std::span<const std::uint32_t> triangles);

  // Traces direct light at the points, before anything is fitted, and returns it; the hits stay here.
  // Returns nothing if stopped.
  std::optional<GlossyField> look(std::size_t hit_memory, const BakeContext& context);

  const TracedGlossyPoints& points() const { return points_; }
  TracedGlossyPoints& points() { return points_; }

  // Corrects values at vertices by how far interpolation between them is off at the points. Both have the
  // same number of values for each sample, possibly none. Returns false if stopped.
  bool fit(std::span<const float> at_points, std::span<float> at_vertices, const std::stop_token& stop) const;

 private:
  const GlossyPass& vertices_;
  TracedGlossyPoints points_;
  std::optional<VertexFit> fit_;
};

}  // namespace lambent::baker
