#include "reference/memory_need.hpp"

#include <fmt/format.h>

#include "reference/film.hpp"
#include "runtime/base/process.hpp"

namespace lambent::baker::reference {

namespace {

// A checkpoint is put together before it is written; the picture and its coded bytes take less, 20 + 20.
constexpr std::uint64_t kBytesOfResult = Film::kBytesOfPixel;
// A triangle takes so much with Embree's hierarchy. It was measured on scans of 90 and 270 thousand
// triangles.
constexpr std::uint64_t kBytesOfTriangle = 130;
constexpr std::uint64_t kBytesOfAnyScene = 6'000'000;  // Embree itself, threads and constant light

std::uint64_t bytesOfVertices(const bundle::MeshData& mesh) {
  std::uint64_t bytes_of_one = 2 * sizeof(glm::vec3);
  for (const auto* texcoords : {&mesh.texcoords0, &mesh.texcoords1})
    if (!texcoords->empty()) bytes_of_one += sizeof(glm::vec2);
  if (!mesh.colors.empty()) bytes_of_one += sizeof(glm::vec4);
  if (!mesh.tangents.empty()) bytes_of_one += sizeof(glm::vec4);
  return bytes_of_one * mesh.positions.size();
}

std::string megabytes(std::uint64_t bytes) {
  return fmt::format("{:.0f} MB", 1e-6 * static_cast<double>(bytes));
}

}  // namespace

std::uint64_t bytesOfPicture(const spec::Size& size) {
  return std::uint64_t{size.width} * size.height * (Film::kBytesOfPixel + kBytesOfResult);
}

std::uint64_t bytesOfTracing(const Scene& scene) {
  std::uint64_t bytes = kBytesOfAnyScene;
  for (const gltf::Node& node : scene.nodes) {
    if (node.mesh < 0) continue;
    for (const ScenePrimitive& primitive : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives)
      bytes += bytesOfVertices(primitive.mesh) + kBytesOfTriangle * (primitive.mesh.indices.size() / 3);
  }
  return bytes;
}

Result<void> checkMemory(const Options& options, std::uint64_t more, const std::string& what) {
  const std::uint64_t allowed = options.memory_bytes != 0 ? options.memory_bytes : machineBytes();
  const std::uint64_t needed = residentBytes() + more;
  if (allowed == 0 || needed <= allowed) return {};
  return fail("--max-memory",
              fmt::format("{} takes about {}, and {} {}", what, megabytes(needed), megabytes(allowed),
                          options.memory_bytes != 0 ? "are allowed" : "are in this machine"),
              "ask for a smaller picture, or allow more");
}

}  // namespace lambent::baker::reference
