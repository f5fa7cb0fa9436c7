// Decodes neighborhood grids, and computes the closed form of a black sphere.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "baker/effects/neighborhood/bodies.hpp"
#include "baker/effects/neighborhood/light_change.hpp"
#include "baker/effects/neighborhood/neighborhood.hpp"
#include "runtime/sh/gaunt.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::testing {

// Holds M - I of one channel, [output][column].
using ChangeMatrix = std::vector<float>;

inline ChangeMatrix matrixOf(const baker::ChangeShape& shape, std::span<const float> visibility,
                             std::span<const float> bounced, std::size_t channel = 0) {
  ChangeMatrix matrix(shape.outputs() * shape.columns(), 0.0f);
  sh::addVisibilityMatrix(sh::makeGauntTable(shape.order, shape.order_out), visibility, matrix);
  if (!bounced.empty())
    for (std::size_t i = 0; i < matrix.size(); ++i)
      matrix[i] += bounced[(shape.channels == 1 ? 0 : channel) * matrix.size() + i];
  return matrix;
}

// Returns the change by a black sphere about the origin: minus the cap that it fills (literature 7.2).
inline ChangeMatrix blackSphereChange(const glm::vec3& point, float radius, int order, int order_out) {
  const double distance = double{glm::length(point)};
  const double angle = std::asin(std::min(1.0, double{radius} / distance));
  const int bands = order + order_out - 1;
  std::vector<double> zonal, cap(static_cast<std::size_t>(bands * bands));
  for (int l = 0; l < bands; ++l) zonal.push_back(sh::discZonal(l, angle));
  sh::rotateZonal(bands, zonal, glm::normalize(-glm::dvec3(point)), std::span<double>(cap));
  std::vector<float> visibility;
  for (const double value : cap) visibility.push_back(static_cast<float>(-value));
  const baker::ChangeShape shape{.order = order, .order_out = order_out, .channels = 0};
  return matrixOf(shape, visibility, {});
}

// Bakes a mesh of one colour as a body.
struct BakedBody {
  explicit BakedBody(const bundle::MeshData& mesh, const glm::vec3& albedo = glm::vec3(0.0f))
      : transport([&] {
          baker::Scene scene = sceneOf({mesh});
          scene.materials[0].base_color = glm::vec4(albedo, 1.0f);
          return scene;
        }()),
        baked(transport.bake(5, 256, albedo == glm::vec3(0.0f) ? 0 : -1)),
        body(transport.diffuse(), {.direct = baked.direct.field,
                                   .bounced = albedo == glm::vec3(0.0f) ? nullptr : &baked.bounced.field,
                                   .sends = albedo != glm::vec3(0.0f),
                                   .brdfs = nullptr,
                                   .glossy = nullptr}) {}
  Transport transport;
  Transport::Baked baked;
  baker::SurfaceBody body;
};

class DecodedNeighborhood {
 public:
  explicit DecodedNeighborhood(const baker::BakedNeighborhood& grid)
      : placement_{grid.size, {grid.bounds_min, grid.bounds_max}} {
    const transfer::TransferShape& of = grid.cells.at(0).transfers.at(0).shape;
    shape_ = {.order = static_cast<int>(of.order),
              .order_out = static_cast<int>(transfer::bandsOf(of.outputs)),
              .channels = 0};
    for (const baker::CodedCell& cell : grid.cells)
      if (cell.transfers.size() > 1) shape_.channels = cell.transfers[1].shape.full_channels;
    for (const baker::CodedCell& cell : grid.cells) {
      append(cell.transfers[0], visibility_);
      if (cell.transfers.size() > 1)
        append(cell.transfers[1], bounced_);
      else
        bounced_.resize(bounced_.size() + cell.count * shape_.bouncedSize(), 0.0f);
    }
  }

  const baker::ChangeShape& shape() const { return shape_; }
  const baker::GridPlacement& placement() const { return placement_; }
  std::span<const float> visibility(std::size_t point) const {
    return std::span(visibility_).subspan(point * shape_.visibilitySize(), shape_.visibilitySize());
  }
  std::span<const float> bounced(std::size_t point) const {
    return std::span(bounced_).subspan(point * shape_.bouncedSize(), shape_.bouncedSize());
  }

