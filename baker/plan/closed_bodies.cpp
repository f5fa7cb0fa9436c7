#include "baker/plan/closed_bodies.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "baker/import/details.hpp"
#include "baker/plan/corner_numbers.hpp"

namespace lambent::baker {

namespace {

// Solid angles of triangles that are summed at most; about as many take a few seconds. Bodies that are not
// looked at keep both sides.
constexpr double kMostAngles = 3e7;
constexpr double kMostBoxes = 3e8;  // likewise, comparisons of boxes
// Points count as within a closed surface from this winding number on. It is 1 inside, 0 outside and
// something between on the surface.
constexpr double kWithin = 0.25;

struct BodyBox {
  glm::dvec3 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};

  void add(const glm::dvec3& p) { low = glm::min(low, p), high = glm::max(high, p); }
  bool holds(const BodyBox& other) const {
    return glm::all(glm::lessThanEqual(low, other.low)) && glm::all(glm::lessThanEqual(other.high, high));
  }
};

// A Part is a connected part of a primitive, with vertices of the mesh.
struct Part {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> vertices;
  bool closed = true;  // each edge is shared by faces that wind alike, and the body lies behind the faces
};

// Returns six times the volume (Gauss's theorem), which is below 0 where faces wind the other way.
double signedVolume(const Part& part, const std::vector<glm::vec3>& positions) {
  const glm::dvec3 origin(positions[part.triangles[0][0]]);
  double volume = 0.0;
  for (const auto& [a, b, c] : part.triangles)
    volume += glm::dot(glm::dvec3(positions[a]) - origin,
                       glm::cross(glm::dvec3(positions[b]) - origin, glm::dvec3(positions[c]) - origin));
  return volume;
}

std::vector<Part> partsOfMesh(const bundle::MeshData& mesh) {
  BodyBox box;
  for (const glm::vec3& p : mesh.positions) box.add(glm::dvec3(p));
  const double tolerance = kSameCorner * glm::distance(box.low, box.high);
  if (!(tolerance > 0.0) || !std::isfinite(tolerance)) return {};
  CornerNumbers numbers(tolerance);
  std::vector<std::uint32_t> corner_of;
  for (const glm::vec3& p : mesh.positions) corner_of.push_back(numbers.numberOf(p));
  std::vector<CornerTriangle> triangles;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    triangles.push_back(
        {corner_of[mesh.indices[i]], corner_of[mesh.indices[i + 1]], corner_of[mesh.indices[i + 2]]});

  std::vector<Part> all;
  for (const std::vector<std::size_t>& indices : connectedParts(triangles, numbers.places().size())) {
    Part& part = all.emplace_back();
    for (const std::size_t t : indices)
      part.triangles.push_back({mesh.indices[3 * t], mesh.indices[3 * t + 1], mesh.indices[3 * t + 2]});
    part.closed = isClosed(triangles, indices) && signedVolume(part, mesh.positions) > 0.0;
    for (const auto& triangle : part.triangles)
      part.vertices.insert(part.vertices.end(), triangle.begin(), triangle.end());
    std::ranges::sort(part.vertices);
    part.vertices.erase(std::unique(part.vertices.begin(), part.vertices.end()), part.vertices.end());
  }
  return all;
}

// Returns how often the surface winds around a point (Van Oosterom and Strackee 1983).
double windingNumber(const std::vector<std::array<glm::dvec3, 3>>& triangles, const glm::dvec3& point) {
  double angle = 0.0;
  for (const auto& triangle : triangles) {
    const glm::dvec3 a = triangle[0] - point, b = triangle[1] - point, c = triangle[2] - point;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    angle += 2.0 * std::atan2(glm::dot(a, glm::cross(b, c)),
                              la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  return std::abs(angle) / (4.0 * std::numbers::pi);  // a node that mirrors turns the sign
}

// A Thing may stand within a body: a part of a surface, a camera, a lamp or a volume's middle.
struct Thing {
  BodyBox box;
  std::vector<glm::dvec3> points;                    // world
  std::vector<std::array<glm::dvec3, 3>> triangles;  // of a closed part that may be a body
  bool closed = false;

  void add(const glm::dvec3& point) { points.push_back(point), box.add(point); }
};

struct Surface {
  std::size_t group = 0, draw = 0;
  std::size_t first_part = 0, end_part = 0;  // among the things
  bool double_sided = false;                 // opaque besides, and dark
};

bool mayLoseItsBack(const Scene& scene, std::int32_t index) {
  if (index < 0) return false;
  const gltf::Material& material = scene.materials[static_cast<std::size_t>(index)];
  return material.double_sided && material.alpha_mode == gltf::AlphaMode::Opaque &&
         material.emissive == glm::vec3(0.0f);
}

class Insides {
 public:
  Insides(const Scene& scene, const std::vector<RigidGroup>& groups)
      : scene_(scene), world_(gltf::worldTransforms(scene.nodes)) {
    for (std::size_t g = 0; g < groups.size(); ++g)
      for (std::size_t d = 0; d < groups[g].draws.size(); ++d)
        if (!groups[g].draws[d].back) addSurface({.group = g, .draw = d}, groups[g].draws[d]);
    for (std::size_t n = 0; n < scene.nodes.size(); ++n)
      if (scene.nodes[n].camera >= 0 || hasPlacedLight(scene.nodes[n])) addPoint(n);
    for (const SceneVolume& volume : scene.volumes) addPoint(volume.node);
  }

  // Returns the surfaces of which only the outside can be seen.
  std::vector<Surface> unseen() {
    std::vector<Surface> found;
    for (const Surface& surface : surfaces_)
      if (surface.double_sided && isClosed(surface) && enclosesNothing(surface)) found.push_back(surface);
    return found;
  }

 private:
  bool hasPlacedLight(const gltf::Node& node) const {
    return node.light >= 0 &&
           scene_.lights[static_cast<std::size_t>(node.light)].type != gltf::Light::Type::Directional;
  }

  void addPoint(std::size_t node) { things_.emplace_back().add(glm::dvec3(world_[node][3])); }

  void addSurface(Surface surface, const PlannedDraw& draw) {
    const ScenePrimitive& primitive = scene_.meshes[draw.mesh].primitives[draw.primitive];
    surface.double_sided = mayLoseItsBack(scene_, primitive.material);
    auto& parts = parts_[{draw.mesh, draw.primitive}];
    if (!parts) parts = partsOfMesh(primitive.mesh);
    if (parts->empty()) surface.double_sided = false;
    surface.first_part = things_.size();
    const glm::dmat4 world_from_mesh(world_[draw.node]);
    const auto place = [&](std::uint32_t v) {
      return glm::dvec3(world_from_mesh * glm::dvec4(glm::dvec3(primitive.mesh.positions[v]), 1.0));
    };
    for (const Part& part : *parts) {
      Thing& thing = things_.emplace_back();
      thing.closed = part.closed;
      for (const std::uint32_t v : part.vertices) thing.add(place(v));
      if (surface.double_sided && part.closed)
        for (const auto& [a, b, c] : part.triangles)
          thing.triangles.push_back({place(a), place(b), place(c)});
    }
    surface.end_part = things_.size();
    surfaces_.push_back(surface);
  }

  std::span<const Thing> partsOf(const Surface& surface) const {
    return std::span(things_).subspan(surface.first_part, surface.end_part - surface.first_part);
  }

  bool isClosed(const Surface& surface) const {
    return std::ranges::all_of(partsOf(surface), &Thing::closed);
  }

  bool enclosesNothing(const Surface& surface) {
    return std::ranges::none_of(partsOf(surface), [&](const Thing& body) {
      boxes_ += static_cast<double>(things_.size());
      return boxes_ > kMostBoxes || std::ranges::any_of(things_, [&](const Thing& thing) {
               return &thing != &body && body.box.holds(thing.box) && standsWithin(thing, body);
             });
    });
  }

  // A thing that only reaches into a body is hidden where it does.
  bool standsWithin(const Thing& thing, const Thing& body) {
    return std::ranges::all_of(thing.points, [&](const glm::dvec3& point) {
      angles_ += static_cast<double>(body.triangles.size());
      return angles_ > kMostAngles || windingNumber(body.triangles, point) > kWithin;
    });
  }

  const Scene& scene_;
  std::vector<glm::mat4> world_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::optional<std::vector<Part>>> parts_;
  std::vector<Surface> surfaces_;
  std::vector<Thing> things_;
  double angles_ = 0.0, boxes_ = 0.0;
};

}  // namespace

void leaveOutInsides(const Scene& scene, std::vector<RigidGroup>& groups) {
  const auto may = [&](const PlannedDraw& draw) {
    return draw.back && mayLoseItsBack(scene, scene.meshes[draw.mesh].primitives[draw.primitive].material);
  };
  if (std::ranges::none_of(groups,
                           [&](const RigidGroup& group) { return std::ranges::any_of(group.draws, may); }))
    return;
  std::set<std::pair<std::size_t, std::size_t>> gone;  // group and draw, whose next draw is the back
  for (const Surface& surface : Insides(scene, groups).unseen()) gone.insert({surface.group, surface.draw});
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<PlannedDraw> kept;
    for (std::size_t d = 0; d < groups[g].draws.size(); ++d)
      if (!groups[g].draws[d].back || d == 0 || !gone.contains({g, d - 1}))
        kept.push_back(groups[g].draws[d]);
    groups[g].draws = std::move(kept);
  }
}

}  // namespace lambent::baker
