// Reads primitives, and applies morph targets and skins on the CPU, once at import.
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "baker/import/check.hpp"
#include "baker/import/convert.hpp"
#include "baker/import/document.hpp"
#include "runtime/base/normal_matrix.hpp"

namespace lambent::baker {

namespace {

using nlohmann::json;

constexpr const char* kDraco = "KHR_draco_mesh_compression";

// Holds four joints of each vertex and their weights; a vertex may have several sets of them.
struct Influences {
  std::vector<glm::vec4> joints, weights;
};

template <typename Vector>
void addDisplacements(const Document& document, std::size_t accessor, float weight, const std::string& name,
                      std::vector<Vector>& values) {
  if (values.empty()) return;
  const Floats floats = readFloats(document, accessor, name, {"VEC3"});
  if (floats.count() != values.size())
    refuse("{} has {} elements, the mesh {}", name, floats.count(), values.size());
  for (std::size_t v = 0; v < values.size(); ++v)
    for (int c = 0; c < 3; ++c) values[v][c] += weight * floats.values[3 * v + static_cast<std::size_t>(c)];
}

// Adds weight times displacement of every target to positions, normals and tangents.
void applyMorphTargets(const Document& document, const json& targets, const std::vector<float>& weights,
                       const std::string& name, bundle::MeshData& mesh) {
  for (std::size_t t = 0; t < std::min(targets.size(), weights.size()); ++t) {
    if (weights[t] == 0.0f) continue;
    for (const auto& [semantic, value] : targets[t].items()) {
      const auto add = [&, &accessor = value, &what = semantic](auto& values) {
        addDisplacements(document, accessor.template get<std::size_t>(), weights[t],
                         fmt::format("{}, morph target {}: {}", name, t, what), values);
      };
      if (semantic == "POSITION") add(mesh.positions);
      if (semantic == "NORMAL") add(mesh.normals);
      if (semantic == "TANGENT") add(mesh.tangents);
    }
  }
}

// Moves every vertex by the weighted mean of its joints' matrices. Errors: the skin does not have such a
// joint.
void applySkin(const std::vector<Influences>& sets, const std::vector<glm::dmat4>& joints,
               const std::string& name, bundle::MeshData& mesh) {
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    glm::dmat4 matrix(0.0);
    double sum = 0.0;
    for (const Influences& set : sets)
      for (int c = 0; c < 4; ++c) {
        const float weight = set.weights[v][c], joint = set.joints[v][c];
        if (!std::isfinite(weight) || weight < 0.0f)
          refuse("{}: vertex {} has a joint weight of {}", name, v, weight);
        if (weight == 0.0f) continue;
        if (!(joint >= 0.0f && joint < static_cast<float>(joints.size())))
          refuse("{}: vertex {} hangs on joint {} of {}", name, v, joint, joints.size());
        matrix += static_cast<double>(weight) * joints[static_cast<std::size_t>(joint)];
        sum += static_cast<double>(weight);
      }
    if (sum == 0.0) continue;  // belongs to no joint and stays in place
    matrix /= sum;             // quantized weights do not sum to exactly 1
    mesh.positions[v] = glm::vec3(matrix * glm::dvec4(mesh.positions[v], 1.0));
    const glm::dmat3 linear(matrix);
    // Normals without direction are left for cleaning, which reports them.
    if (!mesh.normals.empty()) {
      const glm::dvec3 normal = normalMatrix(linear) * glm::dvec3(mesh.normals[v]);
      const double length = glm::length(normal);
      mesh.normals[v] = glm::vec3(length > 0.0 ? normal / length : normal);
    }
    if (!mesh.tangents.empty())
      mesh.tangents[v] = glm::vec4(glm::vec3(linear * glm::dvec3(mesh.tangents[v])), mesh.tangents[v].w);
  }
}

template <typename Vector>
std::vector<Vector> readVectors(const Document& document, const json& primitive, const std::string& semantic,
                                std::initializer_list<std::string_view> types) {
  const json& attribute = memberOf(primitive, {"attributes", semantic.c_str()});
  if (attribute.is_null()) return {};
  const Floats floats = readFloats(document, attribute.get<std::size_t>(), semantic, types,
                                   static_cast<std::size_t>(Vector::length()));
  std::vector<Vector> vectors(floats.count());
  for (std::size_t i = 0; i < vectors.size(); ++i)
    for (int c = 0; c < Vector::length(); ++c)
      vectors[i][c] = floats.values[i * floats.components + static_cast<std::size_t>(c)];
  return vectors;
}

bundle::MeshData readPlain(const Document& document, const json& primitive, bool tangents) {
  bundle::MeshData mesh;
  mesh.positions = readVectors<glm::vec3>(document, primitive, "POSITION", {"VEC3"});
  mesh.normals = readVectors<glm::vec3>(document, primitive, "NORMAL", {"VEC3"});
  mesh.texcoords0 = readVectors<glm::vec2>(document, primitive, "TEXCOORD_0", {"VEC2"});
  mesh.texcoords1 = readVectors<glm::vec2>(document, primitive, "TEXCOORD_1", {"VEC2"});
  mesh.colors = readVectors<glm::vec4>(document, primitive, "COLOR_0", {"VEC3", "VEC4"});
  if (tangents) mesh.tangents = readVectors<glm::vec4>(document, primitive, "TANGENT", {"VEC4"});
  if (primitive.contains("indices")) {
    mesh.indices = readIndices(document, primitive["indices"].get<std::size_t>());
  } else {
    mesh.indices.resize(mesh.positions.size());
    std::iota(mesh.indices.begin(), mesh.indices.end(), 0u);
  }
  return mesh;
}

// A DracoSource is a Draco primitive: the buffer, and what the file says about it.
struct DracoSource {
  std::span<const std::byte> bytes;
  bundle::Primitive announced;
  const json* ids = nullptr;

