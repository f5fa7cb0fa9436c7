#include "baker/import/texture_transfer.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "baker/import/check.hpp"

namespace lambent::baker {

namespace {

constexpr const char* kKey = "texture_transfer";

// Coordinates may leave the unit square by as much as coding moves them.
constexpr float kSlack = 1e-4f;
// A point lies in a triangle if the shares of all corners are greater; so no point of a common edge lies in
// two triangles.
constexpr double kInside = 1e-6;

double crossOf(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

}  // namespace

std::uint32_t textureTransferOf(const nlohmann::json& mesh, const nlohmann::json& primitive,
                                const std::string& name) {
  for (const nlohmann::json* owner : {&primitive, &mesh}) {
    const nlohmann::json& value = memberOf(*owner, {"extras", "lambent", kKey});
    if (value.is_null()) continue;
    const std::uint64_t texels = value.is_number_unsigned() ? value.get<std::uint64_t>() : 0;
    if (texels < kLeastTexels || texels > kMostTexels || !std::has_single_bit(texels))
      throw Error{{},
                  fmt::format("{}: extras: lambent: {} is {}, not a power of two from {} to {}", name, kKey,
                              value.dump(), kLeastTexels, kMostTexels),
                  "correct it, or leave it out for transfer at vertices"};
    return static_cast<std::uint32_t>(texels);
  }
  return 0;
}

std::string faultOfCharts(const bundle::MeshData& mesh, std::uint32_t set, std::uint32_t texels) {
  const std::vector<glm::vec2>& coordinates = set == 1 ? mesh.texcoords1 : mesh.texcoords0;
  for (const glm::vec2& at : coordinates)
    if (!(at.x >= -kSlack && at.y >= -kSlack && at.x <= 1.0f + kSlack && at.y <= 1.0f + kSlack))
      return fmt::format("leaves the texture at ({}, {})", at.x, at.y);
  // Points are spread evenly over the unit square. No two triangles may cover the same one.
  const std::size_t points = 2 * std::size_t{texels};
  const auto side = static_cast<double>(points);
  const auto clamped = [&](double at) { return static_cast<std::size_t>(std::clamp(at, 0.0, side)); };
  std::vector<bool> covered(points * points, false);
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    std::array<glm::dvec2, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) corners[c] = glm::dvec2(coordinates[mesh.indices[i + c]]);
    const double area = crossOf(corners[1] - corners[0], corners[2] - corners[0]);
    if (area == 0.0) return fmt::format("has no area in triangle {}", i / 3);
    const glm::dvec2 low = glm::min(corners[0], glm::min(corners[1], corners[2])) * side,
                     high = glm::max(corners[0], glm::max(corners[1], corners[2])) * side;
    for (std::size_t y = clamped(low.y); y < clamped(std::ceil(high.y)); ++y)
      for (std::size_t x = clamped(low.x); x < clamped(std::ceil(high.x)); ++x) {
        const glm::dvec2 at = (glm::dvec2(static_cast<double>(x), static_cast<double>(y)) + 0.5) / side;
        const double b = crossOf(at - corners[0], corners[2] - corners[0]) / area,
                     c = crossOf(corners[1] - corners[0], at - corners[0]) / area;
        if (!(b > kInside && c > kInside && 1.0 - b - c > kInside)) continue;
        if (covered[y * points + x])
          return fmt::format("overlaps: triangle {} lies on others in the texture", i / 3);
        covered[y * points + x] = true;
      }
  }
  return {};
}

void giveTexels(std::uint32_t texels, const std::string& name, ScenePrimitive& primitive,
                std::vector<std::string>& warnings) {
  const auto keepVertices = [&](const std::string& why) {
    warnings.push_back(
        fmt::format("{}: {}, so {} is left out and it keeps transfer at vertices; unwrap it "
                    "without overlaps into TEXCOORD_1",
                    name, why, kKey));
  };
  const std::uint32_t set = primitive.mesh.texcoords1.empty() ? 0 : 1;
  if (set == 0 && primitive.mesh.texcoords0.empty()) return keepVertices("has no texture coordinates");
  if (const std::string fault = faultOfCharts(primitive.mesh, set, texels); !fault.empty())
    return keepVertices(fmt::format("TEXCOORD_{} {}", set, fault));
  primitive.texels = texels;
  primitive.texel_set = set;
}

}  // namespace lambent::baker
