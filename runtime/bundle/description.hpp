// What stands in the JSON part of a bundle, as values: the glTF scene, where each byte range lies, and the
// extension LAMBENT_radiance_transfer that says what was baked. docs/format.md is the same in words, with
// units and the schema.
//
// Sizes: a group has samples, numbered through all its cells; codebook.hpp says what a transfer vector is.
// Every index is checked when a file is read: code past the reader need not check again.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/bundle/codebook.hpp"
#include "runtime/bundle/gltf_types.hpp"

namespace lambent::bundle {

inline constexpr std::string_view kExtensionName = "LAMBENT_radiance_transfer";
// Format versions, newest last; code asks for these names, never for a bare number.
inline constexpr std::uint32_t kVersionFirstLight = 1;
inline constexpr std::uint32_t kVersionClusteredTransfer = 2;
inline constexpr std::uint32_t kVersionLocalLight = 3;
inline constexpr std::uint32_t kVersionGlossyTransfer = 4;
inline constexpr std::uint32_t kVersionVolumesAndNeighborhoods = 5;
inline constexpr std::uint32_t kVersionWeightedNormals = 6;
inline constexpr std::uint32_t kVersionFans = 7;
inline constexpr std::uint32_t kVersionCurrent = kVersionFans;

// A byte range of the GLB's binary chunk.
struct View {
  std::uint64_t offset = 0;    // from the start of the binary chunk, a multiple of 8
  std::uint64_t length = 0;    // bytes, without padding
  std::uint64_t checksum = 0;  // XXH3-64 of the bytes and the zero padding up to the next multiple of 8
};

// Attributes of a Draco mesh: the unique id of each, -1 where absent.
struct DracoAttributes {
  std::int32_t position = -1, normal = -1, texcoord0 = -1, texcoord1 = -1, color0 = -1, tangent = -1,
               normal_weight = -1, fan = -1;
};

struct Primitive {
  std::uint32_t view = 0;  // the Draco buffer
  DracoAttributes attributes;
  std::int32_t material = -1;
  std::uint32_t vertex_count = 0;  // after decoding
  std::uint32_t index_count = 0;
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};  // of the decoded positions, in mesh space
  glm::vec3 vector_area{0.0f};  // sum of area times normal; 0 where closed, else towards the opening
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

// What a payload's bytes mean; see docs/format.md for the byte tables.
enum class PayloadType : std::uint8_t {
  VertexWeights,  // per vertex: which samples, with what weights
  Codebook,       // clusters of a cell: means and axes, binary16, and the steps of the weights
  ClusterIds,     // which cluster each sample belongs to
  WeightPlane,    // one quantized weight per sample of the clusters that have this axis
  LightWeights,   // which light probes each sample of a cell is lit from (light_weights.hpp)
  CaptureProxy,   // a group in a few triangles, as other groups see it (capture_proxy.hpp)
  BrdfTable,      // b(v) of a family of BRDFs (brdf_table.hpp)
  Density,        // extinction of a volume at its own resolution (volume_grid.hpp)
  Voxels,         // which voxels of its transfer grid a volume has samples at (volume_grid.hpp)
};

enum class PayloadCodec : std::uint8_t { Raw, Zstd };

struct Payload {
  PayloadType type = PayloadType::VertexWeights;
  PayloadCodec codec = PayloadCodec::Raw;
  std::uint32_t view = 0;
  std::uint64_t raw_length = 0;  // bytes after decompression
  std::uint32_t priority = 0;    // streaming order: lower is wanted earlier
};

// Axis j of the clusters that have so many: one code per sample of theirs. How a code becomes a weight is the
// cluster's own (AxisCode).
struct WeightPlane {
  std::uint32_t payload = 0;
  std::uint32_t bits = 8;   // 8 or 16
  std::uint32_t count = 0;  // codes: samples in clusters that have this axis
  float variance = 0.0f;    // share of the cell's weighted variance about its mean that this plane carries
};

// A part of the transfer of one cell, as a codebook and a few weights per sample (codebook.hpp).
struct CellTransfer {
  TransferShape shape;
  std::uint32_t clusters = 1;
  std::uint32_t axes = 0;           // sum over clusters
  std::uint32_t codebook = 0;       // payload
  std::int32_t cluster_ids = -1;    // payload; -1 where there is one cluster
  std::vector<WeightPlane> planes;  // by falling variance; any prefix renders
  float error_bound = 0.0f;         // relative RMS of shaded radiance over real lights that was asked for
  float error = 0.0f;               // and what the coded form reached

