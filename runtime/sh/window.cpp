#include "runtime/sh/window.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace lambent::sh {

namespace {

constexpr std::size_t kDirections = 1024;
// Fraction of the mean radiance by which the search aims above 0, as a margin for rounding.
constexpr float kGuard = 1e-5f;
constexpr float kWorthIt = 2e-5f;  // gain in blend below which the climb shortens its step
// A channel whose ratio of mean to largest coefficient is smaller than this is ignored.
constexpr float kHopeless = 1e-6f;

// Returns the blend a that lifts light to the guard: (1 - a) as_is + a lifted = guard. It is 0 if the light
// is positive already, and 1 if even the kernel does not suffice.
float blendOf(float as_is, float lifted) {
  if (as_is >= -0.5f * kGuard)
    return 0;  // the light is positive up to rounding; half the guard separates this test from the goal
  if (lifted <= kGuard) return 1;
  return (kGuard - as_is) / (lifted - as_is);
}

// Holds one channel of the light, divided by its mean: plain, and convolved with the positive kernel.
// Coefficients beyond its order are 0.
struct Channel {
  std::array<float, kMaxCoefficients> plain{}, smooth{};
};

constexpr std::size_t kLanes = 8;  // parallel sums, which the compiler vectorizes

float sum(std::array<float, kLanes> lanes) {
  for (std::size_t half = kLanes / 2; half > 0; half /= 2)
    for (std::size_t k = 0; k < half; ++k) lanes[k] += lanes[k + half];
  return lanes[0];
}

// Holds the channels of a light that differ. The largest of their blends is wanted.
struct Channels {
  int order;
  std::size_t count = 0;
  std::array<Channel, 3> at{};

  std::size_t coefficients() const { return static_cast<std::size_t>(coefficientCount(order)); }

  void add(const Channel& channel) {
    const auto same = [&](const Channel& other) { return other.plain == channel.plain; };
    if (std::none_of(at.begin(), at.begin() + static_cast<std::ptrdiff_t>(count), same))
      at[count++] = channel;
  }

  float blendTowards(const glm::vec3& dir) const {
    std::array<float, kMaxCoefficients> y{};
    evaluate(order, dir, y);
    float blend = 0;
    for (std::size_t c = 0; c < count; ++c) {
      std::array<float, kLanes> as_is{}, lifted{};
      for (std::size_t i = 0; i < coefficients(); i += kLanes)
        for (std::size_t k = 0; k < kLanes; ++k) {
          as_is[k] += at[c].plain[i + k] * y[i + k];
          lifted[k] += at[c].smooth[i + k] * y[i + k];
        }
      blend = std::max(blend, blendOf(sum(as_is), sum(lifted)));
    }
    return blend;
  }
};
static_assert(kMaxCoefficients % kLanes == 0);

// Returns the summit, in (-step, step), of a parabola through three values a step apart. If it has none,
// returns a position towards the larger value.
float summitOf(float before, float here, float after, float step) {
  const float bend = 2 * here - before - after, slope = after - before;
  if (bend <= 0.25f * std::abs(slope)) return slope > 0 ? step : slope < 0 ? -step : 0;
  return std::clamp(0.5f * step * slope / bend, -step, step);
}

// Climbs on the sphere, from `dir`, with crosses of shrinking steps and the parabolas through them. This
// works because the blend is smooth, and stopping along the flat crest of a ring loses almost nothing.
float climb(const Channels& channels, glm::vec3 dir, float best) {
  for (float step = 0.05f; step > 2e-3f;) {
    const glm::vec3 across =
        glm::normalize(glm::cross(dir, std::abs(dir.x) < 0.7f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0)));
    const glm::vec3 along = glm::cross(dir, across);
    glm::vec3 next = dir, move{};
    const float here = best;
    const auto look = [&](const glm::vec3& offset) {
      const glm::vec3 candidate = glm::normalize(dir + offset);
      const float blend = channels.blendTowards(candidate);
      if (blend > best) {
        best = blend;
        next = candidate;
      }
      return blend;
    };
    for (const glm::vec3& axis : {across, along}) {
      const float before = look(-step * axis), after = look(step * axis);
      move += summitOf(before, here, after, step) * axis;
    }
    look(move);
    if (best - here < kWorthIt) step *= 0.5f;
    dir = next;
  }
  return best;
}

