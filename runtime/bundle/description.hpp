// A Description holds the JSON part of a bundle as values: the glTF scene, the byte ranges of the file, and
// the extension LAMBENT_radiance_transfer, which says what was baked. docs/format.md describes the same in
// words, with units and the schema.
//
// The samples of a group are numbered through all its cells; codebook.hpp defines transfer vectors. The
// reader checks every index, so later code need not check again.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/gltf_types.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::bundle {

// Indices into a bundle's description. Each kind is a type of its own, because groups, cells, transfers and
// planes are named side by side, and numbers in the wrong order would compile. They are no indices into the
// residency's tables either, which hold the groups and cells of all bundles.
template <class Kind>
struct Index {
  constexpr Index() = default;
  explicit constexpr Index(std::uint32_t index) : value(index) {}
  friend constexpr auto operator<=>(const Index&, const Index&) = default;

  std::uint32_t value = 0;
};

using GroupIndex = Index<struct GroupKind>;        // into Description::groups
using CellIndex = Index<struct CellKind>;          // into Group::cells
using TransferIndex = Index<struct TransferKind>;  // into Cell::transfers
using PlaneIndex = Index<struct PlaneKind>;        // into CellTransfer::planes

inline constexpr std::string_view kExtensionName = "LAMBENT_radiance_transfer";
// Format versions, newest last; code asks for these names, never for a bare number.
inline constexpr std::uint32_t kVersionFirstLight = 1;
inline constexpr std::uint32_t kVersionClusteredTransfer = 2;
inline constexpr std::uint32_t kVersionLocalLight = 3;
inline constexpr std::uint32_t kVersionGlossyTransfer = 4;
inline constexpr std::uint32_t kVersionVolumesAndNeighborhoods = 5;
inline constexpr std::uint32_t kVersionWeightedNormals = 6;
inline constexpr std::uint32_t kVersionFans = 7;
inline constexpr std::uint32_t kVersionLampShapes = 8;
inline constexpr std::uint32_t kVersionCurrent = kVersionLampShapes;

// Describes a byte range of the GLB's binary chunk.
struct View {
  std::uint64_t offset = 0;    // from the start of the binary chunk, a multiple of 8
  std::uint64_t length = 0;    // bytes, without padding
  std::uint64_t checksum = 0;  // XXH3-64 of the bytes and the zero padding up to the next multiple of 8
};

// Holds the unique ids of the attributes of a Draco mesh; -1 if the mesh lacks one.
struct DracoAttributes {
  std::int32_t position = -1, normal = -1, texcoord0 = -1, texcoord1 = -1, color0 = -1, tangent = -1,
               normal_weight = -1;
};

struct Primitive {
  std::uint32_t view = 0;  // the Draco buffer
  DracoAttributes attributes;
  std::int32_t material = -1;
  std::uint32_t vertex_count = 0;  // after decoding
  std::uint32_t index_count = 0;
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};  // of the decoded positions, in mesh space
  glm::vec3 vector_area{0.0f};  // sum of area times normal over the triangles; 0 for a closed mesh
  std::uint64_t digest = 0;     // meshDigest() of the decoded mesh
};

struct Mesh {
  std::string name;
  std::vector<Primitive> primitives;
};

struct Image {
  std::string name;
  std::string mime_type;  // image/png or image/jpeg
  std::uint32_t view = 0;
};

// Tells what a payload's bytes mean; docs/format.md has the byte tables.
enum class PayloadType : std::uint8_t {
  VertexWeights,  // samples and weights of each vertex (codebook.hpp)
  Codebook,       // means, axes and quantization steps of the clusters of a cell (codebook.hpp)
  ClusterIds,     // cluster of each sample
  WeightPlane,    // one quantized weight per sample of the clusters that have this axis
  LightWeights,   // light probes of each sample of a cell (codebook.hpp)
  CaptureProxy,   // a group in a few triangles, as other groups see it (capture_proxy.hpp)
  BrdfTable,      // b(v) of a family of BRDFs (brdf_table.hpp)
  Density,        // extinction of a volume at its own resolution
  Voxels,         // voxels of its transfer grid at which a volume has samples (encodeVoxels())
  Importance,     // how much each sample of a cell matters to pictures (importanceCode())
};

enum class PayloadCodec : std::uint8_t { Raw, Zstd };

struct Payload {
  PayloadType type = PayloadType::VertexWeights;
  PayloadCodec codec = PayloadCodec::Raw;
  std::uint32_t view = 0;
  std::uint64_t raw_length = 0;  // bytes after decompression
  std::uint32_t priority = 0;    // streaming order; lower numbers are loaded first
};

