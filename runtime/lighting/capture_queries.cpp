#include "runtime/lighting/capture_queries.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "runtime/sh/basis.hpp"

namespace lambent::lighting::capture {

namespace {

bool usable(const glm::dvec3& direction) {
  const double squared = glm::dot(direction, direction);
  return std::isfinite(squared) && squared > 0;
}

}  // namespace

std::vector<glm::vec3> discDirections(const LightQuery& query) {
  const glm::dvec3 given(query.direction);
  if (!usable(given)) return {};
  const glm::dvec3 axis = glm::normalize(given);
  const double radius = static_cast<double>(query.angular_radius_rad);
  if (!(radius > 0)) return {glm::vec3(axis)};
  const double height = 1 - std::cos(std::min(radius, std::numbers::pi));  // of the spherical cap
  // This frame has no branches at the poles (Duff et al. 2017).
  const double sign = std::copysign(1.0, axis.z), a = -1 / (sign + axis.z), b = axis.x * axis.y * a;
  const glm::dvec3 u(1 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x),
      v(b, sign + axis.y * axis.y * a, -axis.y);
  std::vector<glm::vec3> directions;
  directions.reserve(kLookupsPerWord);
  for (std::uint32_t k = 0; k < kLookupsPerWord; ++k) {
    // Vogel's spiral takes equal steps of solid angle outwards and turns by the golden angle.
    const double down = height * (k + 0.5) / kLookupsPerWord;
    const double sine = std::sqrt(std::max(0.0, down * (2 - down)));
    const double turn = k * std::numbers::pi * (3 - std::sqrt(5.0));
    directions.emplace_back((1 - down) * axis + sine * (std::cos(turn) * u + std::sin(turn) * v));
  }
  return directions;
}

void appendLookups(std::uint32_t size, std::uint32_t subsamples, const PlannedPoint& planned,
                   std::span<const Tile> tiles, const CapturePoint& point, std::vector<Lookup>& lookups) {
  for (const LightQuery& query : point.queries) {
    const std::size_t first = lookups.size();
    lookups.resize(first + kLookupsPerWord);
    std::size_t k = first;
    for (const glm::vec3& direction : discDirections(query)) {
      Lookup& lookup = lookups[k++];
      const std::uint32_t face = faceOf(direction);
      const glm::dvec3 at = faceFromWorld(face) * glm::dvec3(direction);
      const auto pixelOf = [&](double s) {
        const double pixels = static_cast<double>(size) * subsamples;
        return static_cast<std::uint32_t>(std::clamp((s + 1) / 2 * pixels, 0.0, pixels - 1));
      };
      const std::uint32_t x = pixelOf(at.x / at.z), y = pixelOf(at.y / at.z);
      for (const Tile& tile : tiles.subspan(planned.first_tile, planned.tile_count)) {
        const TexelRect& r = tile.texels;
        if (tile.face != face || x < r.x0 * subsamples || x >= r.x1 * subsamples || y < r.y0 * subsamples ||
            y >= r.y1 * subsamples)
          continue;
        lookup.pixel = (tile.x + x - r.x0 * subsamples) | (tile.y + y - r.y0 * subsamples) << 16;
        const double w = static_cast<double>(query.distance_m) * at.z;
        const double depth =
            w > 0 ? std::min(static_cast<double>(planned.near_m) / w * (1 + kSameDistance), 2.0) : 0.0;
        lookup.depth_bits = std::bit_cast<std::uint32_t>(static_cast<float>(depth));
        break;
      }
    }
  }
}

float visibleShare(const LightQuery& query, std::uint32_t hidden_bits, sh::LightVector& light) {
  if (hidden_bits == 0) return 1.0f;
  const std::vector<glm::vec3> directions = discDirections(query);
  if (directions.empty()) return 1.0f;
  const auto hidden = static_cast<std::size_t>(std::popcount(hidden_bits));
  if (hidden >= directions.size()) return 0.0f;
  const double share = 1 - static_cast<double>(hidden) / static_cast<double>(directions.size());
  if (query.radiance == glm::vec3(0.0f)) return static_cast<float>(share);
  std::array<double, sh::kMaxCoefficients> y, of_visible{}, of_all{};
  const auto count = static_cast<std::size_t>(sh::coefficientCount(light.order));
  for (std::size_t k = 0; k < directions.size(); ++k) {
    sh::evaluate(light.order, glm::dvec3(directions[k]), y);
    for (std::size_t i = 0; i < count; ++i) {
      of_all[i] += y[i];
      if ((hidden_bits >> k & 1u) == 0) of_visible[i] += y[i];
    }
  }
  const double radius = std::min(static_cast<double>(query.angular_radius_rad), std::numbers::pi);
  const double weight =
      2 * std::numbers::pi * (1 - std::cos(radius)) / static_cast<double>(directions.size());
  for (std::size_t i = 0; i < count; ++i)
    light.c[i] += glm::vec3(glm::dvec3(query.radiance) * (weight * (of_visible[i] - share * of_all[i])));
  return static_cast<float>(share);
}

}  // namespace lambent::lighting::capture