// Spherical Fibonacci points, which have no poles or seams. They are 0.11 rad apart, so bands up to 7 have no
// minimum between them that they miss. Basis functions are stored by tiles of points and within a tile by
// function, so that the sums of a tile stay in registers.
struct SearchPoints {
  static constexpr std::size_t kTile = 32;
  struct Tile {
    std::array<std::array<float, kTile>, kMaxCoefficients> basis;
    std::array<glm::vec3, kTile> directions;
  };
  std::vector<Tile> tiles{kDirections / kTile};

  SearchPoints() {
    for (std::size_t k = 0; k < kDirections; ++k) {
      const double z = 1 - (2.0 * static_cast<double>(k) + 1) / kDirections, r = std::sqrt(1 - z * z);
      const double turn = std::numbers::pi * (3 - std::sqrt(5.0)) * static_cast<double>(k);
      const glm::vec3 dir(static_cast<float>(r * std::cos(turn)), static_cast<float>(r * std::sin(turn)),
                          static_cast<float>(z));
      Tile& tile = tiles[k / kTile];
      tile.directions[k % kTile] = dir;
      std::array<float, kMaxCoefficients> y;
      evaluate(kMaxOrder, dir, y);
      for (std::size_t i = 0; i < y.size(); ++i) tile.basis[i][k % kTile] = y[i];
    }
  }

  static const SearchPoints& get() {
    static const SearchPoints points;
    return points;
  }
};

struct Summit {
  float blend;
  glm::vec3 dir;
};

// Returns the search points at which the light must be lifted.
std::vector<Summit> lifted(const Channels& channels) {
  constexpr std::size_t kTile = SearchPoints::kTile;
  std::vector<Summit> found;
  for (const SearchPoints::Tile& tile : SearchPoints::get().tiles) {
    std::array<float, kTile> blends{};
    for (std::size_t c = 0; c < channels.count; ++c) {
      std::array<float, kTile> as_is{}, smooth{};
      for (std::size_t i = 0; i < channels.coefficients(); ++i) {
        const float* y = tile.basis[i].data();
        const float of_plain = channels.at[c].plain[i], of_smooth = channels.at[c].smooth[i];
        for (std::size_t k = 0; k < kTile; ++k) {
          as_is[k] += of_plain * y[k];
          smooth[k] += of_smooth * y[k];
        }
      }
      for (std::size_t k = 0; k < kTile; ++k) blends[k] = std::max(blends[k], blendOf(as_is[k], smooth[k]));
    }
    for (std::size_t k = 0; k < kTile; ++k)
      if (blends[k] > 0) found.push_back({blends[k], tile.directions[k]});
  }
  return found;
}

// Returns the highest points first. Of points around one summit only the highest is kept, since one climb
// serves them all.
std::vector<Summit> summits(const Channels& channels) {
  constexpr std::size_t kMostSummits = 5;
  constexpr float kApart = 0.97f;  // cosine of 0.25 rad, more than twice the distance between points
  std::vector<Summit> points = lifted(channels), kept;
  while (kept.size() < kMostSummits && !points.empty()) {
    const Summit highest = *std::ranges::max_element(points, {}, &Summit::blend);
    kept.push_back(highest);
    std::erase_if(points, [&](const Summit& point) { return glm::dot(point.dir, highest.dir) > kApart; });
  }
  return kept;
}

float leastBlend(const Channels& channels) {
  float best = 0;
  for (const auto& [blend, dir] : summits(channels)) best = std::max(best, climb(channels, dir, blend));
  return best;
}

