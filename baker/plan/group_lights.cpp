#include "baker/plan/group_lights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "baker/import/details.hpp"

namespace lambent::baker {

namespace {

// No face of a sphere-like part lies nearer to its center than this share of the farthest corner's distance.
// An icosahedron has 0.79, a cube has 0.58.
constexpr float kLeastRoundness = 0.7f;
// More triangles than a lamp has would take long for nothing.
constexpr std::size_t kMostTriangles = 200'000;

// Holds the emitting triangles of a material in a group.
struct Emitter {
  std::vector<glm::vec3> corners;
  std::vector<CornerTriangle> triangles;  // wound so that they emit towards the right hand
  bool both_sides = false;
};

// Returns the corners of the triangles, three for each, or nothing if there are too many.
std::vector<glm::vec3> cornersOf(const Scene& scene, const RigidGroup& group, std::uint32_t material) {
  std::vector<glm::vec3> corners;
  for (const PlannedDraw& draw : group.draws) {
    const ScenePrimitive& primitive = scene.meshes[draw.mesh].primitives[draw.primitive];
    if (draw.back || primitive.material != static_cast<std::int32_t>(material)) continue;
    if (corners.size() + primitive.mesh.indices.size() > 3 * kMostTriangles) return {};
    for (const std::uint32_t index : primitive.mesh.indices)
      corners.emplace_back(draw.group_from_mesh * glm::vec4(primitive.mesh.positions[index], 1.0f));
    if (glm::determinant(glm::mat3(draw.group_from_mesh)) >= 0.0f) continue;
    const std::size_t first = corners.size() - primitive.mesh.indices.size();
    for (std::size_t i = first; i + 2 < corners.size(); i += 3) std::swap(corners[i + 1], corners[i + 2]);
  }
  return corners;
}

Emitter emitterOf(const Scene& scene, const RigidGroup& group, std::uint32_t material) {
  CornerNumbers numbers = cornerNumbers(cornersOf(scene, group, material));
  Emitter emitter;
  emitter.both_sides = scene.materials[material].double_sided;
  for (std::size_t i = 0; i + 2 < numbers.of.size(); i += 3) {
    const CornerTriangle triangle = {numbers.of[i], numbers.of[i + 1], numbers.of[i + 2]};
    // Triangles without area, as at the poles of spheres, neither emit nor connect anything.
    if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
      emitter.triangles.push_back(triangle);
  }
  emitter.corners = std::move(numbers.places);
  return emitter;
}

// Returns the sphere of one part; its radius is 0 if the part is no sphere.
bundle::LampSphere sphereOf(const Emitter& emitter, const std::vector<std::size_t>& part) {
  if (part.size() < 8 || !isClosed(emitter.triangles, part)) return {};
  const auto corner = [&](std::size_t t, std::size_t c) {
    return glm::dvec3(emitter.corners[emitter.triangles[t][c]]);
  };
  // The center is that of the surface, so it does not depend on how it is divided.
  glm::dvec3 center(0.0);
  double area = 0.0;
  for (const std::size_t t : part) {
    const double twice = glm::length(glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)));
    center += twice / 6.0 * (corner(t, 0) + corner(t, 1) + corner(t, 2));
    area += 0.5 * twice;
  }
  if (!(area > 0.0)) return {};
  center /= area;
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0.0;
  int outwards = 0, inwards = 0;
  for (const std::size_t t : part) {
    const glm::dvec3 normal = glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
    const double length = glm::length(normal);
    for (std::size_t c = 0; c < 3; ++c) farthest = std::max(farthest, glm::distance(center, corner(t, c)));
    if (!(length > 0.0)) continue;
    const double height = glm::dot(normal / length, corner(t, 0) - center);
    ++(height > 0.0 ? outwards : inwards);
    nearest = std::min(nearest, std::abs(height));
  }
  const bool even = inwards == 0 || (emitter.both_sides && outwards == 0);
  if (!even || !(nearest >= double{kLeastRoundness} * farthest)) return {};
  const double radius = std::sqrt(area / (4.0 * std::numbers::pi));
  return {.center = glm::vec3(center),
          .radius_m = static_cast<float>(radius),
          .body_radius_m = static_cast<float>(std::max(radius, farthest))};
}

bool isLit(glm::vec3 color) {
  return color.r > 0.0f || color.g > 0.0f || color.b > 0.0f;
}

using Cell = glm::vec<3, std::int64_t>;
struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t hash = 0;
    for (const std::int64_t part : {cell.x, cell.y, cell.z})
      hash = (hash ^ static_cast<std::uint64_t>(part)) * 0x9e3779b97f4a7c15ull, hash ^= hash >> 29;
    return static_cast<std::size_t>(hash);
  }
};

}  // namespace

