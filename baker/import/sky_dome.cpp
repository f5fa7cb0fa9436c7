// Finds sky domes that exporters leave in a scene. Viewers without light from outside need them as a
// backdrop; here they keep that light away.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "baker/import/convert.hpp"
#include "baker/import/details.hpp"

namespace lambent::baker {

namespace {

using Triangle = std::array<glm::dvec3, 3>;

template <typename Visit>
void forEachTriangle(const SceneMesh& mesh, const glm::dmat4& matrix, Visit visit) {
  for (const ScenePrimitive& primitive : mesh.primitives)
    for (std::size_t i = 0; i + 2 < primitive.mesh.indices.size(); i += 3) {
      Triangle triangle;
      for (std::size_t c = 0; c < 3; ++c)
        triangle[c] =
            glm::dvec3(matrix * glm::dvec4(primitive.mesh.positions[primitive.mesh.indices[i + c]], 1.0));
      visit(triangle);
    }
}

PlacedBox placed(const SceneMesh& mesh, const glm::dmat4& matrix) {
  PlacedBox box;
  forEachTriangle(mesh, matrix, [&](const Triangle& t) {
    for (const glm::dvec3& p : t) box.add(p);
  });
  return box;
}

bool isOpaque(const Scene& scene, const SceneMesh& mesh) {
  return std::ranges::all_of(mesh.primitives, [&](const ScenePrimitive& primitive) {
    return primitive.material < 0 ||
           scene.materials[static_cast<std::size_t>(primitive.material)].alpha_mode ==
               gltf::AlphaMode::Opaque;
  });
}

bool namesSky(std::string name) {
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name.find("sky") != std::string::npos || name.find("dome") != std::string::npos ||
         name.find("hdri") != std::string::npos;
}

// Returns whether most faces lie on the sphere that fits the corners best, in the mesh's own space, since
// domes are often flattened by their node. A hemisphere may have a floor.
bool isRound(const SceneMesh& mesh) {
  constexpr double kShare = 0.6, kInner = 0.85, kOuter = 1.05;  // of the area; of the radius
  // Solves |p|² = 2 c·p + k for c and k by least squares.
  const PlacedBox box = placed(mesh, glm::dmat4(1.0));
  const glm::dvec3 middle = box.center();
  const double size = box.diagonal();
  if (!(size > 0.0)) return false;
  glm::dmat4 left(0.0);
  glm::dvec4 right(0.0);
  double corners = 0.0;
  forEachTriangle(mesh, glm::dmat4(1.0), [&](const Triangle& t) {
    for (const glm::dvec3& corner : t) {
      const glm::dvec3 p = (corner - middle) / size;
      const glm::dvec4 row(2.0 * p, 1.0);
      left += glm::outerProduct(row, row);
      right += row * glm::dot(p, p);
      ++corners;
    }
  });
  left /= corners, right /= corners;
  if (std::abs(glm::determinant(left)) < 1e-9) return false;  // flat
  const glm::dvec4 fit = glm::inverse(left) * right;
  const glm::dvec3 centre(fit);
  const double radius = std::sqrt(std::max(fit.w + glm::dot(centre, centre), 0.0));
  double all = 0.0, on_sphere = 0.0;
  forEachTriangle(mesh, glm::dmat4(1.0), [&](const Triangle& t) {
    const double area = glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
    const double distance = glm::distance(((t[0] + t[1] + t[2]) / 3.0 - middle) / size, centre);
    all += area;
    if (distance > kInner * radius && distance < kOuter * radius) on_sphere += area;
  });
  return on_sphere > kShare * all;
}

bool hits(const Triangle& t, const glm::dvec3& from, const glm::dvec3& dir) {
  const glm::dvec3 a = t[0] - from, b = t[1] - from, c = t[2] - from;
  const double u = glm::dot(dir, glm::cross(a, b)), v = glm::dot(dir, glm::cross(b, c)),
               w = glm::dot(dir, glm::cross(c, a));
  if (!((u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0))) return false;
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  return glm::dot(normal, a) * glm::dot(normal, dir) > 0.0;
}

// Returns whether the mesh hides the whole sky above a point.
bool hidesTheSky(const SceneMesh& mesh, const glm::dmat4& world_from_mesh, const glm::dvec3& from) {
  constexpr int kDirections = 200;
  constexpr double kLowest = 0.03;  // sine of the lowest elevation
  std::array<bool, kDirections> hidden{};
  std::array<glm::dvec3, kDirections> directions;
  for (int i = 0; i < kDirections; ++i) {  // on a spiral of equal areas
    const double y = kLowest + (1.0 - kLowest) * (i + 0.5) / kDirections, r = std::sqrt(1.0 - y * y),
                 turn = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
    directions[static_cast<std::size_t>(i)] = {r * std::cos(turn), y, r * std::sin(turn)};
  }
  forEachTriangle(mesh, world_from_mesh, [&](const Triangle& t) {
    for (std::size_t i = 0; i < kDirections; ++i) hidden[i] = hidden[i] || hits(t, from, directions[i]);
  });
  return std::ranges::all_of(hidden, [](bool h) { return h; });
}

}  // namespace

void warnAboutDomes(Scene& scene) {
  constexpr double kLeastShare = 0.25;  // of the scene's size; the ground may be larger than the dome
  const std::vector<glm::mat4> world = gltf::worldTransforms(scene.nodes);
  std::vector<PlacedBox> boxes(scene.nodes.size());
  const auto around = [&](std::size_t but) {
    PlacedBox all;
    for (std::size_t n = 0; n < boxes.size(); ++n)
      if (n != but && !boxes[n].empty()) all.add(boxes[n].low), all.add(boxes[n].high);
    return all;
  };
  for (std::size_t n = 0; n < scene.nodes.size(); ++n)
    if (const std::int32_t mesh = scene.nodes[n].mesh; mesh >= 0)
      boxes[n] = placed(scene.meshes[static_cast<std::size_t>(mesh)], glm::dmat4(world[n]));
  const double size = around(boxes.size()).diagonal();
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    const gltf::Node& node = scene.nodes[n];
    if (node.mesh < 0 || boxes[n].diagonal() < kLeastShare * size) continue;
    const SceneMesh& mesh = scene.meshes[static_cast<std::size_t>(node.mesh)];
    if (!isOpaque(scene, mesh) || !(namesSky(node.name) || namesSky(mesh.name) || isRound(mesh))) continue;
    const PlacedBox rest = around(n);
    const glm::dvec3 middle = rest.center();
    if (!(rest.diagonal() > 0.0) || !boxes[n].contains(middle) ||
        !hidesTheSky(mesh, glm::dmat4(world[n]), middle))
      continue;
    scene.warnings.push_back(fmt::format(
        "node {} (\"{}\"): it lies around the scene and keeps all light from outside away; if it is a "
        "sky dome, delete it, and give its picture as --light",
        n, node.name));
    return;
  }
}

}  // namespace lambent::baker