// Describes the weights of axis j: one code for each sample whose cluster has an axis j. The AxisCode of the
// cluster turns a code into a weight.
struct WeightPlane {
  std::uint32_t payload = 0;
  std::uint32_t bits = 8;   // 8 or 16
  std::uint32_t count = 0;  // number of codes
  float variance = 0.0f;    // share of the cell's weighted variance about its mean that this plane carries
};

// Returns whether codes with this error miss the bound that they were made under.
constexpr bool missesBound(double error, double bound) {
  constexpr double kRounded = 1.005;  // reports have three figures, and what they round away is no miss
  return error > kRounded * bound;
}

// Describes one part of the transfer of a cell, stored as a codebook and a few weights per sample
// (codebook.hpp).
struct CellTransfer {
  transfer::TransferShape shape;
  std::uint32_t clusters = 1;
  std::uint32_t axes = 0;           // sum over clusters
  std::uint32_t codebook = 0;       // payload
  std::int32_t cluster_ids = -1;    // payload; -1 if there is only one cluster
  std::vector<WeightPlane> planes;  // by falling variance; the first few alone can be rendered, too
  float error_bound = 0.0f;  // requested limit of the relative RMS error of shaded radiance over real lights
  float error = 0.0f;        // the error that the coded form has

  // Returns whether the light comes from the environment; otherwise it comes from the group's own lights.
  bool fromEnvironment() const { return shape.order > 0; }
};

// Largest number of light probes per cell.
inline constexpr std::uint32_t kMaxLightProbes = 64;

// Describes a cell, the unit of storage, with at most 64 Ki samples.
struct Cell {
  std::uint32_t first_sample = 0, sample_count = 0;
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};  // group frame
  // The parts of the transfer, whose light is summed. First comes light from the environment (no light
  // columns); a glossy cell has its visibility and then, if light bounces, the bounced light. Light from the
  // group's own lights follows (order 0, one column per light). Each occurs at most once, and all have the
  // same outputs.
  std::vector<CellTransfer> transfers;
  // Rising indices into the group's light probes, 1 to kMaxLightProbes of them. Light weights refer to
  // positions in this list. If there is only one probe, it lights all samples of the cell.
  std::vector<std::uint32_t> light_probes = {0};
  std::int32_t light_weights = -1;  // payload; -1 if there is only one light probe
  std::int32_t importance = -1;     // payload, for views only; -1: not known
  transfer::Domain domain = transfer::Domain::Vertex;

  std::uint32_t outputs() const { return transfers.empty() ? 1 : transfers.front().shape.outputs; }
  transfer::Form form() const { return transfer::formOf(domain, outputs()); }
  bool isGlossySurface() const {
    return domain == transfer::Domain::Vertex && form() == transfer::Form::Matrix;
  }
};

// Describes a sphere that emits evenly, about as a closed part of a mesh does. A sphere of this radius has
// the area of the part, and hence its power. The part itself is within `body_radius_m` of the center.
struct LampSphere {
  glm::vec3 center{0.0f};  // group frame, metres
  float radius_m = 0.0f, body_radius_m = 0.0f;
  bool operator==(const LampSphere&) const = default;
};
inline constexpr std::size_t kMaxLampSpheres = 4;  // of a material

// Describes a light that belongs to a group, so that it does not move in the group's frame. Column k of the
// group's transfer is the response to light k at unit strength; its coefficient is the light's current colour
// times strength.
struct GroupLight {
  enum class Kind : std::uint8_t { Material, Node };
  Kind kind = Kind::Material;
  std::uint32_t index = 0;  // index of the emissive material, or of the node that carries a KHR light
  // Colour as baked: radiance (factor times strength) of a material, or colour times intensity of a node.
  glm::vec3 color{0.0f};
  // If the material emits like a few spheres, these are the spheres; else it is empty. Its direct light can
  // then be shaded per pixel.
  std::vector<LampSphere> spheres{};
};

// Describes a medium that absorbs and scatters, in a box of voxels. The density has its own resolution, for
// optical depth and ray marching. Transfer has another grid over the same box; `voxels` lists the voxels that
// have samples, in the order of the samples of the group's volume cells. With 1 output a sample gives the
// mean incident radiance; with 9, 16 or 25 it gives the incident radiance in bands, for anisotropic phase
// functions. Values belong to voxel centres, are linear between them, and are constant in the outermost half
// voxel.
struct VolumeGrid {
  glm::uvec3 size{1};               // number of density voxels along x, y and z
  glm::mat4 group_from_grid{1.0f};  // affine; in grid coordinates voxel (i, j, k) fills [i, i + 1] x ...
  std::uint32_t density = 0;        // payload
  std::uint32_t bits = 8;           // bits per density code, 8 or 16
  float density_max = 0.0f;         // extinction of the largest code, in m^-1; code 0 means none
  glm::vec3 albedo{1.0f};           // share of the extinction that scatters, 0..1
  float g = 0.0f;                   // mean cosine of the Henyey-Greenstein phase function, -1 < g < 1
  glm::uvec3 transfer_size{1};      // number of voxels of the transfer grid along x, y and z
  std::uint32_t voxels = 0;         // payload
};

