#include <array>
#include <cassert>
#include <numeric>
#include <span>

#include <fmt/format.h>

#include "baker/import/accessor.hpp"
#include "baker/import/convert.hpp"
#include "baker/import/tinygltf.hpp"

namespace lambent::baker {
namespace {

constexpr const char* kExport = "export the scene again";

template <typename Vector>
Result<std::vector<Vector>> readVectors(const Document& document, const tinygltf::Primitive& primitive,
                                        const std::string& semantic, const std::vector<int>& allowed) {
  const auto attribute = primitive.attributes.find(semantic);
  if (attribute == primitive.attributes.end()) return std::vector<Vector>();
  auto floats =
      readFloats(document, attribute->second, semantic, allowed, static_cast<std::size_t>(Vector::length()));
  if (!floats) return failAgain(std::move(floats.error()));
  std::vector<Vector> vectors(floats->count());
  for (std::size_t i = 0; i < vectors.size(); ++i)
    for (int c = 0; c < Vector::length(); ++c)
      vectors[i][c] = floats->values[i * floats->components + static_cast<std::size_t>(c)];
  return vectors;
}

// Takes a Result apart: the value into `target`, or false and the error kept.
template <typename T>
bool assign(T& target, Result<T> result, Error& error) {
  if (!result) {
    error = std::move(result.error());
    return false;
  }
  target = std::move(*result);
  return true;
}

Result<bundle::MeshData> readPlain(const Document& document, const tinygltf::Primitive& primitive) {
  bundle::MeshData mesh;
  Error error;
  const bool read =
      assign(mesh.positions, readVectors<glm::vec3>(document, primitive, "POSITION", {3}), error) &&
      assign(mesh.normals, readVectors<glm::vec3>(document, primitive, "NORMAL", {3}), error) &&
      assign(mesh.texcoords0, readVectors<glm::vec2>(document, primitive, "TEXCOORD_0", {2}), error) &&
      assign(mesh.texcoords1, readVectors<glm::vec2>(document, primitive, "TEXCOORD_1", {2}), error) &&
      assign(mesh.colors, readVectors<glm::vec4>(document, primitive, "COLOR_0", {3, 4}), error) &&
      (primitive.indices < 0 || assign(mesh.indices, readIndices(document, primitive.indices), error));
  if (!read) return failAgain(std::move(error));
  if (primitive.indices < 0) {
    mesh.indices.resize(mesh.positions.size());
    std::iota(mesh.indices.begin(), mesh.indices.end(), 0u);
  }
  return mesh;
}

Result<bundle::MeshData> readDraco(const Document& document, const tinygltf::Primitive& primitive,
                                   const tinygltf::Value& extension, const std::string& name) {
  const tinygltf::Model& model = document.model();
  const tinygltf::Value& ids = extension.Get("attributes");
  const auto id = [&](const char* semantic) {
    return ids.Has(semantic) ? ids.Get(semantic).GetNumberAsInt() : -1;
  };
  bundle::Primitive announced;
  announced.attributes = {.position = id("POSITION"),
                          .normal = id("NORMAL"),
                          .texcoord0 = id("TEXCOORD_0"),
                          .texcoord1 = id("TEXCOORD_1"),
                          .color0 = id("COLOR_0")};
  const auto position = primitive.attributes.find("POSITION");
  if (position == primitive.attributes.end() || announced.attributes.position < 0 ||
      !extension.Has(kDracoIndices))
    return fail(document.file(), fmt::format("{}: compressed without POSITION or indices", name), kExport);
  const auto indices = static_cast<std::size_t>(extension.Get(kDracoIndices).GetNumberAsInt());
  announced.vertex_count =
      static_cast<std::uint32_t>(model.accessors[static_cast<std::size_t>(position->second)].count);
  announced.index_count = static_cast<std::uint32_t>(model.accessors[indices].count);

  const auto& view =
      model.bufferViews[static_cast<std::size_t>(extension.Get("bufferView").GetNumberAsInt())];
  const auto bytes = std::as_bytes(std::span(model.buffers[static_cast<std::size_t>(view.buffer)].data))
                         .subspan(view.byteOffset, view.byteLength);
  return bundle::decodeDraco(bytes, announced, fmt::format("{}: {}", document.file(), name));
}

// Every attribute has a value for every vertex, every index a vertex.
Result<void> checkCounts(const bundle::MeshData& mesh, const std::string& file, const std::string& name) {
  const std::size_t vertices = mesh.positions.size();
  const std::array counts{
      std::pair{"NORMAL", mesh.normals.size()}, std::pair{"TEXCOORD_0", mesh.texcoords0.size()},
      std::pair{"TEXCOORD_1", mesh.texcoords1.size()}, std::pair{"COLOR_0", mesh.colors.size()}};
  for (const auto& [semantic, count] : counts)
    if (count != 0 && count != vertices)
      return fail(file, fmt::format("{}: {} has {} elements, POSITION {}", name, semantic, count, vertices),
                  kExport);
  for (std::size_t i = 0; i < mesh.indices.size(); ++i)
    if (mesh.indices[i] >= vertices)
      return fail(file,
                  fmt::format("{}: index {} at place {} but there are {} vertices", name, mesh.indices[i], i,
                              vertices),
                  kExport);
  return {};
}

// Lists, strips and fans as lists; corners in the order that keeps the winding (glTF 2.0, section 3.7.2.1).
std::vector<std::uint32_t> toTriangles(const std::vector<std::uint32_t>& in, int mode) {
  std::vector<std::uint32_t> out;
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    out.assign(in.begin(), in.begin() + static_cast<std::ptrdiff_t>(in.size() / 3 * 3));
    return out;
  }
  for (std::size_t i = 0; i + 2 < in.size(); ++i) {
    if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      const std::size_t odd = i % 2;
      out.insert(out.end(), {in[i], in[i + 1 + odd], in[i + 2 - odd]});
    } else {
      out.insert(out.end(), {in[i + 1], in[i + 2], in[0]});
    }
  }
  return out;
}