  bool fromEnvironment() const { return shape.order > 0; }  // else from the group's own lights
};

// Light probes that one cell may be lit from.
inline constexpr std::uint32_t kMaxLightProbes = 64;

// What the samples of a cell are points of.
enum class CellKind : std::uint8_t {
  Surface,
  Volume,       // voxels of VolumeGrid: mean radiance that arrives, of which the medium scatters its albedo
  Neighborhood  // points of NeighborhoodGrid: what the group changes in the light there, (M - I) l
};

// The unit of storage: at most 64 Ki samples.
struct Cell {
  std::uint32_t first_sample = 0, sample_count = 0;
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};  // group frame
  // What adds up: light from the environment (no light columns; of a glossy cell visibility, then, where
  // light bounces, the bounced light), then light of the group's own lights (order 0, a column for each),
  // each at most once. The same outputs in all.
  std::vector<CellTransfer> transfers;
  // Which of the group's light probes it is lit from, rising: light weights name them by their place in this
  // list. At most kMaxLightProbes. With one entry all its samples take that one whole.
  std::vector<std::uint32_t> light_probes = {0};
  std::int32_t light_weights = -1;  // payload; -1 where there is one light probe
  CellKind kind = CellKind::Surface;

  std::uint32_t outputs() const { return transfers.empty() ? 1 : transfers.front().shape.outputs; }
};

// A light that belongs to a group: it does not move in the group's frame. Column k of the group's transfer is
// the radiance that light k gives at unit strength; its colour times its strength now is the coefficient.
struct GroupLight {
  enum class Kind : std::uint8_t { Material, Node };
  Kind kind = Kind::Material;
  std::uint32_t index = 0;  // of the emissive material, or of the node that carries a KHR light
  // At rest. Material: radiance, factor times strength. Node: colour times intensity.
  glm::vec3 color{0.0f};
};

// A medium that absorbs and scatters, in a box of voxels. Density at its own resolution, for optical depth
// and ray marching; transfer on a grid of its own over the same box, at the voxels that `voxels` lists, in
// the order of the samples of the group's volume cells (outputs 1, or 9, 16 and 25 of anisotropic phase
// functions: radiance that arrives, in bands). Values stand at voxel centres, are linear between them, and
// constant in the half voxel towards the faces of the box.
struct VolumeGrid {
  glm::uvec3 size{1};               // voxels of the density
  glm::mat4 group_from_grid{1.0f};  // affine; of voxel coordinates: voxel (i, j, k) fills [i, i + 1] x ...
  std::uint32_t density = 0;        // payload
  std::uint32_t bits = 8;           // of a density code, 8 or 16
  float density_max = 0.0f;         // extinction of the largest code, in m^-1; code 0 is none
  glm::vec3 albedo{1.0f};           // share of the extinction that scatters
  float g = 0.0f;                   // Henyey-Greenstein, mean cosine, -1 < g < 1
  glm::uvec3 transfer_size{1};      // voxels of the transfer grid
  std::uint32_t voxels = 0;         // payload
};

// How the group changes the light around it, on a grid of points: the change (M - I) in the group's frame,
// which goes to 0 towards the faces of the grid. Points are the samples of the group's neighborhood cells, x
// fastest, then y, then z. Outputs: 9 (bands 0..2, all that a diffuse receiver takes), or as many bands as
// the light has, for receivers with transfer of their own.
struct NeighborhoodGrid {
  glm::uvec3 size{2};                            // points, 2 or more each way
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};  // the first and the last point, group frame
};

