#include "runtime/lighting/probe_places.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vector_relational.hpp>

namespace lambent::lighting {

namespace {

constexpr std::size_t kRays = 192;
constexpr int kApart = 3;              // voxels between candidates
constexpr float kLeastHidden = 0.75f;  // a statue on a floor hides a little more than half of the directions
constexpr float kMostBacks = 0.4f;  // of the directions; from inside a body all surfaces are seen from behind
constexpr float kLeastRoom = 0.1f;  // share of the box that is air in rooms; a niche under a statue has less
constexpr float kLeastFacing = 0.3f;       // component of a normal
constexpr float kWideAir = 4.0f;           // voxels of air around a candidate; more is no better
constexpr float kSeenBefore = 0.25f;       // what a voxel still counts if an earlier probe sees it
constexpr float kLeastGainOfProbe = 0.1f;  // of the first probe's; others see too little that is new

struct Candidate {
  glm::vec3 place{0.0f};            // in voxels
  float air = 0.0f;                 // 0..1
  std::vector<std::size_t> voxels;  // what it sees, each once
};

std::array<glm::vec3, kRays> evenDirections() {
  std::array<glm::vec3, kRays> directions;
  for (std::size_t i = 0; i < kRays; ++i) {
    const float z = 1.0f - (2.0f * static_cast<float>(i) + 1.0f) / static_cast<float>(kRays);
    const float phi = std::numbers::pi_v<float> * (3.0f - std::sqrt(5.0f)) * static_cast<float>(i);
    directions[i] = glm::vec3(std::sqrt(1.0f - z * z) * glm::vec2(std::cos(phi), std::sin(phi)), z);
  }
  return directions;
}

struct Hit {
  std::size_t voxel = 0;
  bool back = false;
  float distance = 0.0f;  // voxels
};

// Returns whether a surface that faces these sides may face a ray. Axes along which the ray hardly goes do
// not tell.
bool facesAgainst(std::uint32_t sides, const glm::vec3& direction) {
  const glm::vec3 along = glm::abs(direction);
  const float most = std::max({along.x, along.y, along.z});
  for (int axis = 0; axis < 3; ++axis)
    if (along[axis] > 0.5f * most && (sides >> (direction[axis] > 0.0f ? axis + 4 : axis) & 1u) != 0)
      return true;
  return false;
}

std::optional<Hit> firstOnRay(const SurfaceVoxels& voxels, const glm::vec3& place,
                              const glm::vec3& direction) {
  constexpr float kStep = 0.5f;
  for (float distance = kStep;; distance += kStep) {
    const glm::ivec3 voxel(glm::floor(place + distance * direction));
    if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(voxel, voxels.count)))
      return std::nullopt;
    const std::uint32_t sides = voxels.at(voxel);
    if (sides != 0) return Hit{voxels.placeOf(voxel), !facesAgainst(sides, direction), distance};
  }
}

std::optional<Candidate> lookAround(const SurfaceVoxels& voxels, const glm::ivec3& voxel,
                                    std::span<const glm::vec3> directions) {
  if (voxels.at(voxel) != 0) return std::nullopt;
  Candidate candidate{.place = glm::vec3(voxel) + 0.5f, .air = kWideAir, .voxels = {}};
  std::size_t hits = 0, backs = 0;
  for (const glm::vec3& direction : directions) {
    const std::optional<Hit> hit = firstOnRay(voxels, candidate.place, direction);
    if (!hit) continue;
    ++hits;
    backs += hit->back ? 1 : 0;
    candidate.air = std::min(candidate.air, hit->distance);
    candidate.voxels.push_back(hit->voxel);
  }
  const auto all = static_cast<float>(directions.size());
  if (static_cast<float>(hits) < kLeastHidden * all || static_cast<float>(backs) > kMostBacks * all)
    return std::nullopt;
  candidate.air /= kWideAir;
  std::ranges::sort(candidate.voxels);
  candidate.voxels.erase(std::ranges::unique(candidate.voxels).begin(), candidate.voxels.end());
  return candidate;
}

}  // namespace

SurfaceVoxels SurfaceVoxels::over(const glm::vec3& box_min, const glm::vec3& box_max) {
  const glm::vec3 size = box_max - box_min;
  SurfaceVoxels voxels;
  voxels.edge_m = std::max({size.x, size.y, size.z, 1e-8f}) / static_cast<float>(kLongest);
  voxels.origin = box_min - voxels.edge_m;
  voxels.count = glm::ivec3(glm::ceil(size / voxels.edge_m)) + 2;
  voxels.words.assign(voxels.placeOf(voxels.count - 1) / 4 + 1, 0);
  return voxels;
}

void SurfaceVoxels::add(const glm::ivec3& voxel, const glm::vec3& normal) {
  const std::size_t place = placeOf(voxel);
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(normal[axis]) > kLeastFacing)
      words[place / 4] |=
          1u << (8 * (place % 4) + static_cast<std::size_t>(normal[axis] > 0.0f ? axis : axis + 4));
}

std::vector<glm::vec3> chooseProbePlaces(const SurfaceVoxels& voxels, std::size_t most) {
  const std::array<glm::vec3, kRays> directions = evenDirections();
  std::vector<Candidate> candidates;
  std::size_t tried = 0;
  // Voxels that many points of the room see are worth more.
  std::vector<float> worth(4 * voxels.words.size(), 0.0f);
  for (int z = 1; z < voxels.count.z; z += kApart)
    for (int y = 1; y < voxels.count.y; y += kApart)
      for (int x = 1; x < voxels.count.x; x += kApart) {
        ++tried;
        std::optional<Candidate> candidate = lookAround(voxels, {x, y, z}, directions);
        if (!candidate) continue;
        for (const std::size_t voxel : candidate->voxels) worth[voxel] += 1.0f;
        candidates.push_back(std::move(*candidate));
      }
  if (static_cast<float>(candidates.size()) < kLeastRoom * static_cast<float>(tried)) return {};
  std::vector<glm::vec3> chosen;
  float first_gain = 0.0f;
  while (chosen.size() < most) {
    const Candidate* best = nullptr;
    float best_gain = 0.0f;
    for (const Candidate& candidate : candidates) {
      float gain = 0.0f;
      for (const std::size_t voxel : candidate.voxels) gain += worth[voxel];
      gain *= candidate.air;
      if (gain > best_gain) {
        best = &candidate;
        best_gain = gain;
      }
    }
    if (best == nullptr || best_gain < kLeastGainOfProbe * first_gain) break;
    if (chosen.empty()) first_gain = best_gain;
    chosen.push_back(voxels.origin + voxels.edge_m * best->place);
    for (const std::size_t voxel : best->voxels) worth[voxel] *= kSeenBefore;
  }
  return chosen;
}

}  // namespace lambent::lighting
