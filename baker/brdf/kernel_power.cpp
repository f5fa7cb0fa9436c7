#include "baker/brdf/kernel_power.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kPlaces = 512;
constexpr std::array kCosines = {0.9f, 0.65f, 0.4f, 0.18f};
constexpr float kGoldenAngle = 2.39996323f;

// Returns a direction with this cosine to the triangle's normal, rotated about it by `turn`.
glm::vec3 viewOf(const GroupGeometry& geometry, std::uint32_t triangle, float cosine, float turn) {
  const glm::uvec3& corners = geometry.triangles[triangle];
  const glm::vec3 a = geometry.positions[corners.x], ab = geometry.positions[corners.y] - a;
  const glm::vec3 normal = glm::normalize(glm::cross(ab, geometry.positions[corners.z] - a));
  const glm::vec3 along = glm::normalize(ab), across = glm::cross(normal, along);
  const float sine = std::sqrt(1.0f - cosine * cosine);
  return cosine * normal + sine * (std::cos(turn) * along + std::sin(turn) * across);
}

}  // namespace

std::array<double, 6> kernelPower(const GroupGeometry& geometry, const SurfaceBrdfs& brdfs, int order) {
  std::vector<std::uint32_t> glossy;
  for (std::uint32_t t = 0; t < geometry.triangles.size(); ++t)
    if (brdfs.glossy(t)) glossy.push_back(t);
  const auto count = static_cast<std::size_t>(sh::coefficientCount(order));
  std::vector<float> kernel(3 * count);
  std::array<double, 6> power{};
  const std::size_t places = std::min(kPlaces, glossy.size());
  for (std::size_t p = 0; p < places; ++p) {
    const std::uint32_t triangle = glossy[p * glossy.size() / places];
    for (const float cosine : kCosines) {
      brdfs.exitKernel(triangle, 1.0f / 3.0f, 1.0f / 3.0f,
                       viewOf(geometry, triangle, cosine, kGoldenAngle * static_cast<float>(p)), kernel);
      for (std::size_t i = 0; i < kernel.size(); ++i)
        power[static_cast<std::size_t>(sh::bandOf(static_cast<int>(i % count)))] +=
            double{kernel[i]} * double{kernel[i]};
    }
  }
  for (int l = 5; l >= 0; --l) {
    double& own = power[static_cast<std::size_t>(l)];
    own = power[0] > 0.0 ? own / (power[0] * (2 * l + 1)) : (l == 0 ? 1.0 : 0.0);
  }
  return power;
}

}  // namespace lambent::baker