// The unit of transport: nodes that never move relative to each other. Transfer is stored in the group's
// frame: the rotation and place of its root node at rest, without scale.
struct Group {
  std::string name;
  std::int32_t node = -1;  // root; -1: the scene
  glm::vec3 rest_translation{0.0f};
  glm::quat rest_rotation{1.0f, 0.0f, 0.0f, 0.0f};  // world_from_group at rest
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};     // group frame
  std::uint32_t sample_count = 0;
  // Surfaces by rising outputs: plain, then normal-mapped, then glossy; then the volume, then the
  // neighborhood.
  std::vector<Cell> cells;
  std::vector<GroupLight> lights;  // one per light column, in their order
  // Where the light that comes in from outside is sampled, group frame: at least one point. All cells
  // together use every one.
  std::vector<glm::vec3> light_probes = {glm::vec3(0.0f)};
  std::int32_t proxy = -1;           // payload: what other groups see of it; -1: nothing
  std::optional<VolumeGrid> volume;  // a group with a volume is nothing else
  // Of a volume: the group that it never moves against, whose surfaces stand in its transfer; -1: none.
  std::int32_t within = -1;
  std::optional<NeighborhoodGrid> neighborhood;

  // Surface samples of the cells with so many outputs; those with fewer stand before them.
  std::uint32_t samplesWith(std::uint32_t outputs) const {
    std::uint32_t count = 0;
    for (const Cell& cell : cells)
      if (cell.kind == CellKind::Surface && cell.outputs() == outputs) count += cell.sample_count;
    return count;
  }
};

// One side of one primitive at one node: what is drawn, with transfer of its own. A double-sided material
// gives two draws of the same primitive; the back one is drawn with its winding reversed and its normals
// negated, so that both are single-sided from here on.
struct Draw {
  std::uint32_t node = 0, mesh = 0, primitive = 0, group = 0;
  bool back = false;
  std::uint32_t rows = 0;  // payload: vertex rows into the group's samples, those with as many outputs
  // 9: has a normal map, shaded per pixel from transferred light. 16, 25, 36: glossy, per pixel too.
  std::uint32_t outputs = 1;

  bool glossy() const { return isGlossy(outputs); }
};

// Whose b(v) a table holds. GGX tables serve all materials of their kind (F0 and F90 parts apart, roughness
// and anisotropy as axes); a measured one serves the materials whose `brdf` is its index in
// Description::brdf_tables.
enum class BrdfFamily : std::uint8_t { Ggx, AnisotropicGgx, Measured };

// Which of them a material that is not diffuse looks up.
inline BrdfFamily brdfFamilyOf(const gltf::Material& material) {
  if (material.brdf >= 0) return BrdfFamily::Measured;
  return material.anisotropy > 0.0f ? BrdfFamily::AnisotropicGgx : BrdfFamily::Ggx;
}

struct BrdfTableEntry {
  BrdfFamily family = BrdfFamily::Ggx;
  std::string name;           // of a measured one: its file
  std::uint32_t payload = 0;  // brdfTable
};

struct Generator {
  std::string program, version, isa;
  std::map<std::string, std::string> settings;  // option name -> value, as baked
};

struct Description {
  std::uint32_t version = kVersionCurrent;
  Generator generator;

  std::vector<gltf::Node> nodes;
  std::vector<std::int32_t> roots;
  std::vector<Mesh> meshes;
  std::vector<gltf::Material> materials;
  std::vector<gltf::Texture> textures;
  std::vector<Image> images;
  std::vector<gltf::Camera> cameras;
  std::vector<gltf::Light> lights;
  std::vector<gltf::Animation> animations;
  std::vector<BrdfTableEntry> brdf_tables;  // what the glossy materials need; empty where there are none

  std::vector<View> views;
  std::vector<Payload> payloads;
  std::vector<Group> groups;
  std::vector<Draw> draws;

  // Of all glossy cells and draws; 0 where there are none.
  std::uint32_t glossyOutputs() const {
    for (const Group& group : groups)
      for (const Cell& cell : group.cells)
        if (cell.kind == CellKind::Surface && isGlossy(cell.outputs())) return cell.outputs();
    return 0;
  }
};

}  // namespace lambent::bundle