  // Returns what a receiver at this point gets, by trilinear interpolation.
  ChangeMatrix at(const glm::vec3& point, std::size_t channel = 0) const {
    const glm::vec3 place = (point - placement_.box.low) / placement_.spacing();
    std::vector<float> v(shape_.visibilitySize(), 0.0f), b(shape_.bouncedSize(), 0.0f);
    const glm::ivec3 first =
        glm::clamp(glm::ivec3(glm::floor(place)), glm::ivec3(0), glm::ivec3(placement_.size) - 2);
    const glm::vec3 part = place - glm::vec3(first);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 off(corner & 1, corner >> 1 & 1, corner >> 2);
      float weight = 1.0f;
      for (int a = 0; a < 3; ++a) weight *= off[a] ? part[a] : 1.0f - part[a];
      const glm::uvec3 node(first + off);
      const std::size_t index =
          node.x + std::size_t{placement_.size.x} * (node.y + std::size_t{placement_.size.y} * node.z);
      for (std::size_t i = 0; i < v.size(); ++i) v[i] += weight * visibility(index)[i];
      for (std::size_t i = 0; i < b.size(); ++i) b[i] += weight * bounced(index)[i];
    }
    return matrixOf(shape_, v, b, channel);
  }

 private:
  static void append(const baker::CodedTransfer& coded, std::vector<float>& all) {
    std::vector<std::vector<std::uint32_t>> codes;
    for (const baker::CodedPlane& plane : coded.planes) codes.push_back(plane.codes);
    const auto values =
        transfer::decodeTransfer(coded.shape, transfer::expand(coded.codebook), coded.cluster_of, codes);
    all.insert(all.end(), values.begin(), values.end());
  }

  baker::GridPlacement placement_;
  baker::ChangeShape shape_;
  std::vector<float> visibility_, bounced_;
};

// Returns the RMS, over lights and normals, of the change of irradiance by a matrix, relative to the light
// (an independent ChangeMeter).
inline double irradianceOf(const ChangeMatrix& matrix, int order, int order_out) {
  double sum = 0.0, light = 0.0;
  const auto columns = static_cast<std::size_t>(order * order);
  for (std::size_t i = 0; i < static_cast<std::size_t>(order_out * order_out); ++i) {
    const double out = sh::clampedCosine(sh::bandOf(static_cast<int>(i))) / std::numbers::pi;
    for (std::size_t j = 0; j < columns; ++j) {
      const double w =
          out * out * baker::kBandPower[static_cast<std::size_t>(sh::bandOf(static_cast<int>(j)))];
      sum += w * double{matrix[i * columns + j]} * double{matrix[i * columns + j]};
      if (i == j) light += w;
    }
  }
  return std::sqrt(sum / light);
}

struct NeighborhoodErrors {
  double rms = 0.0, p99 = 0.0;  // of irradiance
  double near_rms = 0.0;        // within half a radius of the unit sphere
  double of_change = 0.0;       // relative to the change, RMS over places where that exceeds 2 %
};

// Measures errors at random points of the box (default: the grid's) outside the unit sphere about the origin.
inline NeighborhoodErrors errorsAgainst(const DecodedNeighborhood& grid, std::optional<baker::Box3> box,
                                        int points,
                                        const std::function<ChangeMatrix(const glm::vec3&)>& truth) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  glm::vec3 low = grid.placement().box.low, high = grid.placement().box.high;
  if (box) low = glm::max(low, box->low), high = glm::min(high, box->high);
  const int order = grid.shape().order, order_out = grid.shape().order_out;
  std::vector<double> errors;
  double sum = 0.0, near = 0.0, changed = 0.0;
  int local_count = 0, changed_count = 0;
  while (static_cast<int>(errors.size()) < points) {
    const glm::vec3 p = glm::mix(low, high, glm::vec3(uniform(random), uniform(random), uniform(random)));
    if (glm::length(p) < 1.0f) continue;
    ChangeMatrix wrong = grid.at(p);
    const ChangeMatrix right = truth(p);
    for (std::size_t i = 0; i < wrong.size(); ++i) wrong[i] -= right[i];
    const double error = irradianceOf(wrong, order, order_out),
                 change = irradianceOf(right, order, order_out);
    errors.push_back(error);
    sum += error * error;
    if (glm::length(p) < 1.5f) near += error * error, ++local_count;
    if (change > 0.02) changed += std::pow(error / change, 2), ++changed_count;
  }
  std::sort(errors.begin(), errors.end());
  return {.rms = std::sqrt(sum / points),
          .p99 = errors[static_cast<std::size_t>(0.99 * points)],
          .near_rms = std::sqrt(near / std::max(local_count, 1)),
          .of_change = std::sqrt(changed / std::max(changed_count, 1))};
}

}  // namespace lambent::testing