void transformTexcoords(bundle::MeshData& mesh, const UvTransform& transform) {
  if (transform.identity || transform.texcoord > 1) return;
  for (glm::vec2& uv : transform.texcoord == 0 ? mesh.texcoords0 : mesh.texcoords1)
    uv = glm::vec2(transform.matrix * glm::vec3(uv, 1.0f));
}

Result<bundle::MeshData> convertPrimitive(const Document& document, const tinygltf::Primitive& primitive,
                                          const std::string& name, std::vector<std::string>& warnings) {
  if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
    warnings.push_back(fmt::format("{}: points and lines are left out", name));
    return bundle::MeshData{};
  }
  if (!primitive.attributes.contains("POSITION")) {
    warnings.push_back(fmt::format("{}: has no positions and is left out", name));
    return bundle::MeshData{};
  }
  if (!primitive.targets.empty()) warnings.push_back(fmt::format("{}: morph targets are left out", name));
  const auto draco = primitive.extensions.find("KHR_draco_mesh_compression");
  const bool compressed = draco != primitive.extensions.end();
  auto mesh =
      compressed ? readDraco(document, primitive, draco->second, name) : readPlain(document, primitive);
  if (!mesh) return mesh;
  if (auto counts = checkCounts(*mesh, document.file(), name); !counts)
    return failAgain(std::move(counts.error()));
  // Draco holds lists whatever the mode says.
  if (!compressed) mesh->indices = toTriangles(mesh->indices, primitive.mode);
  for (glm::vec4& color : mesh->colors) color = glm::clamp(color, glm::vec4(0.0f), glm::vec4(1.0f));
  return mesh;
}

}  // namespace

Result<void> convertMeshes(const Document& document, const std::vector<UvTransform>& transforms,
                           Scene& scene) {
  for (std::size_t m = 0; m < document.model().meshes.size(); ++m) {
    const tinygltf::Mesh& source = document.model().meshes[m];
    SceneMesh mesh{.name = source.name, .primitives = {}};
    for (std::size_t p = 0; p < source.primitives.size(); ++p) {
      const tinygltf::Primitive& primitive = source.primitives[p];
      const std::string name = fmt::format("mesh {}, primitive {}", m, p);
      auto data = convertPrimitive(document, primitive, name, scene.warnings);
      if (!data) return failAgain(std::move(data.error()));
      if (data->indices.empty()) continue;
      cleanMesh(*data, name, scene.warnings);
      if (data->indices.empty()) continue;
      if (primitive.material >= 0)
        transformTexcoords(*data, transforms[static_cast<std::size_t>(primitive.material)]);
      mesh.primitives.push_back({std::move(*data), primitive.material});
    }
    scene.meshes.push_back(std::move(mesh));
  }
  return {};
}

}  // namespace lambent::baker
