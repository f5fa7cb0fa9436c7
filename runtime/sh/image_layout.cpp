#include "runtime/sh/image_layout.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "runtime/base/finite.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::sh {

namespace {

// Squares of the cross by row and column, as faces of the cube; -1: none. Squares in the middle row and
// column show the cube from inside with +Y up. The bottom one is attached below -Y, so it shows +Z rotated by
// 180 degrees.
constexpr int kSquares[4][3] = {{-1, 2, -1}, {1, 5, 0}, {-1, 3, -1}, {-1, 4, -1}};

// Returns the direction at (u, v) of a square, with u to the right and v up, both in [-1, 1].
glm::dvec3 squareDirection(int face, double u, double v) {
  const double sign = face == 0 || face == 1 || face == 5 ? -1 : 1;
  return cubeFaceDirection(face, sign * u, sign * v);
}

struct CrossTexel {
  int face;       // -1: an empty square
  double u0, v0;  // lower left corner
  double edge;
};

CrossTexel crossTexel(int width, int x, int y) {
  const int size = width / 3;
  const int column = x / size, row = y / size;
  const double edge = 2.0 / size;
  return {kSquares[row][column], -1 + (x - column * size) * edge, 1 - (y - row * size + 1) * edge, edge};
}

glm::dvec2 crossCoordinates(int width, const glm::dvec3& dir) {
  const glm::dvec3 size = glm::abs(dir);
  int column = 1, row = 1;
  double u = 0, v = 0;
  if (size.x >= size.y && size.x >= size.z) {
    column = dir.x > 0 ? 2 : 0;
    u = dir.z / dir.x;
    v = dir.y / size.x;
  } else if (size.y >= size.z) {
    row = dir.y > 0 ? 0 : 2;
    u = dir.x / size.y;
    v = dir.z / dir.y;
  } else if (dir.z < 0) {
    u = dir.x / size.z;
    v = dir.y / size.z;
  } else {
    row = 3;
    u = dir.x / size.z;
    v = -dir.y / size.z;
  }
  const double edge = width / 3;
  return {(column + 0.5 * (u + 1)) * edge, (row + 0.5 * (1 - v)) * edge};
}

}  // namespace

std::string_view name(ImageLayout layout) {
  switch (layout) {
    case ImageLayout::LatLong:
      return "lat-long";
    case ImageLayout::AngularMap:
      return "angular-map";
    case ImageLayout::VerticalCross:
      return "vertical-cross";
  }
  return {};
}

std::optional<ImageLayout> layoutOfShape(int width, int height) {
  if (width <= 0 || height <= 0) return std::nullopt;
  if (width % 2 == 0 && width / 2 == height) return ImageLayout::LatLong;
  if (width == height) return ImageLayout::AngularMap;
  if (width % 3 == 0 && height % 4 == 0 && width / 3 == height / 4) return ImageLayout::VerticalCross;
  return std::nullopt;
}

glm::dvec3 texelDirection(ImageLayout layout, int width, int height, int x, int y) {
  assert(x >= 0 && x < width && y >= 0 && y < height);
  switch (layout) {
    case ImageLayout::LatLong: {
      const double azimuth = 2 * kPi * ((x + 0.5) / width - 0.5);
      const double polar = kPi * (y + 0.5) / height;
      return {std::cos(azimuth) * std::sin(polar), std::cos(polar), std::sin(azimuth) * std::sin(polar)};
    }
    case ImageLayout::AngularMap: {
      const double u = 2 * (x + 0.5) / width - 1, v = 1 - 2 * (y + 0.5) / height;
      const double r = std::hypot(u, v);
      if (r > 1) return glm::dvec3(0);
      const double scale = r > 0 ? std::sin(kPi * r) / r : kPi;
      return {scale * u, scale * v, -std::cos(kPi * r)};
    }
    case ImageLayout::VerticalCross: {
      const CrossTexel texel = crossTexel(width, x, y);
      if (texel.face < 0) return glm::dvec3(0);
      return glm::normalize(
          squareDirection(texel.face, texel.u0 + texel.edge / 2, texel.v0 + texel.edge / 2));
    }
  }
  return glm::dvec3(0);
}

