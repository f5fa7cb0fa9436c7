// Glossy samples inside the faces over which direct light changes, beside those of the vertices: what arrives
// there, directly and in every pass of bounces, is what the values at vertices are fitted to
// (trace/vertex_fit.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "baker/effects/glossy/glossy_direct.hpp"
#include "baker/trace/vertex_fit.hpp"
#include "baker/transport/face_points.hpp"

namespace lambent::baker {

class GlossyInsideFaces {
 public:
  // One sample in each triangle, all of glossy draws. Rays and orders are those of `vertices`, which outlives
  // this.
  GlossyInsideFaces(const GlossyPass& vertices, std::span<const std::uint32_t> triangles);
  GlossyInsideFaces(const GlossyInsideFaces&) = delete;  // its passes refer to its points
  GlossyInsideFaces& operator=(const GlossyInsideFaces&) = delete;

  // Direct light at the points, before anything is fitted; what was met stays here. As bakeGlossyDirect.
  std::optional<GlossyDirect> look(std::size_t hit_memory, const BakeContext& context);

  const GlossyPass& pass() const { return pass_; }  // its samples are the points, from 0 on
  const SampleVisibilities& looks() const { return looks_; }
  const HitStore& hits() const { return hits_; }
  std::size_t size() const { return pass_.size(); }

  // Changes values at vertices by what interpolation between them is off at the points, both as many for each
  // sample; there may be none. False if stopped.
  bool fit(std::span<const float> at_points, std::span<float> at_vertices, const std::stop_token& stop) const;

 private:
  const GlossyPass& vertices_;
  FacePoints points_;
  DirectPass diffuse_;
  GlossyPass pass_;
  SampleVisibilities looks_;
  HitStore hits_;
  std::optional<VertexFit> fit_;
};

}  // namespace lambent::baker
