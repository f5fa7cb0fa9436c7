#include "baker/plan/effect_plan.hpp"

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

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include "baker/import/details.hpp"
#include "baker/plan/counted.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/plan/smooth_dielectrics.hpp"

namespace lambent::baker {

namespace {

// Comparisons of a face with a vertex; about as many take a second.
constexpr double kMostComparisons = 3e8;

using Triangle = std::array<glm::dvec3, 3>;

struct BodyBox {
  glm::dvec3 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};

  void add(const glm::dvec3& p) { low = glm::min(low, p), high = glm::max(high, p); }
  bool holds(const BodyBox& other) const {
    return glm::all(glm::lessThanEqual(low, other.low)) && glm::all(glm::lessThanEqual(other.high, high));
  }
};

// A Body is a group's surfaces in the group's frame.
struct Body {
  std::vector<glm::dvec3> points;
  std::vector<double> sizes;        // of what is coded together with each point, m
  std::vector<Triangle> triangles;  // counter-clockwise seen from outside
  double diagonal = 0.0;
};

Body bodyOf(const Scene& scene, const RigidGroup& group) {
  Body body;
  BodyBox all;
  for (const PlannedDraw& draw : group.draws) {
    const bundle::MeshData& mesh = scene.meshes[draw.mesh].primitives[draw.primitive].mesh;
    const auto place = [&](const glm::vec3& p) {
      return glm::dvec3(glm::dmat4(draw.group_from_mesh) * glm::dvec4(glm::dvec3(p), 1.0));
    };
    for (const glm::vec3& p : mesh.positions) {
      body.points.push_back(place(p));
      all.add(body.points.back());
    }
    const bool turned = draw.back != (glm::determinant(glm::mat3(draw.group_from_mesh)) < 0.0f);
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      Triangle triangle;
      for (std::size_t c = 0; c < 3; ++c) triangle[c] = place(mesh.positions[mesh.indices[i + c]]);
      if (turned) std::swap(triangle[1], triangle[2]);
      body.triangles.push_back(triangle);
    }
  }
  if (body.points.empty()) return body;
  body.diagonal = glm::distance(all.low, all.high);
  for (const PlannedDraw& draw : group.draws) {
    const bundle::MeshData& mesh = scene.meshes[draw.mesh].primitives[draw.primitive].mesh;
    const std::size_t first = body.sizes.size();
    body.sizes.resize(first + mesh.positions.size(), body.diagonal);
    const auto scale =
        static_cast<float>(std::cbrt(std::abs(glm::determinant(glm::dmat3(draw.group_from_mesh)))));
    if (!bends(static_cast<float>(0.2 * kLevel * body.diagonal), scale * detailOf(mesh))) continue;
    // It has a lattice of its own.
    BodyBox own;
    for (std::size_t i = first; i < body.sizes.size(); ++i) own.add(body.points[i]);
    std::fill(body.sizes.begin() + static_cast<std::ptrdiff_t>(first), body.sizes.end(),
              glm::distance(own.low, own.high));
  }
  return body;
}

struct Plane {
  glm::dvec3 normal{0.0};
  double offset = 0.0;

  double heightOf(const glm::dvec3& p) const { return glm::dot(normal, p) - offset; }
};

// Returns how far vertices stand above the planes of faces, relative to their sizes: the most, or the first
// that is more than kLevel, or -1 if there is too much to compare.
double heightAboveFaces(const Body& body) {
  if (body.points.empty()) return 0.0;
  const double level = kLevel * std::ranges::min(body.sizes);
  double highest = 0.0, compared = 0.0;
  Plane last;
  bool any = false;
  for (const Triangle& triangle : body.triangles) {
    const glm::dvec3 area = glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
    const double twice = glm::length(area);
    if (!(twice > 0.0)) continue;
    const Plane plane{area / twice, glm::dot(area / twice, triangle[0])};
    // Neighbours in a flat part of the surface share a plane.
    const auto in_last = [&](const glm::dvec3& p) { return std::abs(last.heightOf(p)) < 0.01 * level; };
    if (any && glm::dot(plane.normal, last.normal) > 0.0 && std::ranges::all_of(triangle, in_last)) continue;
    last = plane, any = true;
    compared += static_cast<double>(body.points.size());
    if (compared > kMostComparisons) return -1.0;
    for (std::size_t i = 0; i < body.points.size(); ++i) {
      if (body.sizes[i] > 0.0) highest = std::max(highest, plane.heightOf(body.points[i]) / body.sizes[i]);
      if (highest > kLevel) return highest;
    }
  }
  return highest;
}

// Returns a bound on what a surface of the material reflects of the light that arrives. Textures and colours
// of vertices only darken it.
double mostReflected(const Scene& scene, std::int32_t index) {
  if (index < 0) return 1.0;  // the default material is white
  const gltf::Material& material = scene.materials[static_cast<std::size_t>(index)];
  if (material.unlit) return 0.0;
  if (hasMatrices(material)) return 1.0;
  glm::vec3 albedo(material.base_color);
  if (isSmoothDielectric(material)) albedo = albedoUnderLayer(albedo, meanSpecularAlbedo(material));
  return std::clamp(double{std::max({albedo.r, albedo.g, albedo.b})}, 0.0, 1.0);
}