double texelSolidAngle(ImageLayout layout, int width, int height, int x, int y) {
  assert(x >= 0 && x < width && y >= 0 && y < height);
  switch (layout) {
    case ImageLayout::LatLong:
      // cos(a) - cos(b) = 2 sin(middle) sin(half the difference)
      return 2 * kPi / width * 2 * std::sin(kPi * (y + 0.5) / height) * std::sin(kPi / 2 / height);
    case ImageLayout::AngularMap: {
      const double r = std::hypot(2 * (x + 0.5) / width - 1, 1 - 2 * (y + 0.5) / height);
      if (r > 1) return 0;
      const double density = r > 0 ? kPi * std::sin(kPi * r) / r : kPi * kPi;
      return density * (2.0 / width) * (2.0 / height);
    }
    case ImageLayout::VerticalCross: {
      const CrossTexel texel = crossTexel(width, x, y);
      if (texel.face < 0) return 0;
      return rectangleSolidAngle(texel.u0, texel.u0 + texel.edge, texel.v0, texel.v0 + texel.edge);
    }
  }
  return 0;
}

glm::dvec2 imageCoordinates(ImageLayout layout, int width, int height, const glm::dvec3& dir) {
  switch (layout) {
    case ImageLayout::LatLong: {
      const double azimuth = std::atan2(dir.z, dir.x);
      const double polar = std::atan2(std::hypot(dir.x, dir.z), dir.y);  // acos would lose the poles
      return {(0.5 + azimuth / (2 * kPi)) * width, polar / kPi * height};
    }
    case ImageLayout::AngularMap: {
      const double side = std::hypot(dir.x, dir.y);
      const double r = std::atan2(side, -dir.z) / kPi;
      // The whole rim shows +Z; its right end represents that direction.
      const double u = side > 0 ? r * dir.x / side : r, v = side > 0 ? r * dir.y / side : 0;
      return {0.5 * (u + 1) * width, 0.5 * (1 - v) * height};
    }
    case ImageLayout::VerticalCross:
      return crossCoordinates(width, dir);
  }
  return {};
}

namespace {

// Returns the signed solid angle of [0, u] x [0, v] at distance 1.
double cornerSolidAngle(double u, double v) {
  return std::atan2(u * v, std::sqrt(u * u + v * v + 1));
}

}  // namespace

glm::dvec3 cubeFaceDirection(int face, double sc, double tc) {
  switch (face) {
    case 0:
      return {1, -tc, -sc};
    case 1:
      return {-1, -tc, sc};
    case 2:
      return {sc, 1, tc};
    case 3:
      return {sc, -1, -tc};
    case 4:
      return {sc, -tc, 1};
    case 5:
      return {-sc, -tc, -1};
  }
  assert(false && "a cube has faces 0 to 5");
  return {};
}

glm::dvec3 cubeTexelDirection(int size, int face, int x, int y) {
  return glm::normalize(cubeFaceDirection(face, 2 * (x + 0.5) / size - 1, 2 * (y + 0.5) / size - 1));
}

double cubeTexelSolidAngle(int size, int x, int y) {
  const double edge = 2.0 / size;
  return rectangleSolidAngle(-1 + x * edge, -1 + (x + 1) * edge, -1 + y * edge, -1 + (y + 1) * edge);
}

double rectangleSolidAngle(double u0, double u1, double v0, double v1) {
  return cornerSolidAngle(u1, v1) - cornerSolidAngle(u0, v1) - cornerSolidAngle(u1, v0) +
         cornerSolidAngle(u0, v0);
}

