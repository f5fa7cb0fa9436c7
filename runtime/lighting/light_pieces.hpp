// Gathers points of light into pieces that are small enough to be represented by one disc each. It takes
// points of luminous flux on the sphere and returns the pieces that SH bands would lose most, each with the
// position and size of the disc that has its flux and its first moment. Points that are far from all pieces
// belong to none. The same points in the same order give the same pieces. Pure CPU, safe to call from any
// thread.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/lighting/light_loss.hpp"

namespace lambent::lighting {

struct LightPoint {
  glm::dvec3 dir;
  double flux = 0.0;  // luminous; at least 0
  FluxGrid::Place at;
};

// Sums the flux and first moment of some points, from which the disc that represents them is made.
struct LightMoment {
  double flux = 0.0;
  glm::dvec3 moment{0.0};

  void add(const glm::dvec3& dir, double more) {
    flux += more;
    moment += more * dir;
  }
  glm::dvec3 direction() const;  // Y if the points cancel out
  // Returns the radius of the uniform disc with this flux and first moment: |moment| / flux = (1 + cos
  // radius) / 2. For small discs it also has the same second moment.
  double radius() const;
};

struct LightPiece {
  glm::dvec3 dir;
  double flux = 0.0;
  double radius_rad = 0.0;
};

struct PieceLimits {
  int order = 5;             // pieces are ranked by their loss at this order
  std::size_t most = 16;     // maximum number of pieces
  double radius_rad = 0.14;  // a piece consists of points within this radius of its centre
  double least_flux = 0.0;   // weaker pieces are left out
};

// Returns the nearest piece to a direction, or nothing if it is much farther than limits.radius_rad.
std::optional<std::size_t> pieceOf(std::span<const LightPiece> pieces, const PieceLimits& limits,
                                   const glm::dvec3& dir);

// Returns pieces ordered by falling loss.
std::vector<LightPiece> gatherPieces(std::span<const LightPoint> points, const PieceLimits& limits);

double solidAngle(double radius_rad);  // of a disc

// Returns points spread evenly over a uniform disc, at most a degree apart, each with the same share of its
// flux.
std::vector<LightPoint> discPoints(const LightPiece& disc);
// Adds these points to a grid, times a factor.
void addDisc(FluxGrid& grid, const LightPiece& disc, double factor = 1.0);

struct DiscPiece {
  LightPiece piece;
  std::vector<LightPoint> points;  // points of the part of the disc that it represents
};
struct DiscDivision {
  double radius_rad = 0.14;  // of a piece, approximate
  std::size_t most = 16;     // maximum number of pieces, at least 3
  double allowed = 0.0;      // flux: more pieces are used until their round shapes lose no more than this
};
// Divides a uniform disc into pieces of about equal size.
std::vector<DiscPiece> dividedDisc(const LightPiece& disc, const DiscDivision& division);

}  // namespace lambent::lighting
