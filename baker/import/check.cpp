#include "baker/import/check.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "baker/import/convert.hpp"
#include "baker/import/details.hpp"
#include "baker/import/scene_files.hpp"
#include "baker/import/texture_transfer.hpp"
#include "runtime/bundle/material_fields.hpp"

namespace lambent::baker {

namespace {

std::optional<Object> extension(const Object& object, const char* name) {
  const auto extensions = object.object("extensions");
  return extensions ? extensions->object(name) : std::nullopt;
}

// Returns the object that contains a field of a material, if there is one.
std::optional<Object> placeOf(const Object& material, const gltf::MaterialJson& field) {
  const auto [outer, inner] = field.objects;
  if (!outer) return material;
  const auto place = material.object(outer);
  return place && inner ? place->object(inner) : place;
}

void checkTexture(const Object& owner, const char* key, const Root& root) {
  if (const auto info = owner.object(key)) info->index("index", root.size("textures"), "textures");
}

}  // namespace

bool readsExtension(std::string_view name) {
  // Textures of the last four are read if their image can be decoded, and have warnings of their own.
  constexpr std::array<std::string_view, 12> kBesideMaterials{"KHR_draco_mesh_compression",
                                                              "KHR_mesh_quantization",
                                                              "KHR_texture_transform",
                                                              "EXT_meshopt_compression",
                                                              "EXT_mesh_gpu_instancing",
                                                              "KHR_lights_punctual",
                                                              "KHR_materials_emissive_strength",
                                                              "KHR_materials_pbrSpecularGlossiness",
                                                              "EXT_texture_webp",
                                                              "EXT_texture_avif",
                                                              "MSFT_texture_dds",
                                                              "KHR_texture_basisu"};
  bool found = std::ranges::find(kBesideMaterials, name) != kBesideMaterials.end();
  gltf::forEachMaterialField([&](const auto& row) {
    const auto [outer, inner] = row.json.objects;
    found |= inner != nullptr && outer == std::string_view("extensions") && inner == name;
  });
  return found;
}

void checkMaterial(const Object& material, const Root& root) {
  gltf::forEachMaterialTexture([&](const auto& row) {
    if (const auto place = placeOf(material, row.json)) checkTexture(*place, row.json.key, root);
  });
  if (const auto glossiness = extension(material, "KHR_materials_pbrSpecularGlossiness"))
    for (const char* key : {"diffuseTexture", "specularGlossinessTexture"})
      checkTexture(*glossiness, key, root);
  // `extras` may be anything; only what stands under our own name is ours.
  if (const nlohmann::json& ours = memberOf(material.json, {"extras", "lambent"}); ours.is_object())
    Object{ours, material.name + ": extras: lambent"}.text("brdf");
}

void checkNodeExtensions(const Object& node, const Root& root) {
  if (const auto light = extension(node, "KHR_lights_punctual")) {
    const auto lights = extension(root.object, "KHR_lights_punctual");
    if (!light->index("light", lights ? lights->list("lights").size() : 0, "lights"))
      throw BrokenField{fmt::format("{} names no light", light->name)};
  }
  if (const auto instances = extension(node, "EXT_mesh_gpu_instancing")) {
    const auto attributes = instances->object("attributes");
    if (!attributes) throw BrokenField{fmt::format("{} has no attributes", instances->name)};
    for (const auto& item : attributes->json.items())
      attributes->index(item.key().c_str(), root.size("accessors"), "accessors");
  }
}

namespace {

void checkAsset(const Root& root) {
  const auto asset = root.object.object("asset");
  const std::string version = asset ? asset->text("version") : std::string();
  if (version.empty()) throw BrokenField{"is not glTF: no asset.version"};
  const std::string minimum = asset->text("minVersion");
  if (!version.starts_with("2.") || !(minimum.empty() || minimum == "2.0"))
    throw BrokenField{
        fmt::format("needs glTF {}, this program reads 2.0", minimum.empty() ? version : minimum),
        "export the scene as glTF 2.0"};
}

// Returns whether bytes of vertices or indices lie where only the extension finds or decodes them: it is used
// by a buffer, view or accessor, or by a primitive that has no such bytes.
bool holdsGeometry(const std::string& name, const Root& root) {
  const auto uses = [&](const nlohmann::json& object) {
    return !memberOf(object, {"extensions", name.c_str()}).is_null();
  };
  for (const char* key : {"buffers", "bufferViews", "accessors"})
    if (std::ranges::any_of(root.object.list(key), uses)) return true;
  const nlohmann::json& accessors = root.object.list("accessors");
  const auto lacksBytes = [&](const nlohmann::json& owner, const char* key) {
    if (!owner.is_object() || !owner.contains(key)) return false;
    const std::size_t i = owner[key].is_number_unsigned() ? owner[key].get<std::size_t>() : accessors.size();
    return i < accessors.size() && !accessors[i].contains("bufferView") && !accessors[i].contains("sparse");
  };
  bool found = false;
  root.forEach("meshes", "mesh", [&](const Object& mesh) {
    for (const nlohmann::json& primitive : mesh.list("primitives"))
      if (uses(primitive)) {
        const nlohmann::json attributes = primitive.value("attributes", nlohmann::json::object());
        found |= !attributes.contains("POSITION") || lacksBytes(attributes, "POSITION") ||
                 lacksBytes(primitive, "indices");
      }
  });
  return found;
}

void checkExtensions(const Root& root) {
  for (const nlohmann::json& entry : root.object.list("extensionsRequired")) {
    const std::string name = entry.is_string() ? entry.get<std::string>() : entry.dump();
    if (!readsExtension(name) && holdsGeometry(name, root))
      throw BrokenField{fmt::format("has geometry that only the extension {} can decode", name),
                        "export the scene without it"};
  }
}

void checkDraco(const Object& draco, const Root& root) {
  if (!draco.index("bufferView", root.size("bufferViews"), "bufferViews"))
    throw BrokenField{fmt::format("{} has no bufferView", draco.name)};
  const auto attributes = draco.object("attributes");
  if (!attributes) throw BrokenField{fmt::format("{} has no attributes", draco.name)};
  for (const auto& [key, value] : attributes->json.items())
    if (attributes->toNumber(value, key) > 0xffff)
      throw BrokenField{fmt::format("{}: {} has a wild attribute id", draco.name, key)};
}

void checkPrimitive(const Object& primitive, const Root& root) {
  const std::size_t accessors = root.size("accessors");
  const auto attributes = primitive.object("attributes");
  if (!attributes) throw BrokenField{fmt::format("{} has no attributes", primitive.name)};
  for (const auto& item : attributes->json.items())
    attributes->index(item.key().c_str(), accessors, "accessors");
  const auto indices = primitive.index("indices", accessors, "accessors");
  primitive.index("material", root.size("materials"), "materials");
  checkTextureTransfer(primitive);
  if (primitive.number("mode").value_or(4) > 6)
    throw BrokenField{fmt::format("{} has an unknown mode", primitive.name)};
  const auto extensions = primitive.object("extensions");
  const auto draco = extensions ? extensions->object("KHR_draco_mesh_compression") : std::nullopt;
  if (draco) checkDraco(*draco, root);
  // Indices that are all zero would be triangles without area.
  if (indices && !draco && !root.object.list("accessors")[*indices].contains("bufferView") &&
      !root.object.list("accessors")[*indices].contains("sparse"))
    throw BrokenField{fmt::format("accessor {} holds indices but has no bufferView", *indices)};
  std::size_t t = 0;
  for (const nlohmann::json& entry : primitive.list("targets")) {
    const Object target{entry, fmt::format("{}, morph target {}", primitive.name, t++)};
    if (!entry.is_object()) throw BrokenField{fmt::format("{} is not an object", target.name)};
    for (const auto& item : entry.items()) target.index(item.key().c_str(), accessors, "accessors");
  }
}

void checkMaterials(const Root& root) {
  root.forEach("images", "image", [&](const Object& image) {
    image.index("bufferView", root.size("bufferViews"), "bufferViews");
  });
  root.forEach("textures", "texture", [&](const Object& texture) {
    texture.index("source", root.size("images"), "images");
    texture.index("sampler", root.size("samplers"), "samplers");
  });
  root.forEach("materials", "material", [&](const Object& material) { checkMaterial(material, root); });
}

void checkMeshes(const Root& root) {
  root.forEach("meshes", "mesh", [&](const Object& mesh) {
    std::size_t i = 0;
    checkNumbers(mesh, "weights");
    checkTextureTransfer(mesh);
    for (const nlohmann::json& primitive : mesh.list("primitives"))
      checkPrimitive({primitive, fmt::format("{}, primitive {}", mesh.name, i++)}, root);
  });
}

}  // namespace

Result<void> checkDocument(nlohmann::json& document, const std::string& file,
                           std::vector<std::string>& warnings) {
  try {
    const Entry entry{document, "the document", warnings};
    for (const auto mend :
         {mendCameras, mendMembers, mendMaterials, mendLights, mendPrimitives, mendAnimations, mendUnused})
      mend(entry);
    const Root root{{document, "the document"}};
    checkAsset(root);
    checkExtensions(root);
    checkBuffers(root);
    checkMaterials(root);
    checkMeshes(root);
    checkNodes(root);
    return {};
  } catch (const BrokenField& broken) {
    return fail(file, broken.problem, broken.hint);
  } catch (const nlohmann::json::exception& exception) {
    return fail(file, fmt::format("is not glTF 2.0 ({})", reasonOf(exception)), BrokenField{}.hint);
  }
}

// Refuses scenes with sizes that single precision cannot trace.

namespace {

// Areas are products of two lengths and their squares of four, which must neither underflow nor overflow.
// Both limits leave a factor of ten to where tracing was seen to fail.
constexpr double kLeastSide_m = 1e-8, kMostDistance_m = 1e8;

}  // namespace

Result<void> checkSizes(const Document& document, const NodeMap& map, const Scene& scene) {
  std::vector<PlacedBox> boxes;
  for (const SceneMesh& mesh : scene.meshes) boxes.push_back(boxOf(mesh));
  const std::vector<glm::dmat4> world = sceneWorldTransforms(map, scene);
  // The farthest place of each node and those above it: if two cancel each other out, digits are lost.
  std::vector<double> farthest(world.size());
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    farthest[n] = largest(glm::dvec3(world[n][3]));
    if (const std::int32_t parent = scene.nodes[n].parent; parent >= 0)
      farthest[n] = std::max(farthest[n], farthest[static_cast<std::size_t>(parent)]);
    if (scene.nodes[n].mesh < 0) continue;
    const PlacedBox& box = boxes[static_cast<std::size_t>(scene.nodes[n].mesh)];
    if (box.empty()) continue;
    PlacedBox there;
    there.add(box, world[n]);
    const double distance = std::max({largest(there.low), largest(there.high), farthest[n]});
    if (!(distance <= kMostDistance_m))  // or not a number
      return fail(
          document.file(),
          fmt::format("node {} (\"{}\") reaches {:.3g} m from the origin, where floats cannot be traced", n,
                      scene.nodes[n].name, distance),
          fmt::format("scale or move it to within {:g} m", kMostDistance_m));
    if (there.side() > 0.0 && there.side() < kLeastSide_m)
      return fail(document.file(),
                  fmt::format("node {} (\"{}\") is only {:.3g} m large, which floats cannot trace", n,
                              scene.nodes[n].name, there.side()),
                  fmt::format("scale it to {:g} m or more, or to 0 to hide it", kLeastSide_m));
  }
  return {};
}

