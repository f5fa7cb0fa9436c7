// Generates the reference's random numbers: padded Owen-scrambled Sobol points, two dimensions at a time.
// Every number is a function of (seed, pixel, replica, dimension, index) alone, so pictures do not depend on
// threads or interruptions. The points of a pixel are well stratified in every power-of-two prefix; pixels
// and dimensions are independent of each other. Scrambling is hash-based: Burley, "Practical Hash-based Owen
// Scrambling", JCGT 9(4), 2020, with Vegdahl's constants (psychopath.io, "Building a Better LK Hash", 2021).
// Tracking through media uses separate streams of independent numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker::reference {

// Hashes 32 bits with full avalanche ("lowbias32", Wellons).
constexpr std::uint32_t hash32(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}

constexpr std::uint32_t combine(std::uint32_t seed, std::uint32_t value) {
  return hash32(seed ^ (hash32(value + 0x9e3779b9u) + 0x85ebca6bu));
}

constexpr std::uint32_t reversedBits(std::uint32_t x) {
  x = (x >> 16) | (x << 16);
  x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
  x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
  return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

// Flips each bit by a hash of the bits below it.
constexpr std::uint32_t laineKarras(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

// Flips each bit by a hash of the bits above it: Owen's nested uniform scrambling.
constexpr std::uint32_t owenScrambled(std::uint32_t x, std::uint32_t seed) {
  return reversedBits(laineKarras(reversedBits(x), seed));
}

// Returns the second dimension of the Sobol sequence with its bits reversed: the Pascal matrix modulo 2 times
// the index. The first dimension with its bits reversed is the index itself.
constexpr std::uint32_t sobolSecondReversed(std::uint32_t index) {
  index ^= index >> 16;
  index ^= (index & 0xff00ff00u) >> 8;
  index ^= (index & 0xf0f0f0f0u) >> 4;
  index ^= (index & 0xccccccccu) >> 2;
  return index ^ ((index & 0xaaaaaaaau) >> 1);
}

// Returns a number in [0, 1), never 1.
constexpr float unitFloat(std::uint32_t x) {
  return static_cast<float>(x >> 8) * 0x1p-24f;
}

// Hashes 64 bits with full avalanche (the finalizer of SplitMix64).
constexpr std::uint64_t hash64(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

// Generates a sequence of independent numbers, for uses whose count is not known in advance: SplitMix64
// (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", OOPSLA 2014).
class Stream {
 public:
  explicit Stream(std::uint64_t key) : state_(key) {}
  // Returns a number in (0, 1).
  double next() {
    state_ += 0x9e3779b97f4a7c15u;
    return (static_cast<double>(hash64(state_) >> 12) + 0.5) * 0x1p-52;
  }
  double exponential() { return -std::log(next()); }

 private:
  std::uint64_t state_;
};

class Sampler {
 public:
  // Pixels, seeds and the replicas of a pixel are independent of each other.
  Sampler(std::uint32_t seed, std::uint32_t pixel, std::uint32_t replica)
      : key_(combine(combine(combine(0x4c4d4272u, seed), pixel), replica)) {}

  // Returns point `index` of the pair of dimensions `dimension`, in [0, 1)².
  glm::vec2 pair(std::uint32_t dimension, std::uint32_t index) const {
    const std::uint32_t key = combine(key_, dimension);
    // The index is shuffled differently for each pair, so that pairs are independent.
    const std::uint32_t shuffled = owenScrambled(index, key);
    return {unitFloat(reversedBits(laineKarras(shuffled, hash32(key ^ 0x68bc21ebu)))),
            unitFloat(reversedBits(laineKarras(sobolSecondReversed(shuffled), hash32(key ^ 0x02e5be93u))))};
  }

  // Returns a stream that is independent of the pairs. `which` distinguishes its uses at a vertex.
  Stream stream(std::uint32_t dimension, std::uint32_t index, std::uint32_t which) const {
    const std::uint64_t place = hash64((std::uint64_t{key_} << 32) | dimension);
    return Stream(hash64(place ^ hash64((std::uint64_t{which} << 32) | index)));
  }

 private:
  std::uint32_t key_;
};

// Maps the unit square to directions and points, each with its density.

inline constexpr float kPi = std::numbers::pi_v<float>;

// Returns a right-handed frame whose third column is n. Duff et al., "Building an Orthonormal Basis,
// Revisited", JCGT 6(1), 2017.
inline glm::mat3 frameAbout(const glm::vec3& n) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z), b = n.x * n.y * a;
  return {glm::vec3(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x),
          glm::vec3(b, sign + n.y * n.y * a, -n.y), n};
}

// Returns a direction about +Z with pdf = z/pi, by Shirley and Chiu's concentric map, lifted by Malley's
// method.
inline glm::vec3 cosineDirection(const glm::vec2& u) {
  const glm::vec2 p = 2.0f * u - 1.0f;
  if (p.x == 0.0f && p.y == 0.0f) return {0.0f, 0.0f, 1.0f};
  const bool wide = std::abs(p.x) > std::abs(p.y);
  const float r = wide ? p.x : p.y;
  const float angle = wide ? kPi / 4.0f * (p.y / p.x) : kPi / 2.0f - kPi / 4.0f * (p.x / p.y);
  const glm::vec2 disc = r * glm::vec2(std::cos(angle), std::sin(angle));
  return {disc, std::sqrt(std::max(0.0f, 1.0f - glm::dot(disc, disc)))};
}

// Returns a direction with pdf = 1/(4 pi).
inline glm::vec3 sphereDirection(const glm::vec2& u) {
  const float z = 1.0f - 2.0f * u.x, r = std::sqrt(std::max(0.0f, 1.0f - z * z)), angle = 2.0f * kPi * u.y;
  return {r * std::cos(angle), r * std::sin(angle), z};
}

// Returns a direction within the cone about +Z whose 1 - cos(half angle) is `cap`; pdf = 1/(2 pi cap).
inline glm::vec3 coneDirection(const glm::vec2& u, float cap) {
  const float below = u.x * cap;  // 1 - z, without cancellation in narrow cones
  const float r = std::sqrt(std::max(0.0f, below * (2.0f - below))), angle = 2.0f * kPi * u.y;
  return {r * std::cos(angle), r * std::sin(angle), 1.0f - below};
}

// Returns barycentric coordinates of the second and third corner, uniform over the area.
inline glm::vec2 trianglePoint(const glm::vec2& u) {
  const float root = std::sqrt(u.x);
  return {1.0f - root, root * u.y};
}

// Veach's power heuristic: the weight of a sample of density p if another strategy has density q.
inline float powerHeuristic(float p, float q) {
  if (!(p > 0.0f)) return 0.0f;
  const float ratio = q / p;
  return 1.0f / (1.0f + ratio * ratio);
}

}  // namespace lambent::baker::reference
