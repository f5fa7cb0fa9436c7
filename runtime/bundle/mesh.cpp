#include "runtime/bundle/mesh.hpp"

#include <cmath>
#include <exception>
#include <memory>
#include <optional>

#include <draco/compression/decode.h>
#include <fmt/format.h>
#include <glm/ext/vector_float1.hpp>
#include <xxhash.h>

namespace lambent::bundle {
namespace {

// This is more than any mesh that fits into a bundle, but little enough that a machine survives the
// allocation.
constexpr std::uint32_t kMaxMeshTriangles = 1u << 26;
constexpr std::size_t kHeaderBytes = 11;
constexpr std::uint8_t kMajor = 2, kMinor = 2;  // version of the bitstream in KHR_draco_mesh_compression
constexpr std::uint8_t kTriangularMesh = 1, kEdgebreaker = 1;
constexpr std::uint8_t kMetadataFlag = 0x80;  // in the high byte of the flags

const char* kReencode = "encode the mesh again";

// Reads a count as Draco writes it, in little-endian base 128.
std::optional<std::uint64_t> readVarint(std::span<const std::byte> bytes, std::size_t& at) {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 35 && at < bytes.size(); shift += 7) {
    const auto byte = std::to_integer<std::uint8_t>(bytes[at++]);
    value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
    if ((byte & 0x80) == 0) return value;
  }
  return std::nullopt;
}

// Draco allocates what the header claims before it reads the data. Comparing the claim with the primitive's
// count first keeps a forged header from demanding gigabytes.
Result<void> checkHeader(std::span<const std::byte> bytes, const Primitive& primitive,
                         const std::string& subject) {
  const auto byteAt = [&](std::size_t i) { return std::to_integer<std::uint8_t>(bytes[i]); };
  constexpr std::string_view kMagic = "DRACO";
  bool is_draco = bytes.size() > kHeaderBytes;
  for (std::size_t i = 0; is_draco && i < kMagic.size(); ++i)
    is_draco = byteAt(i) == static_cast<std::uint8_t>(kMagic[i]);
  if (!is_draco) return fail(subject, "is not a Draco buffer", kReencode);
  if (byteAt(5) != kMajor || byteAt(6) != kMinor)
    return fail(subject, fmt::format("has Draco version {}.{}, not 2.2", byteAt(5), byteAt(6)), kReencode);
  if (byteAt(7) != kTriangularMesh) return fail(subject, "holds a point cloud, not a mesh", kReencode);
  if (byteAt(8) > kEdgebreaker) return fail(subject, "has an unknown Draco encoding", kReencode);
  if ((byteAt(10) & kMetadataFlag) != 0)
    return fail(subject, "carries Draco metadata", "encode the mesh again without metadata");

  std::size_t at = kHeaderBytes;
  std::optional<std::uint64_t> vertices, faces;
  if (byteAt(8) == kEdgebreaker) {
    ++at;  // kind of traversal
    vertices = readVarint(bytes, at);
    faces = readVarint(bytes, at);
  } else {
    faces = readVarint(bytes, at);
    vertices = readVarint(bytes, at);
  }
  if (!faces || !vertices) return fail(subject, "is truncated", kReencode);
  if (*faces * 3 != primitive.index_count || *faces > kMaxMeshTriangles)
    return fail(
        subject,
        fmt::format("has {} triangles where {} indices were announced", *faces, primitive.index_count),
        kReencode);
  if (*vertices > *faces * 3)
    return fail(subject, fmt::format("claims {} vertices for {} triangles", *vertices, *faces), kReencode);
  return {};
}

// Returns the attribute with the unique id. Fails unless it holds finite floats, as many as the vector type
// has, for every point.
template <typename Vector>
Result<std::vector<Vector>> readAttribute(const draco::Mesh& mesh, std::int32_t id, const char* name,
                                          const std::string& subject) {
  constexpr auto kComponents = static_cast<std::int8_t>(sizeof(Vector) / sizeof(float));
  const draco::PointAttribute* attribute =
      id < 0 ? nullptr : mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
  if (attribute == nullptr)
    return fail(subject, fmt::format("has no {} (attribute {})", name, id), kReencode);
  // Colours may be stored as RGB.
  const int stored = attribute->num_components();
  if (stored != kComponents && !(kComponents == 4 && stored == 3))
    return fail(subject, fmt::format("has {} of {} components", name, stored), kReencode);
  const auto stride = static_cast<std::size_t>(attribute->byte_stride());
  const auto offset = static_cast<std::size_t>(attribute->byte_offset());
  if (attribute->buffer() == nullptr ||
      attribute->buffer()->data_size() < offset + stride * attribute->size())
    return fail(subject, fmt::format("has too few bytes of {}", name), kReencode);

  std::vector<Vector> values(mesh.num_points(), Vector(1.0f));
  for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
    const draco::AttributeValueIndex index = attribute->mapped_index(draco::PointIndex(i));
    if (index.value() >= attribute->size() ||
        !attribute->ConvertValue<float>(index, static_cast<std::int8_t>(stored), &values[i][0]))
      return fail(subject, fmt::format("has no {} for vertex {}", name, i), kReencode);
    for (int c = 0; c < kComponents; ++c)
      if (!std::isfinite(values[i][c]))
        return fail(subject, fmt::format("has a {} that is not finite at vertex {}", name, i), kReencode);
  }
  return values;
}

// Gives normals, or the first three parts of tangents, unit length, since Draco is lossy.
template <typename Vector>
Result<void> normalize(std::vector<Vector>& directions, const char* name, const std::string& subject) {
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const glm::vec3 direction(directions[i]);
    const float length = glm::length(direction);
    if (!(length > 1e-6f) || !std::isfinite(length))
      return fail(subject, fmt::format("has a {} without direction at vertex {}", name, i), kReencode);
    for (int c = 0; c < 3; ++c) directions[i][c] = direction[c] / length;
  }
  return {};
}