// A volume has two payloads:
//   "density": one code of 8 or 16 bits per voxel, little endian, x fastest, then y, then z, where
//              extinction = density_max * code / (2^bits - 1).
//   "voxels":  rising indices of voxels of the transfer grid (x fastest), each as its difference from the one
//              before it (the first from 0), as 32-bit integers in the form of payload_bytes.hpp.
std::vector<std::byte> encodeVoxels(std::span<const std::uint32_t> voxels);
// Fails, naming `subject`, if the voxels do not rise or lie outside the grid.
Result<std::vector<std::uint32_t>> decodeVoxels(std::span<const std::byte> bytes, const glm::uvec3& grid_size,
                                                const std::string& subject);

// Describes a grid of points that stores how the group changes the light around it: M - I in the group's
// frame, which falls to 0 towards the faces of the grid. The points are the samples of the group's
// neighborhood cells, x fastest, then y, then z. They have 9 outputs (bands 0..2, enough for diffuse
// receivers) or as many bands as the light, for receivers with transfer of their own.
struct NeighborhoodGrid {
  glm::uvec3 size{2};                            // number of points along each axis, at least 2
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};  // first and last point, in the group's frame
};

// Says how wrong the surfaces of a group are shown, as the bake measured it: relative RMS of the light that
// leaves them towards eyes, over real skies that the bundle's bands carry, with lamps as in the file. The
// squares of its three parts sum to that of `all`.
struct PictureError {
  float all = 0.0f;
  float samples = 0.0f;        // noise of too few rays at vertices
  float codes = 0.0f;          // compression
  float interpolation = 0.0f;  // too few vertices
  std::uint32_t points = 0;    // where it was measured
  float bound = 0.0f;          // what `all` was to stay below; 0: nothing was asked for
  bool operator==(const PictureError&) const = default;
};

// Describes a rigid group, the unit of transport, whose nodes never move relative to each other. Transfer is
// stored in the group's frame, which has the rotation and position of its root node at rest, without scale.
struct Group {
  std::string name;
  std::int32_t node = -1;  // root node; -1 if the root is the scene
  glm::vec3 rest_translation{0.0f};
  glm::quat rest_rotation{1.0f, 0.0f, 0.0f, 0.0f};  // world_from_group at rest
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};     // group frame
  std::uint32_t sample_count = 0;
  // Surface cells come first, by rising outputs (plain, normal-mapped, glossy), then those of the volume,
  // then those of the neighborhood.
  std::vector<Cell> cells;
  std::vector<GroupLight> lights;  // one per light column, in the same order
  // Points, in the group's frame, where incident light is sampled. There is at least one, and each is used by
  // some cell.
  std::vector<glm::vec3> light_probes = {glm::vec3(0.0f)};
  std::int32_t proxy = -1;           // payload of the capture proxy; -1 if there is none
  std::optional<VolumeGrid> volume;  // a group with a volume has no surfaces
  // Index of the group relative to which a volume never moves, and whose surfaces are part of its transfer;
  // -1 if there is none.
  std::int32_t within = -1;
  std::optional<NeighborhoodGrid> neighborhood;
  std::optional<PictureError> picture_error;  // absent if no diffuse surface is seen, or none was measured

  // Returns the number of surface samples with the given outputs. Samples with fewer outputs precede them.
  std::uint32_t samplesOf(transfer::Form form) const {
    std::uint32_t count = 0;
    for (const Cell& cell : cells)
      if (cell.domain == transfer::Domain::Vertex && cell.form() == form) count += cell.sample_count;
    return count;
  }
  std::uint32_t samplesOf(transfer::Domain domain) const {
    std::uint32_t count = 0;
    for (const Cell& cell : cells) count += cell.domain == domain ? cell.sample_count : 0;
    return count;
  }
};