LightVector projectImage(int order, ImageLayout layout, int width, int height,
                         std::span<const glm::vec3> texels) {
  assert(texels.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const auto count = static_cast<std::size_t>(coefficientCount(order));
  std::array<std::array<double, kMaxCoefficients>, 3> sum{};
  std::array<double, kMaxCoefficients> basis;

  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double solid_angle_sr = texelSolidAngle(layout, width, height, x, y);
      if (solid_angle_sr <= 0) continue;
      const glm::vec3& radiance =
          texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
      if (!isFinite(radiance)) continue;
      evaluate(order, texelDirection(layout, width, height, x, y), basis);
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const double weight = static_cast<double>(radiance[static_cast<int>(channel)]) * solid_angle_sr;
        for (std::size_t i = 0; i < count; ++i) sum[channel][i] += weight * basis[i];
      }
    }
  }
  LightVector light{.order = order};
  for (std::size_t i = 0; i < count; ++i) light.c[i] = glm::vec3(glm::dvec3(sum[0][i], sum[1][i], sum[2][i]));
  return light;
}

namespace {

// Nodes and weights of 6-point Gauss-Legendre quadrature on [-1, 1]. Integrands are smooth over a texel: 6 x
// 6 points give the means of y to 1e-4 for a whole face, and up to rounding for faces of 4 or more texels per
// edge.
struct GaussNode {
  double at, weight;
};
constexpr std::array<GaussNode, 6> kGauss = {{{-0.93246951420315203, 0.17132449237917035},
                                              {-0.66120938646626451, 0.36076157304813861},
                                              {-0.23861918608319691, 0.46791393457269105},
                                              {0.23861918608319691, 0.46791393457269105},
                                              {0.66120938646626451, 0.36076157304813861},
                                              {0.93246951420315203, 0.17132449237917035}}};

// Writes Omega (2 y(centre) - mean y) of a texel for all coefficients.
void sharpenedWeights(int order, int size, int face, int x, int y, double* weights) {
  const double half = 1.0 / size;
  const double sc = 2 * (x + 0.5) / size - 1, tc = 2 * (y + 0.5) / size - 1;
  const auto count = static_cast<std::size_t>(coefficientCount(order));
  const double solid_angle_sr = cubeTexelSolidAngle(size, x, y);

  std::array<double, kMaxCoefficients> basis, integral{};
  double area = 0;
  for (const GaussNode& u : kGauss) {
    for (const GaussNode& v : kGauss) {
      const glm::dvec3 dir = cubeFaceDirection(face, sc + half * u.at, tc + half * v.at);
      const double squared = glm::dot(dir, dir), length = std::sqrt(squared);
      const double weight = u.weight * v.weight / (squared * length);
      evaluate(order, dir / length, basis);
      area += weight;
      for (std::size_t i = 0; i < count; ++i) integral[i] += weight * basis[i];
    }
  }
  evaluate(order, cubeTexelDirection(size, face, x, y), basis);
  for (std::size_t i = 0; i < count; ++i) weights[i] = solid_angle_sr * (2 * basis[i] - integral[i] / area);
}

}  // namespace

std::vector<float> cubeWeights(int order, int size) {
  assert(order >= 1 && order <= kMaxOrder && size >= 1);
  const auto count = static_cast<std::size_t>(coefficientCount(order));
  const std::size_t texel_count = 6 * static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  const auto forEachTexel = [&](auto&& f) {
    std::size_t k = 0;
    for (int face = 0; face < 6; ++face)
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) f(k++, face, x, y);
  };
  // Uniform light must have no coefficient except the first. Without the correction, weights of bands 4 and
  // up that share the cube's symmetry sum to slightly more than 0 over the whole cube.
  std::vector<double> sharpened(count * texel_count);
  std::array<double, kMaxCoefficients> excess{};  // per steradian
  forEachTexel([&](std::size_t k, int face, int x, int y) {
    double* const weights = sharpened.data() + k * count;
    sharpenedWeights(order, size, face, x, y, weights);
    for (std::size_t i = 1; i < count; ++i) excess[i] += weights[i] / (4 * kPi);
  });
  std::vector<float> table(count * texel_count);
  forEachTexel([&](std::size_t k, int, int x, int y) {
    const double solid_angle_sr = cubeTexelSolidAngle(size, x, y);
    for (std::size_t i = 0; i < count; ++i)
      table[i * texel_count + k] = static_cast<float>(sharpened[k * count + i] - excess[i] * solid_angle_sr);
  });
  return table;
}

}  // namespace lambent::sh