CornerNumbers cornerNumbers(std::span<const glm::vec3> positions) {
  constexpr double kSameCorner = 1e-5;  // of the diagonal
  CornerNumbers numbers;
  if (positions.empty()) return numbers;
  glm::vec3 low = positions[0], high = low;
  for (const glm::vec3& p : positions) low = glm::min(low, p), high = glm::max(high, p);
  const double tolerance = kSameCorner * glm::distance(glm::dvec3(low), glm::dvec3(high));
  if (!(tolerance > 0.0) || !std::isfinite(tolerance)) return numbers;
  std::unordered_map<Cell, std::uint32_t, CellHash> cells;
  // Returns the number of an earlier place that is as near as the tolerance, else a new one.
  const auto numberOf = [&](const glm::vec3& place) {
    const Cell at(glm::floor(glm::dvec3(place) / tolerance));
    for (std::int64_t x = -1; x <= 1; ++x)
      for (std::int64_t y = -1; y <= 1; ++y)
        for (std::int64_t z = -1; z <= 1; ++z)
          if (const auto found = cells.find(at + Cell(x, y, z));
              found != cells.end() &&
              glm::distance(glm::dvec3(numbers.places[found->second]), glm::dvec3(place)) <= tolerance)
            return found->second;
    numbers.places.push_back(place);
    return cells[at] = static_cast<std::uint32_t>(numbers.places.size() - 1);
  };
  for (const glm::vec3& p : positions) numbers.of.push_back(numberOf(p));
  return numbers;
}

std::vector<bundle::LampSphere> findLampSpheres(const Scene& scene, const RigidGroup& group,
                                                std::uint32_t material) {
  if (scene.materials[material].emissive_texture.texture >= 0) return {};
  const Emitter emitter = emitterOf(scene, group, material);
  const std::vector<std::vector<std::size_t>> parts =
      connectedParts(emitter.triangles, emitter.corners.size());
  if (parts.size() > bundle::kMaxLampSpheres) return {};
  std::vector<bundle::LampSphere> spheres;
  for (const std::vector<std::size_t>& part : parts) {
    spheres.push_back(sphereOf(emitter, part));
    if (!(spheres.back().radius_m > 0.0f)) return {};
  }
  return spheres;
}

std::int32_t groupRootOf(const Scene& scene, std::uint32_t node) {
  auto at = static_cast<std::int32_t>(node);
  while (at >= 0) {
    const gltf::Node& here = scene.nodes[static_cast<std::size_t>(at)];
    if (startsRigidGroup(here)) return at;
    at = here.parent;
  }
  return -1;
}

std::vector<PlannedLight> findGroupLights(const Scene& scene, const RigidGroup& group) {
  std::vector<PlannedLight> lights;
  for (const PlannedDraw& draw : group.draws) {
    const std::int32_t material = scene.meshes[draw.mesh].primitives[draw.primitive].material;
    if (material < 0) continue;
    const auto index = static_cast<std::uint32_t>(material);
    const gltf::Material& source = scene.materials[index];
    const bool known = std::any_of(lights.begin(), lights.end(),
                                   [&](const PlannedLight& light) { return light.index == index; });
    // Blended surfaces cast no shadow and rays miss them, so their light is only visible directly.
    if (!known && !source.unlit && source.alpha_mode != gltf::AlphaMode::Blend && isLit(source.emissive))
      lights.push_back({PlannedLight::Kind::Material, index, source.emissive, glm::mat4(1.0f),
                        findLampSpheres(scene, group, index)});
  }
  const std::vector<glm::mat4> world = gltf::worldTransforms(scene.nodes);
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].light < 0 || groupRootOf(scene, n) != group.root) continue;
    const gltf::Light& light = scene.lights[static_cast<std::size_t>(scene.nodes[n].light)];
    const glm::vec3 color = light.intensity * light.color;
    if (!isLit(color) || light.type == gltf::Light::Type::Directional) continue;
    lights.push_back({PlannedLight::Kind::Node, n, color, groupFromNode(scene, group, n, world), {}});
  }
  return lights;
}

std::vector<bool> shadedPerPixel(std::span<const PlannedLight> lights) {
  // runtime/lighting/local_light.hpp has so many.
  constexpr std::ptrdiff_t kShadowCubes = 8;
  std::vector<bool> shaded;
  for (const PlannedLight& light : lights)
    shaded.push_back(light.kind == PlannedLight::Kind::Node || !light.spheres.empty());
  if (std::ranges::count(shaded, true) > kShadowCubes) shaded.assign(lights.size(), false);
  return shaded;
}

}  // namespace lambent::baker