  std::int32_t id(const std::string& semantic) const { return ids->value(semantic, -1); }
};

DracoSource dracoSource(const Document& document, const json& primitive, bool tangents,
                        const std::string& name) {
  const json& extension = primitive.at("extensions").at(kDraco);
  DracoSource source;
  source.ids = &extension.at("attributes");
  source.announced.attributes = {.position = source.id("POSITION"),
                                 .normal = source.id("NORMAL"),
                                 .texcoord0 = source.id("TEXCOORD_0"),
                                 .texcoord1 = source.id("TEXCOORD_1"),
                                 .color0 = source.id("COLOR_0"),
                                 .tangent = tangents ? source.id("TANGENT") : -1};
  if (source.announced.attributes.position < 0 || !primitive.contains("indices"))
    refuse("{}: compressed without POSITION or indices", name);
  const auto countOf = [&](const json& accessor) {
    return document.at("accessors", accessor.get<std::size_t>()).at("count").get<std::uint32_t>();
  };
  source.announced.vertex_count = countOf(primitive.at("attributes").at("POSITION"));
  source.announced.index_count = countOf(primitive["indices"]);
  source.bytes = document.view(extension.at("bufferView").get<std::size_t>());
  return source;
}

// Reads JOINTS_n and WEIGHTS_n for n = 0, 1, ..., from the Draco buffer if they are there.
std::vector<Influences> readInfluences(const Document& document, const json& primitive,
                                       const DracoSource* draco, const std::string& name) {
  const auto read = [&](const std::string& semantic) {
    const std::int32_t id = draco == nullptr ? -1 : draco->id(semantic);
    if (id < 0) return readVectors<glm::vec4>(document, primitive, semantic, {"VEC4"});
    return orThrow(bundle::decodeDracoAttribute(draco->bytes, draco->announced, id, semantic,
                                                fmt::format("{}: {}", document.file(), name)));
  };
  std::vector<Influences> sets;
  for (int n = 0; primitive.at("attributes").contains(fmt::format("JOINTS_{}", n)); ++n)
    sets.push_back({read(fmt::format("JOINTS_{}", n)), read(fmt::format("WEIGHTS_{}", n))});
  return sets;
}

// Requires joints and weights for every vertex, as mends have seen to for other attributes, and a vertex for
// every index.
void checkCounts(const bundle::MeshData& mesh, const std::vector<Influences>& influences,
                 const std::string& name) {
  const std::size_t vertices = mesh.positions.size();
  for (std::size_t n = 0; n < influences.size(); ++n)
    for (const auto& [semantic, count] :
         {std::pair{"JOINTS", influences[n].joints.size()}, {"WEIGHTS", influences[n].weights.size()}})
      if (count != vertices)
        refuse("{}: {}_{} has {} elements, POSITION {}", name, semantic, n, count, vertices);
  for (std::size_t i = 0; i < mesh.indices.size(); ++i)
    if (mesh.indices[i] >= vertices)
      refuse("{}: index {} at place {} but there are {} vertices", name, mesh.indices[i], i, vertices);
}

constexpr int kTriangles = 4, kTriangleStrip = 5;  // the modes below are of points and lines, 6 is a fan

// Converts lists, strips and fans to lists; corners keep the winding (glTF 2.0, section 3.7.2.1).
std::vector<std::uint32_t> toTriangles(const std::vector<std::uint32_t>& in, int mode) {
  std::vector<std::uint32_t> out;
  if (mode == kTriangles) {
    out.assign(in.begin(), in.begin() + static_cast<std::ptrdiff_t>(in.size() / 3 * 3));
    return out;
  }
  for (std::size_t i = 0; i + 2 < in.size(); ++i) {
    if (mode == kTriangleStrip) {
      const std::size_t odd = i % 2;
      out.insert(out.end(), {in[i], in[i + 1 + odd], in[i + 2 - odd]});
    } else {
      out.insert(out.end(), {in[i + 1], in[i + 2], in[0]});
    }
  }
  return out;
}

}  // namespace