// Colours in integers are shares of the largest one, also where the encoder has not said so.
void normalizeColors(const draco::Mesh& mesh, std::int32_t id, std::vector<glm::vec4>& colors) {
  if (colors.empty()) return;
  const draco::PointAttribute& attribute = *mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
  if (attribute.normalized() || !draco::IsDataTypeIntegral(attribute.data_type())) return;
  const float most =
      std::exp2(8.0f * static_cast<float>(draco::DataTypeLength(attribute.data_type()))) - 1.0f;
  for (glm::vec4& color : colors) {
    for (int c = 0; c < attribute.num_components(); ++c) color[c] /= most;
  }
}

Result<MeshData> extract(const draco::Mesh& mesh, const DracoAttributes& attributes,
                         const std::string& subject) {
  MeshData data;
  const auto take = [&](auto& target, std::int32_t id, const char* name) -> Result<void> {
    using Vector = typename std::remove_reference_t<decltype(target)>::value_type;
    auto values = readAttribute<Vector>(mesh, id, name, subject);
    if (!values) return failAgain(std::move(values.error()));
    target = std::move(*values);
    return {};
  };
  Result<void> done = take(data.positions, attributes.position, "positions");
  const auto takeIfAny = [&](auto& target, std::int32_t id, const char* name) {
    if (done && id >= 0) done = take(target, id, name);
  };
  std::vector<glm::vec1> weights;
  takeIfAny(data.normals, attributes.normal, "normals");
  takeIfAny(data.texcoords0, attributes.texcoord0, "texture coordinates");
  takeIfAny(data.texcoords1, attributes.texcoord1, "texture coordinates");
  takeIfAny(data.colors, attributes.color0, "colors");
  takeIfAny(data.tangents, attributes.tangent, "tangents");
  takeIfAny(weights, attributes.normal_weight, "weights of normals");
  if (done) normalizeColors(mesh, attributes.color0, data.colors);
  if (done && attributes.normal_weight >= 0 && data.normals.empty())
    done = fail(subject, "has weights of normals, but no normals", kReencode);
  for (const glm::vec1& weight : weights) data.normal_weights.push_back(glm::clamp(weight.x, 1e-3f, 1.0f));
  if (done) done = normalize(data.normals, "normal", subject);
  if (done) done = normalize(data.tangents, "tangent", subject);
  if (!done) return failAgain(std::move(done.error()));
  for (glm::vec4& tangent : data.tangents) tangent.w = tangent.w < 0.0f ? -1.0f : 1.0f;
  for (glm::vec4& color : data.colors) color = glm::clamp(color, glm::vec4(0.0f), glm::vec4(1.0f));

  data.indices.reserve(std::size_t{mesh.num_faces()} * 3);
  for (std::uint32_t f = 0; f < mesh.num_faces(); ++f) {
    for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(f))) {
      if (corner.value() >= mesh.num_points())
        return fail(subject, fmt::format("has index {} for {} vertices", corner.value(), mesh.num_points()),
                    kReencode);
      data.indices.push_back(corner.value());
    }
  }
  return data;
}

// Decodes the mesh, checks its counts against the primitive's, and returns the result of `use`.
template <typename Out, typename Use>
Result<Out> withDecoded(std::span<const std::byte> bytes, const Primitive& primitive,
                        const std::string& subject, Use use) {
  if (auto header = checkHeader(bytes, primitive, subject); !header)
    return failAgain(std::move(header.error()));
  try {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok())
      return fail(subject, fmt::format("is damaged ({})", decoded.status().error_msg()), kReencode);
    const draco::Mesh& mesh = *decoded.value();
    if (mesh.num_points() != primitive.vertex_count ||
        std::uint64_t{mesh.num_faces()} * 3 != primitive.index_count)
      return fail(subject,
                  fmt::format("decodes to {} vertices and {} indices where {} and {} were announced",
                              mesh.num_points(), std::uint64_t{mesh.num_faces()} * 3, primitive.vertex_count,
                              primitive.index_count),
                  kReencode);
    return use(mesh);
  } catch (const std::exception& exception) {
    return fail(subject, fmt::format("is damaged ({})", exception.what()), kReencode);
  }
}

}  // namespace

Result<MeshData> decodeDraco(std::span<const std::byte> bytes, const Primitive& primitive,
                             const std::string& subject) {
  return withDecoded<MeshData>(bytes, primitive, subject, [&](const draco::Mesh& mesh) {
    return extract(mesh, primitive.attributes, subject);
  });
}

Result<std::vector<glm::vec4>> decodeDracoAttribute(std::span<const std::byte> bytes,
                                                    const Primitive& primitive, std::int32_t id,
                                                    const std::string& name, const std::string& subject) {
  return withDecoded<std::vector<glm::vec4>>(bytes, primitive, subject, [&](const draco::Mesh& mesh) {
    return readAttribute<glm::vec4>(mesh, id, name.c_str(), subject);
  });
}

void weighNormals(MeshData& mesh) {
  for (std::size_t i = 0; i < mesh.normal_weights.size(); ++i) mesh.normals[i] *= mesh.normal_weights[i];
  mesh.normal_weights.clear();
}

std::uint64_t meshDigest(const MeshData& mesh) {
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), &XXH3_freeState);
  XXH3_64bits_reset(state.get());
  XXH3_64bits_update(state.get(), mesh.positions.data(), mesh.positions.size() * sizeof(glm::vec3));
  XXH3_64bits_update(state.get(), mesh.indices.data(), mesh.indices.size() * sizeof(std::uint32_t));
  return XXH3_64bits_digest(state.get());
}

}  // namespace lambent::bundle