PlannedTransport transportOf(const Scene& scene, const RigidGroup& group) {
  PlannedTransport planned;
  if (group.volume >= 0) {
    planned.shadows_reason = "a medium hides light within itself";
    planned.bounces_reason = "a medium scatters light";
    return planned;
  }
  planned.height = heightAboveFaces(bodyOf(scene, group));
  planned.shadows = planned.height < 0.0 || planned.height > kLevel;
  planned.most_reflected = 0.0;
  for (const PlannedDraw& draw : group.draws)
    planned.most_reflected =
        std::max(planned.most_reflected,
                 mostReflected(scene, scene.meshes[draw.mesh].primitives[draw.primitive].material));
  planned.bounces = planned.shadows && planned.most_reflected > kBlack;
  if (planned.height < 0.0)
    planned.shadows_reason = "it has too many faces to prove that none sees another";
  else if (planned.shadows)
    planned.shadows_reason =
        fmt::format("a vertex lies {} of the group's size above a face", percentText(planned.height));
  else
    planned.shadows_reason = fmt::format(
        "no vertex lies above the plane of a face, to {} of the group's size", percentText(kLevel, 3));
  if (!planned.shadows)
    planned.bounces_reason = "no surface sees another";
  else
    planned.bounces_reason =
        fmt::format("its brightest surface reflects up to {} of light", percentText(planned.most_reflected));
  return planned;
}

}  // namespace

std::vector<PlannedTransport> planTransport(const Scene& scene, const std::vector<RigidGroup>& groups) {
  std::vector<PlannedTransport> planned;
  for (const RigidGroup& group : groups) planned.push_back(transportOf(scene, group));
  return planned;
}

namespace {

std::string nameOf(const Scene& scene, std::size_t node) {
  const std::string& name = scene.nodes[node].name;
  return name.empty() ? fmt::format("node {}", node) : name;
}

// Transfer holds for directions, so a group may turn and scale uniformly, but not be stretched.
bool stretches(const gltf::AnimationChannel& channel, const gltf::Node& node) {
  if (channel.path != gltf::AnimationChannel::Path::Scale) return false;
  const bool cubic = channel.interpolation == gltf::AnimationChannel::Interpolation::Cubic;
  const auto key = [&](std::size_t i) {
    const float* v = &channel.values[cubic ? 9 * i + 3 : 3 * i];
    return glm::dvec3(v[0], v[1], v[2]);
  };
  glm::dvec3 rest = node.trs ? glm::dvec3(node.trs->scale) : glm::dvec3(0.0);
  if (rest == glm::dvec3(0.0)) rest = key(0);
  for (std::size_t i = 0; i < channel.times_s.size(); ++i) {
    const glm::dvec3 scale = key(i);
    if (glm::length(glm::cross(rest, scale)) > 1e-4 * glm::length(rest) * glm::length(scale)) return true;
  }
  return false;
}

void addStretchedNodes(const Scene& scene, std::vector<std::string>& sentences) {
  for (const gltf::Animation& animation : scene.animations)
    for (const gltf::AnimationChannel& channel : animation.channels)
      if (stretches(channel, scene.nodes[channel.node]))
        sentences.push_back(
            fmt::format("An animation stretches {}: its transfer stays that of its shape at rest.",
                        nameOf(scene, channel.node)));
}

// Lists what this version does not carry yet, so that nobody has to find out by looking at the picture.
std::vector<std::string> leftOut(const Scene& scene, bool glossy) {
  std::vector<std::string> sentences = scene.warnings;
  const auto any_material = [&](auto test) {
    return std::any_of(scene.materials.begin(), scene.materials.end(), test);
  };
  if (!glossy && any_material([](const gltf::Material& m) { return !m.isDiffuse(); }))
    sentences.emplace_back(
        "Metallic and glossy reflection are left out: every material is Lambert with albedo = base color.");
  if (any_material([](const gltf::Material& m) { return m.alpha_mode == gltf::AlphaMode::Blend; }))
    sentences.emplace_back("Materials with alphaMode BLEND cast no shadow.");
  if (any_material([](const gltf::Material& m) { return m.transmits(); }))
    sentences.emplace_back(
        "Panes (KHR_materials_transmission) pass light straight on; shadows of key lights and lamps ignore "
        "them.");
  addStretchedNodes(scene, sentences);
  return sentences;
}

}  // namespace

EffectPlan makePlan(const Scene& scene, std::span<const EffectEntry> effects, bool with_insides) {
  EffectPlan plan;
  plan.groups = findRigidGroups(scene);
  if (!with_insides) leaveOutInsides(scene, plan.groups);
  for (const EffectEntry& entry : effects) plan.effects.push_back(entry.choose(scene, plan.groups));
  plan.transport = planTransport(scene, plan.groups);
  if (plan.bakes("neighborhood"))
    plan.neighborhoods = planNeighborhoods(scene, plan.groups);
  else
    plan.neighborhoods.resize(plan.groups.size());
  plan.light_probes = planLightProbes(scene, plan.groups, plan.neighborhoods);
  plan.left_out = leftOut(scene, plan.bakes("glossy"));
  return plan;
}

bool EffectPlan::bakes(std::string_view effect) const {
  return std::any_of(effects.begin(), effects.end(),
                     [&](const EffectChoice& choice) { return choice.effect == effect && choice.baked; });
}

namespace {

// Solid angles of triangles that are summed at most; about as many take a few seconds. Bodies that are not
// looked at keep both sides.
constexpr double kMostAngles = 3e7;
constexpr double kMostBoxes = 3e8;  // likewise, comparisons of boxes
// Points count as within a closed surface from this winding number on. It is 1 inside, 0 outside and
// something between on the surface.
constexpr double kWithin = 0.25;

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
  const CornerNumbers numbers = cornerNumbers(mesh.positions);
  if (numbers.of.empty()) return {};
  std::vector<CornerTriangle> triangles;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    triangles.push_back(
        {numbers.of[mesh.indices[i]], numbers.of[mesh.indices[i + 1]], numbers.of[mesh.indices[i + 2]]});

  std::vector<Part> all;
  for (const std::vector<std::size_t>& indices : connectedParts(triangles, numbers.places.size())) {
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