bundle::MeshData readPrimitive(const Document& document, const json& primitive, const MeshPose& pose,
                               bool tangents, const std::string& name, std::vector<std::string>& warnings) {
  const int mode = primitive.value("mode", kTriangles);
  if (mode < kTriangles) {
    warnings.push_back(fmt::format("{}: points and lines are left out", name));
    return {};
  }
  const json& attributes = primitive.at("attributes");
  if (!attributes.contains("POSITION")) {
    warnings.push_back(fmt::format("{}: has no geometry and is left out", name));
    return {};
  }
  // glTF gives no meaning to tangents without normals.
  tangents = tangents && attributes.contains("NORMAL");
  std::optional<DracoSource> draco;
  if (!memberOf(primitive, {"extensions", kDraco}).is_null())
    draco = dracoSource(document, primitive, tangents, name);
  bundle::MeshData mesh = draco ? orThrow(bundle::decodeDraco(draco->bytes, draco->announced,
                                                              fmt::format("{}: {}", document.file(), name)))
                                : readPlain(document, primitive, tangents);
  std::vector<Influences> influences;
  if (!pose.joints.empty()) influences = readInfluences(document, primitive, draco ? &*draco : nullptr, name);
  checkCounts(mesh, influences, name);
  // Draco holds lists whatever the mode says.
  if (!draco) mesh.indices = toTriangles(mesh.indices, mode);
  for (glm::vec4& color : mesh.colors) color = glm::clamp(color, glm::vec4(0.0f), glm::vec4(1.0f));
  // glTF applies targets first, then the skin.
  applyMorphTargets(document, memberOf(primitive, {"targets"}), pose.weights, name, mesh);
  applySkin(influences, pose.joints, name, mesh);
  return mesh;
}

}  // namespace lambent::baker
