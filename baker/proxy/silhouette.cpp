#include "baker/proxy/silhouette.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace lambent::baker {

namespace {

constexpr int kSide = 128;  // pixels
constexpr float kEnd = kSide;

float cross2(glm::vec2 a, glm::vec2 b) {
  return a.x * b.y - a.y * b.x;
}

// Marks pixels whose centre the triangle covers, whichever way it winds.
void fill(glm::vec2 a, glm::vec2 b, glm::vec2 c, std::vector<std::uint8_t>& pixels) {
  if (cross2(b - a, c - a) < 0.0f) std::swap(b, c);
  const auto first = [](float v) { return static_cast<int>(std::clamp(std::ceil(v - 0.5f), 0.0f, kEnd)); };
  const int x0 = first(std::min({a.x, b.x, c.x})), x1 = first(std::max({a.x, b.x, c.x}) + 1.0f);
  const int y0 = first(std::min({a.y, b.y, c.y})), y1 = first(std::max({a.y, b.y, c.y}) + 1.0f);
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const glm::vec2 p(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      if (cross2(b - a, p - a) >= 0.0f && cross2(c - b, p - b) >= 0.0f && cross2(a - c, p - c) >= 0.0f)
        pixels[static_cast<std::size_t>(y * kSide + x)] = 1;
    }
}

}  // namespace

double Silhouette::pixelsOf(std::span<const SimpleMesh> meshes, const View& view) {
  std::vector<std::uint8_t> pixels(std::size_t{kSide} * kSide, 0);
  const glm::vec2 scale = kEnd / (view.high - view.low);
  for (const SimpleMesh& mesh : meshes) {
    std::vector<glm::vec2> flat;
    for (const glm::vec3& p : mesh.positions)
      flat.push_back((glm::vec2(glm::dot(p, view.right), glm::dot(p, view.up)) - view.low) * scale);
    for (const glm::uvec3& t : mesh.triangles) fill(flat[t.x], flat[t.y], flat[t.z], pixels);
  }
  return static_cast<double>(std::count(pixels.begin(), pixels.end(), std::uint8_t{1}));
}

Silhouette::Silhouette(std::span<const SimpleMesh> original) {
  constexpr std::array<glm::vec3, 7> kDirections = {
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {1, 1, -1}}};
  for (std::size_t i = 0; i < views_.size(); ++i) {
    View& view = views_[i];
    const glm::vec3 direction = glm::normalize(kDirections[i]);
    const glm::vec3 aside =
        std::abs(direction.y) < 0.9f ? glm::vec3(0.0f, 1.0f, 0.0f) : glm::vec3(1.0f, 0.0f, 0.0f);
    view.right = glm::normalize(glm::cross(aside, direction));
    view.up = glm::cross(direction, view.right);
    view.low = glm::vec2(std::numeric_limits<float>::max());
    view.high = -view.low;
    for (const SimpleMesh& mesh : original)
      for (const glm::vec3& p : mesh.positions) {
        const glm::vec2 q(glm::dot(p, view.right), glm::dot(p, view.up));
        view.low = glm::min(view.low, q), view.high = glm::max(view.high, q);
      }
    const glm::vec2 size = view.high - view.low;
    const double pixel = double{size.x} * double{size.y} / (kSide * kSide);
    // A width that floats can hold may have an inverse that they cannot.
    const glm::vec2 scale = kEnd / size;
    if (!(pixel > 0.0) || !std::isfinite(pixel) || !std::isfinite(scale.x + scale.y)) continue;
    view.pixel = pixel;
    view.covered = pixelsOf(original, view);
  }
}

float Silhouette::scaleOf(std::span<const SimpleMesh> proxy) const {
  double wanted = 0.0, found = 0.0;
  for (const View& view : views_) {
    if (view.pixel == 0.0) continue;
    wanted += view.pixel * view.covered;
    found += view.pixel * pixelsOf(proxy, view);
  }
  if (!(wanted > 0.0) || !(found > 0.0)) return 1.0f;
  return std::clamp(static_cast<float>(std::sqrt(wanted / found)), 0.5f, 2.0f);
}

}  // namespace lambent::baker
