#include "baker/accuracy/compare.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "runtime/base/finite.hpp"

namespace lambent::baker {

namespace {

double percentile(std::vector<double>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Two infinite depths (no surface) are the same. NaN differs from every depth.
bool sameDepth(float a, float b) {
  return a == b || std::abs(a - b) <= kSameDepth * std::min(a, b);
}

bool haveDepths(std::initializer_list<const spec::RgbaImage*> pictures) {
  return std::ranges::none_of(pictures, [](const spec::RgbaImage* p) { return p->depths.empty(); });
}

// These sums give relative_rms.
struct Sums {
  double squares = 0.0, energy = 0.0;
  std::uint64_t pixels = 0;

  void add(const glm::dvec3& x, const glm::dvec3& a, const glm::dvec3& b) {
    squares += glm::dot(x - a, x - b);
    energy += glm::dot(a, b);
    ++pixels;
  }
  double relativeRms() const { return std::sqrt(std::max(squares, 0.0) / energy); }
};

}  // namespace

Result<PictureError> comparePictures(const spec::RgbaImage& picture, const spec::RgbaImage& reference,
                                     const spec::RgbaImage* reference2, const std::string& subject) {
  const spec::RgbaImage& second = reference2 ? *reference2 : reference;
  for (const spec::RgbaImage* other : {&reference, &second})
    if (other->width != picture.width || other->height != picture.height)
      return fail(subject,
                  fmt::format("is {} x {}, the reference {} x {}", picture.width, picture.height,
                              other->width, other->height),
                  "draw both with the same --size");
  PictureError error;
  Sums all, same_surface;
  double noise_squares = 0.0;
  glm::dvec3 difference_sum(0.0), reference_sum(0.0);
  std::vector<double> differences;
  const bool depths = haveDepths({&picture, &reference, &second});
  for (std::size_t i = 0; i < picture.texels.size(); ++i) {
    const auto [least, most] = std::minmax({picture.texels[i].w, reference.texels[i].w, second.texels[i].w});
    // A pixel of an outline that is just above the bound in one picture and just below in another does not
    // count.
    error.pixels_apart += most >= spec::kLeastCoverage && least < 0.5f * spec::kLeastCoverage;
    if (!(least >= spec::kLeastCoverage)) continue;
    const glm::dvec3 x(picture.texels[i]), a(reference.texels[i]), b(second.texels[i]), mean = 0.5 * (a + b);
    if (!isFinite(x) || !isFinite(a) || !isFinite(b))
      return fail(
          subject,
          fmt::format("or its reference is not finite at pixel {}, {}", i % picture.width, i / picture.width),
          "draw it again");
    all.add(x, a, b);
    if (depths && sameDepth(picture.depths[i], reference.depths[i]) &&
        sameDepth(picture.depths[i], second.depths[i]) && sameDepth(reference.depths[i], second.depths[i]))
      same_surface.add(x, a, b);
    // With d the error and p, q the noise of A and B, (d - p)(d - q) varies by -d (p + q) + pq. The variance
    // of that equals that of (d - (p + q)/2)(p - q), which can be measured.
    const double noise = glm::dot(x - mean, a - b);
    noise_squares += noise * noise;
    difference_sum += x - mean;
    reference_sum += mean;
    differences.push_back(glm::length(x - mean));
  }
  if (differences.empty())
    return fail(subject, "covers no pixel that its reference covers", "use the same camera for both");
  if (!(all.energy > 0.0))
    return fail(subject, "has a black reference", "use a light that reaches the scene");

  error.pixels = all.pixels;
  error.relative_rms = all.relativeRms();
  if (depths) error.pixels_of_other_surfaces = all.pixels - same_surface.pixels;
  if (same_surface.energy > 0.0) error.same_surface_rms = same_surface.relativeRms();
  error.relative_square_error = std::sqrt(noise_squares) / all.energy;
  for (int k = 0; k < 3; ++k)
    error.bias[static_cast<std::size_t>(k)] =
        reference_sum[k] != 0.0 ? difference_sum[k] / reference_sum[k] : 0.0;
  const double scale = std::sqrt(all.energy / static_cast<double>(error.pixels));
  error.median = percentile(differences, 0.5) / scale;
  error.percentile_95 = percentile(differences, 0.95) / scale;
  error.percentile_99 = percentile(differences, 0.99) / scale;
  error.largest = *std::max_element(differences.begin(), differences.end()) / scale;
  return error;
}

Result<spec::RgbaImage> shrunk(const spec::RgbaImage& picture, std::uint32_t n, const std::string& subject) {
  if (n == 1) return picture;
  if (n < 1 || picture.width % n != 0 || picture.height % n != 0)
    return fail(subject,
                fmt::format("{} x {} pixels cannot be shrunk by {}", picture.width, picture.height, n),
                "shrink by a number that divides both");
  spec::RgbaImage out{picture.width / n, picture.height / n, {}};
  out.texels.reserve(std::size_t{out.width} * out.height);
  const double share = 1.0 / (static_cast<double>(n) * static_cast<double>(n));
  for (std::uint32_t y = 0; y < out.height; ++y)
    for (std::uint32_t x = 0; x < out.width; ++x) {
      glm::dvec4 sum(0.0);
      for (std::uint32_t row = y * n; row < (y + 1) * n; ++row)
        for (std::uint32_t column = x * n; column < (x + 1) * n; ++column)
          sum += glm::dvec4(picture.texels[std::size_t{row} * picture.width + column]);
      out.texels.emplace_back(share * sum);
    }
  return out;
}

}  // namespace lambent::baker