// Finds sky domes that exporters leave in a scene. Viewers without light from outside need them as a
// backdrop; here they keep that light away.

namespace {

struct Bounds {
  glm::dvec3 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};
  void add(const glm::dvec3& p) { low = glm::min(low, p), high = glm::max(high, p); }
  bool contains(const glm::dvec3& p) const {
    return glm::all(glm::lessThan(low, p)) && glm::all(glm::lessThan(p, high));
  }
  double size() const { return low.x > high.x ? 0.0 : glm::distance(low, high); }
};

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
  Bounds bounds;
  forEachTriangle(mesh, glm::dmat4(1.0), [&](const Triangle& t) {
    for (const glm::dvec3& p : t) bounds.add(p);
  });
  const glm::dvec3 middle = 0.5 * (bounds.low + bounds.high);
  const double size = bounds.size();
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
  std::vector<Bounds> bounds(scene.nodes.size());
  Bounds all;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n)
    if (const std::int32_t mesh = scene.nodes[n].mesh; mesh >= 0)
      forEachTriangle(scene.meshes[static_cast<std::size_t>(mesh)], glm::dmat4(world[n]),
                      [&](const Triangle& t) {
                        for (const glm::dvec3& p : t) bounds[n].add(p), all.add(p);
                      });
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    const gltf::Node& node = scene.nodes[n];
    if (node.mesh < 0 || bounds[n].size() < kLeastShare * all.size()) continue;
    const SceneMesh& mesh = scene.meshes[static_cast<std::size_t>(node.mesh)];
    if (!isOpaque(scene, mesh) || !(namesSky(node.name) || namesSky(mesh.name) || isRound(mesh))) continue;
    Bounds rest;
    for (std::size_t other = 0; other < bounds.size(); ++other)
      if (other != n && scene.nodes[other].mesh >= 0)
        rest.add(bounds[other].low), rest.add(bounds[other].high);
    const glm::dvec3 middle = 0.5 * (rest.low + rest.high);
    if (!(rest.size() > 0.0) || !bounds[n].contains(middle) ||
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
