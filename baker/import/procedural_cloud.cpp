#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/vec4.hpp>

#include "baker/import/density_file.hpp"

namespace lambent::baker {
namespace {

constexpr glm::uvec3 kSize(96, 64, 96);
constexpr float kVoxel = 1.0f / 64.0f;
constexpr float kBase = -0.27f;  // height of the flat underside
constexpr float kMargin = 3.0f * kVoxel;

// This is the hash "lowbias32" by Chris Wellons.
std::uint32_t scrambled(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

class Dice {
 public:
  explicit Dice(std::uint32_t seed) : seed_(scrambled(seed)) {}
  float between(float low, float high) {
    return low + (high - low) * static_cast<float>(scrambled(seed_ + ++drawn_ * 0x9e3779b9u) >> 8) * 0x1p-24f;
  }

 private:
  std::uint32_t seed_, drawn_ = 0;
};

// Gives a smooth number from -1 to 1 at every point, from gradients on a lattice (Perlin 2002).
class Noise {
 public:
  explicit Noise(std::uint32_t seed) : seed_(seed) {}

  float at(const glm::vec3& p) const {
    const glm::vec3 base = glm::floor(p), f = p - base;
    const glm::vec3 s = f * f * f * (f * (f * 6.0f - 15.0f) + 10.0f);
    const glm::ivec3 cell(base);
    float sum = 0.0f;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 offset(corner & 1, corner >> 1 & 1, corner >> 2);
      const glm::vec3 w = glm::mix(1.0f - s, s, glm::vec3(offset));
      sum += w.x * w.y * w.z * glm::dot(gradient(cell + offset), f - glm::vec3(offset));
    }
    return sum;
  }

  // Returns rounded heaps with sharp valleys between them, 0 to 1.
  float billows(glm::vec3 p) const {
    float sum = 0.0f, height = 1.0f, all = 0.0f;
    for (int octave = 0; octave < 4; ++octave) {
      sum += height * std::min(1.0f, 1.6f * std::abs(at(p)));
      all += height;
      height *= 0.55f;
      p = 2.03f * p + glm::vec3(17.3f, 5.1f, 11.7f);
    }
    return sum / all;
  }

 private:
  glm::vec3 gradient(const glm::ivec3& cell) const {
    const std::uint32_t h =
        scrambled(seed_ ^ scrambled(static_cast<std::uint32_t>(cell.x) ^
                                    scrambled(static_cast<std::uint32_t>(cell.y) ^
                                              scrambled(static_cast<std::uint32_t>(cell.z)))));
    const float z = static_cast<float>(h & 0xffffu) / 32767.5f - 1.0f;
    const float phi = static_cast<float>(h >> 16) * (2.0f * std::numbers::pi_v<float> / 65536.0f);
    const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
  }

  std::uint32_t seed_;
};

// Returns centres and radii: a few large puffs side by side on the base, the tallest in the middle, each with
// smaller ones on its upper half, and smaller ones on those.
std::vector<glm::vec4> puffsOf(std::uint32_t seed) {
  Dice dice(seed);
  std::vector<glm::vec4> puffs;
  constexpr int kTrunks = 7;
  for (int i = 0; i < kTrunks; ++i) {
    const float along = static_cast<float>(i) / (kTrunks - 1) * 2.0f - 1.0f;
    const float tall = 1.0f - along * along;
    const float radius = 0.16f + 0.13f * tall + dice.between(-0.02f, 0.02f);
    puffs.emplace_back(0.48f * along + dice.between(-0.04f, 0.04f), kBase + 0.2f * radius + 0.06f * tall,
                       dice.between(-0.2f, 0.2f) * (0.5f + tall), radius);
  }
  std::size_t begin = 0;
  for (const auto& [children, share] : {std::pair{7, 0.55f}, std::pair{6, 0.5f}}) {
    const std::size_t end = puffs.size();
    for (std::size_t parent = begin; parent < end; ++parent)
      for (int child = 0; child < children; ++child) {
        const glm::vec4 on = puffs[parent];
        const float up = dice.between(-0.1f, 1.0f),
                    turn = dice.between(0.0f, 2.0f * std::numbers::pi_v<float>);
        const float flat = std::sqrt(std::max(0.0f, 1.0f - up * up));
        const glm::vec3 away(flat * std::cos(turn), up, flat * std::sin(turn));
        puffs.emplace_back(glm::vec3(on) + 0.85f * on.w * away, on.w * share * dice.between(0.75f, 1.1f));
      }
    begin = end;
  }
  // No puff reaches into the margin.
  const glm::vec3 half = 0.5f * kVoxel * glm::vec3(kSize) - kMargin;
  std::erase_if(puffs, [&](const glm::vec4& puff) {
    return glm::any(glm::greaterThan(glm::abs(glm::vec3(puff)) + puff.w, half));
  });
  return puffs;
}

// Returns the distance to the union of the puffs, negative inside, rounded where they meet.
float distanceTo(const std::vector<glm::vec4>& puffs, const glm::vec3& p) {
  constexpr float kBlend = 0.035f;
  float nearest = 1.0f;
  for (const glm::vec4& puff : puffs) {
    const float d = glm::distance(p, glm::vec3(puff)) - puff.w;
    if (d > nearest + kBlend) continue;
    const float h = std::max(kBlend - std::abs(d - nearest), 0.0f) / kBlend;
    nearest = std::min(d, nearest) - 0.25f * kBlend * h * h;
  }
  return nearest;
}

}  // namespace

DensityGrid proceduralCloud(std::uint32_t seed) {
  DensityGrid grid;
  grid.name = "density";
  grid.size = kSize;
  const glm::vec3 half = 0.5f * kVoxel * glm::vec3(kSize);
  grid.file_from_grid =
      glm::scale(glm::translate(glm::dmat4(1.0), -glm::dvec3(half)), glm::dvec3(double{kVoxel}));
  const std::vector<glm::vec4> puffs = puffsOf(seed);
  const Noise noise(scrambled(seed + 1));
  grid.values.reserve(std::size_t{kSize.x} * kSize.y * kSize.z);
  for (std::uint32_t z = 0; z < kSize.z; ++z)
    for (std::uint32_t y = 0; y < kSize.y; ++y)
      for (std::uint32_t x = 0; x < kSize.x; ++x) {
        const glm::vec3 p = (glm::vec3(x, y, z) + 0.5f) * kVoxel - half;
        const float outside = distanceTo(puffs, p);
        float density = 0.0f;
        if (outside < 0.0f) {
          // Billows remove density from the outside inwards; the base is flat but not straight.
          const float depth = -outside - 0.055f * (1.0f - noise.billows(7.0f * p));
          const float base = kBase + 0.045f * noise.at(4.0f * p) + 0.015f * noise.at(13.0f * p);
          density = glm::smoothstep(0.0f, 0.045f, depth) * glm::smoothstep(base - 0.05f, base + 0.08f, p.y);
        }
        grid.values.push_back(density);
      }
  return grid;
}

}  // namespace lambent::baker
