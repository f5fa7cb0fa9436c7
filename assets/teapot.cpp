// Holds Newell's control points, grouped by what they share. Twenty-four of the patches belong to surfaces of
// revolution; each quadrant has the control polygon (r, 0), (r, -q), (q, -r), (0, -r), so a row is (r, q, z).
// Handle and spout are tubes of two mirrored halves, each with the control polygon (x0, 0, z0), (x0, -w, z0),
// (x1, -w, z1), (x1, 0, z1).
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

#include "assets/shapes.hpp"

namespace lambent::assets {

namespace {

struct TurnedRow {
  double r, q, z;
};
using TurnedPatch = std::array<TurnedRow, 4>;

// The rows lead from inside the rim over its edge, down the body and under the bottom; then over the lid from
// its setting. q is 0.56 r (a circle would take 0.5523), rounded where Newell rounded.
constexpr TurnedPatch kTurned[] = {
    {{{1.4, 0.784, 2.4}, {1.3375, 0.749, 2.53125}, {1.4375, 0.805, 2.53125}, {1.5, 0.84, 2.4}}},  // rim
    {{{1.5, 0.84, 2.4}, {1.75, 0.98, 1.875}, {2.0, 1.12, 1.35}, {2.0, 1.12, 0.9}}},     // upper body
    {{{2.0, 1.12, 0.9}, {2.0, 1.12, 0.45}, {1.5, 0.84, 0.225}, {1.5, 0.84, 0.15}}},     // lower body
    {{{1.5, 0.84, 0.15}, {1.5, 0.84, 0.075}, {1.425, 0.798, 0.0}, {0.0, 0.0, 0.0}}},    // bottom
    {{{0.0, 0.0, 3.15}, {0.8, 0.45, 3.15}, {0.0, 0.0, 2.85}, {0.2, 0.112, 2.7}}},       // setting of the lid
    {{{0.2, 0.112, 2.7}, {0.4, 0.224, 2.55}, {1.3, 0.728, 2.55}, {1.3, 0.728, 2.4}}}};  // lid

struct TubeRow {
  double x0, z0, x1, z1, w;
};
using TubePatch = std::array<TubeRow, 4>;

constexpr TubePatch kTubes[] = {{{{-1.6, 2.025, -1.5, 2.25, 0.3},
                                  {-2.3, 2.025, -2.5, 2.25, 0.3},
                                  {-2.7, 2.025, -3.0, 2.25, 0.3},
                                  {-2.7, 1.8, -3.0, 1.8, 0.3}}},  // upper handle
                                {{{-2.7, 1.8, -3.0, 1.8, 0.3},
                                  {-2.7, 1.575, -3.0, 1.35, 0.3},
                                  {-2.5, 1.125, -2.65, 0.9375, 0.3},
                                  {-2.0, 0.9, -1.9, 0.6, 0.3}}},  // lower handle
                                {{{1.7, 1.425, 1.7, 0.6, 0.66},
                                  {2.6, 1.425, 3.1, 0.825, 0.66},
                                  {2.3, 2.1, 2.4, 2.025, 0.25},
                                  {2.7, 2.4, 3.3, 2.4, 0.25}}},  // lower spout
                                {{{2.7, 2.4, 3.3, 2.4, 0.25},
                                  {2.8, 2.475, 3.525, 2.49375, 0.25},
                                  {2.9, 2.475, 3.45, 2.5125, 0.15},
                                  {2.8, 2.4, 3.2, 2.4, 0.15}}}};  // lip of the spout

// A Patch is indexed by [row along v][column along u]; du x dv points outside.
using Patch = std::array<std::array<glm::dvec3, 4>, 4>;

Patch turnedPatch(const TurnedPatch& rows, int quadrant) {
  Patch patch;
  for (std::size_t row = 0; row < 4; ++row) {
    const auto& [r, q, z] = rows[row];
    patch[row] = {glm::dvec3(r, 0, z), glm::dvec3(r, -q, z), glm::dvec3(q, -r, z), glm::dvec3(0, -r, z)};
    for (glm::dvec3& point : patch[row])
      for (int turn = 0; turn < quadrant; ++turn) point = glm::dvec3(point.y, -point.x, point.z);
  }
  return patch;
}

// Returns the half at y <= 0, or the other one: mirrored, with u reversed so that it still faces outside.
Patch tubePatch(const TubePatch& rows, bool mirrored) {
  Patch patch;
  for (std::size_t row = 0; row < 4; ++row) {
    const auto& [x0, z0, x1, z1, w] = rows[row];
    patch[row] = {glm::dvec3(x0, 0, z0), glm::dvec3(x0, -w, z0), glm::dvec3(x1, -w, z1),
                  glm::dvec3(x1, 0, z1)};
    if (mirrored)
      patch[row] = {glm::dvec3(x1, 0, z1), glm::dvec3(x1, w, z1), glm::dvec3(x0, w, z0),
                    glm::dvec3(x0, 0, z0)};
  }
  return patch;
}

using Weights = std::array<double, 4>;

Weights bernstein(double t) {
  const double s = 1 - t;
  return {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
}

Weights bernsteinSlope(double t) {
  const double s = 1 - t;
  return {-3 * s * s, 3 * s * s - 6 * s * t, 6 * s * t - 3 * t * t, 3 * t * t};
}

glm::dvec3 blend(const Patch& patch, const Weights& along_u, const Weights& along_v) {
  glm::dvec3 sum(0.0);
  for (std::size_t row = 0; row < 4; ++row)
    for (std::size_t column = 0; column < 4; ++column)
      sum += along_v[row] * along_u[column] * patch[row][column];
  return sum;
}

SurfacePoint pointOn(const Patch& patch, double u, double v) {
  constexpr double kPole = 1e-12;
  const Weights at_u = bernstein(u), slope_u = bernsteinSlope(u), slope_v = bernsteinSlope(v);
  glm::dvec3 du = blend(patch, slope_u, bernstein(v));
  const glm::dvec3 dv = blend(patch, at_u, slope_v);
  // Where a row shrinks to a point, du is 0; its rate of change along v, away from the pole, replaces it.
  if (glm::dot(du, du) < kPole) du = (v < 0.5 ? 1.0 : -1.0) * blend(patch, slope_u, slope_v);
  const glm::dvec3 position = blend(patch, at_u, bernstein(v)), normal = glm::normalize(glm::cross(du, dv));
  return {glm::vec3(position.x, position.z, -position.y),
          glm::vec3(normal.x, normal.z, -normal.y)};  // turns +Y up
}

}  // namespace

Mesh teapot(int cells, float height_m) {
  constexpr float kNewellHeight = 3.15f;
  std::vector<Patch> patches;
  for (const TurnedPatch& rows : kTurned)
    for (int quadrant = 0; quadrant < 4; ++quadrant) patches.push_back(turnedPatch(rows, quadrant));
  for (const TubePatch& rows : kTubes)
    for (const bool mirrored : {false, true}) patches.push_back(tubePatch(rows, mirrored));
  Mesh mesh;
  const glm::mat4 scale(glm::mat3(height_m / kNewellHeight));
  for (const Patch& patch : patches)
    append(mesh, surface(cells, cells, [&](double u, double v) { return pointOn(patch, u, v); }), scale);
  return mesh;
}

}  // namespace lambent::assets
