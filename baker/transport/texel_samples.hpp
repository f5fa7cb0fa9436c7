// Places samples at the texels of a draw whose author asks for it (baker/import/texture_transfer.hpp). A
// texel has a sample if the filter of a point on the surface may read it: its sample stands at its centre,
// or, on the border of a chart, at the nearest point of the chart, a little inside.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "baker/transport/samples.hpp"

namespace lambent::baker {

struct TexelPoint {
  std::uint32_t texel = 0;  // x + side y
  std::uint32_t triangle = 0;
  glm::vec3 shares{0.0f};  // of the triangle's corners
  float size_m = 0.0f;     // side of the texel on the surface
};

// Returns the points of a draw's texels that need samples, by rising texel.
std::vector<TexelPoint> texelPoints(const GroupGeometry& geometry, const DrawGeometry& draw);

// Returns the sample that every texel of the map shows: its own, or that of the nearest texel that has one,
// so that filters and mip levels find no gaps.
std::vector<std::uint32_t> dilated(const TexelMap& map);

// Returns the sample of the texel in which a point of one of the map's triangles lies, or kNoSample.
std::uint32_t sampleOfTexel(const GroupGeometry& geometry, const TexelMap& map, std::uint32_t triangle,
                            const glm::vec3& shares);

struct SampleShare {
  std::uint32_t sample = 0;
  float share = 0.0f;
};
// Returns the samples that a picture shows at a point of a triangle, with shares that sum to 1: those of the
// three corners, or of the four texels around it.
std::array<SampleShare, 4> shownSamples(const GroupGeometry& geometry, const SampleSet& samples,
                                        std::uint32_t triangle, const glm::vec3& shares);

// Returns the pairs of samples of neighbouring texels of a chart.
std::vector<std::pair<std::uint32_t, std::uint32_t>> texelEdges(const GroupGeometry& geometry,
                                                                const TexelMap& map);

}  // namespace lambent::baker