// Describes a draw, the unit of drawing: one side of a primitive at a node, with transfer of its own. A
// primitive with a double-sided material has two draws. The back one has its winding reversed and its normals
// negated, so every draw is single-sided.
struct Draw {
  std::uint32_t node = 0, mesh = 0, primitive = 0, group = 0;
  bool back = false;
  std::uint32_t rows = 0;  // payload of the rows of its vertices, whose samples have the same outputs
  // One output is shaded per vertex. Nine (normal maps) and 16, 25 or 36 (glossy) are shaded per pixel from
  // transferred light.
  std::uint32_t outputs = 1;
  // Side of a square texture whose texels have samples of their own, and the set of texture coordinates by
  // which it is looked up. The rows of the texels, of one sample each, follow those of the vertices. 0: the
  // draw has none. Only draws with one output have some.
  std::uint32_t texels = 0, texel_set = 0;

  transfer::Form form() const { return transfer::formOf(transfer::Domain::Vertex, outputs); }
  bool glossy() const { return form() == transfer::Form::Matrix; }
};

// Tells whose b(v) a table holds. GGX tables serve all materials of their kind, with the parts of F0 and F90
// apart, and roughness and anisotropy as axes. A measured table holds all that a material reflects, whether
// it was measured or computed, and serves the materials whose `brdf` is its index in
// Description::brdf_tables.
enum class BrdfFamily : std::uint8_t { Ggx, AnisotropicGgx, Measured };

// Returns the family whose table a material looks up if it is not diffuse.
inline BrdfFamily brdfFamilyOf(const gltf::Material& material) {
  if (material.brdf >= 0) return BrdfFamily::Measured;
  return material.anisotropy > 0.0f ? BrdfFamily::AnisotropicGgx : BrdfFamily::Ggx;
}

struct BrdfTableEntry {
  BrdfFamily family = BrdfFamily::Ggx;
  std::string name;           // name of the file of a measured BRDF
  std::uint32_t payload = 0;  // payload of type BrdfTable
};

struct Generator {
  std::string program, version, isa;
  std::map<std::string, std::string> settings;  // options of the bake by name
};

struct Description {
  std::uint32_t version = kVersionCurrent;
  Generator generator;

  // What the world's coordinates count from in the nodes without a parent and in Group::rest_translation, in
  // m in the world of the file. Unless it is 0, no animation moves these nodes.
  glm::dvec3 origin{0.0};
  std::vector<gltf::Node> nodes;
  std::vector<std::int32_t> roots;
  std::vector<Mesh> meshes;
  std::vector<gltf::Material> materials;
  std::vector<gltf::Texture> textures;
  std::vector<Image> images;
  std::vector<gltf::Camera> cameras;
  std::vector<gltf::Light> lights;
  std::vector<gltf::Animation> animations;
  std::vector<BrdfTableEntry> brdf_tables;  // tables that the glossy materials look up

  std::vector<View> views;
  std::vector<Payload> payloads;
  std::vector<Group> groups;
  std::vector<Draw> draws;

  // Returns the number of outputs that all glossy cells and draws share, or 0 if there are none.
  std::uint32_t glossyOutputs() const {
    for (const Group& group : groups)
      for (const Cell& cell : group.cells)
        if (cell.isGlossySurface()) return cell.outputs();
    return 0;
  }
};

// Makes the description count from another origin.
void countFrom(const glm::dvec3& origin, Description& description);

// Returns whether the runtime adds a specular layer to a draw: one whose material is not diffuse, but which
// has diffuse or normal-mapped transfer (smooth dielectrics; docs/design/glossy.md), in a bundle with a
// GGX table. Bundles without tables were baked without glossy reflection, and do not show it.
bool isLayered(const Description& description, const Draw& draw);

// Largest side of a draw's texture.
inline constexpr std::uint32_t kMostTexels = 2048;
// Returns how many rows a draw has: one for each vertex, then one for each texel.
inline std::uint32_t rowCount(const Description& description, const Draw& draw) {
  return description.meshes[draw.mesh].primitives[draw.primitive].vertex_count + draw.texels * draw.texels;
}

// One byte a sample says how much a surface matters to pictures per area, relative to its mean over
// pictures, in steps of half an octave: wide enough for all that a bake weighs by, and small once compressed.
inline constexpr int kMeanImportanceCode = 64;

// `relative` is 1 at the mean; 0 says that nobody sees anything of it, and has the code 0.
inline std::uint8_t importanceCode(float relative) {
  if (!(relative > 0.0f)) return 0;
  const float code = static_cast<float>(kMeanImportanceCode) + 2.0f * std::log2(relative);
  return static_cast<std::uint8_t>(std::clamp(std::round(code), 1.0f, 127.0f));
}

// Returns log2 of what a code other than 0 stands for.
constexpr float importanceOctaves(std::uint8_t code) {
  return 0.5f * static_cast<float>(code - kMeanImportanceCode);
}

}  // namespace lambent::bundle