// Returns the blend a of Auto, which is 0 if no channel rings. Channels whose mean is not positive are
// ignored, since no window can help them, and so are lights with coefficients that are not finite.
float blendFor(const LightVector& light, const BandWeights& kernel) {
  Channels channels{.order = light.order};
  for (int k = 0; k < 3; ++k) {
    Channel channel;
    const float mean = light.c[0][k] * 0.28209479f;  // mean radiance c_0 y_00
    float largest = 0;
    for (std::size_t i = 0; i < light.coefficients().size(); ++i) {
      if (!std::isfinite(light.c[i][k])) return 0;
      largest = std::max(largest, std::abs(light.c[i][k]));
      channel.plain[i] = light.c[i][k] / mean;
      channel.smooth[i] = kernel[static_cast<std::size_t>(bandOf(static_cast<int>(i)))] * channel.plain[i];
    }
    if (light.c[0][k] > kHopeless * largest) channels.add(channel);
  }
  return leastBlend(channels);
}

}  // namespace

BandWeights positiveWeights(int order) {
  // k_l is the integral of kernel and P_l over that of the kernel, by Simpson's rule.
  constexpr std::array<BandWeights, kMaxOrder + 1> kByOrder = {
      {{},
       {1.0f},
       {1.0f, 0.333333343f},
       {1.0f, 0.577350259f, 0.200000003f},
       {1.0f, 0.689897954f, 0.344948977f, 0.0935787186f},
       {1.0f, 0.774596691f, 0.485714287f, 0.221313342f, 0.0634920672f},
       {1.0f, 0.822824061f, 0.576114297f, 0.326164126f, 0.140392929f, 0.0356806293f},
       {1.0f, 0.861136317f, 0.655407667f, 0.428389072f, 0.235437796f, 0.0983516797f, 0.0263565518f},
       {1.0f, 0.8857916f, 0.709246159f, 0.504783869f, 0.315425426f, 0.16509001f, 0.0669896752f,
        0.0166049823f}}};
  return kByOrder[static_cast<std::size_t>(order)];
}

BandWeights windowWeights(const LightVector& light, Window window) {
  const BandWeights kernel = positiveWeights(light.order);
  const float blend = window == Window::Auto ? blendFor(light, kernel) : 0.0f;
  BandWeights weights{};
  for (std::size_t l = 0; l < static_cast<std::size_t>(light.order); ++l)
    weights[l] = 1 - blend + blend * kernel[l];
  return weights;
}

LightVector applyWindow(const LightVector& light, Window window) {
  return window == Window::Off ? light : applyWeights(light, windowWeights(light, window));
}

LightVector applyWeights(const LightVector& light, const BandWeights& weights) {
  LightVector result{.order = light.order};
  for (std::size_t i = 0; i < light.coefficients().size(); ++i)
    result.c[i] = light.c[i] * weights[static_cast<std::size_t>(bandOf(static_cast<int>(i)))];
  return result;
}

bool sameShape(const LightVector& a, const LightVector& b) {
  if (a.order != b.order) return false;
  constexpr double kTolerance = 1e-6;
  glm::dvec3 of_a(0.0), of_b(0.0), of_both(0.0);
  for (std::size_t i = 0; i < a.coefficients().size(); ++i) {
    const glm::dvec3 x(a.c[i]), y(b.c[i]);
    of_a += x * x;
    of_b += y * y;
    of_both += x * y;
  }
  glm::dvec3 factor(1.0);
  for (int k = 0; k < 3; ++k) {
    if (of_a[k] == 0.0 && of_b[k] == 0.0) continue;
    if (!(of_both[k] > 0.0)) return false;
    factor[k] = of_both[k] / of_a[k];
  }
  // The sums above lose digits by cancellation, so the remainder is computed from the coefficients.
  glm::dvec3 left(0.0);
  for (std::size_t i = 0; i < a.coefficients().size(); ++i) {
    const glm::dvec3 apart = glm::dvec3(b.c[i]) - factor * glm::dvec3(a.c[i]);
    left += apart * apart;
  }
  for (int k = 0; k < 3; ++k)
    if (!(left[k] <= kTolerance * kTolerance * of_b[k])) return false;
  return true;
}

bool CachedWindow::fits(const LightVector& light, Window window) const {
  return window == window_ &&
         (window == Window::Auto ? sameShape(made_from_, light) : light.order == made_from_.order);
}

void CachedWindow::follow(const LightVector& light, Window window) {
  if (fits(light, window)) return;
  made_from_ = light;
  window_ = window;
  weights_ = windowWeights(light, window);
}

}  // namespace lambent::sh
