// What of the loaded bundles lies on the GPU, as tables that effects and the frame read: meshes, rigid
// groups, cells of transfer, volumes and draws. An entry has a version that rises when something that it
// refers to arrived. Residency (residency.hpp) owns the memory behind them and changes them; here is what
// they hold, how they are made from a bundle's description and how bundles come into them and go. No GL.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/mat3x3.hpp>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/gpu/arena.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/streaming/brdf_texture.hpp"
#include "runtime/streaming/image_uses.hpp"

namespace lambent::streaming {

// A primitive of a mesh: one block of the geometry arena. Words are from the start of the page; 0xffffffff:
// absent.
struct ResidentMesh {
  static constexpr std::uint32_t kAbsent = 0xffffffffu;
  gpu::Allocation block;  // empty: not here yet
  std::uint32_t vertex_count = 0, index_count = 0;
  glm::vec3 center{0.0f};                                // of its bounds, mesh space
  float mean_edge = 0.0f;                                // length, mesh space; known once it is here
  std::uint32_t positions_word = 0, normals_word = 0;    // 3 floats each
  std::uint32_t texcoords_word[2] = {kAbsent, kAbsent};  // 2 floats
  std::uint32_t colors_word = kAbsent;                   // 4 x unorm16
  std::uint32_t tangents_word = kAbsent;                 // 4 floats
  std::uint32_t indices_word = 0;                        // uint32
};

struct ResidentPlane {
  gpu::Allocation block;   // codes, in the order of positions, in the page of the cell; empty: not here
  std::uint32_t word = 0;  // where they begin
  std::uint32_t bits = 8;
  std::uint32_t count = 0;
  float variance = 0.0f;
};

// Words of the cell's block; diffuse_shared.h has the layout.
struct ResidentTransfer {
  bundle::TransferShape shape;
  std::uint32_t clusters = 1, axes = 0;
  std::uint32_t clusters_word = 0;   // per cluster: its first vector, its number of axes
  std::uint32_t weights_word = 0;    // per vector: offset and scale of its weight; 1 and 0 of a mean
  std::uint32_t vectors_word = 0;    // shape.size() floats each: of every cluster the mean, then the axes
  std::uint32_t positions_word = 0;  // per position: sample of the cell | cluster << 16
  std::vector<ResidentPlane> planes;
  bool codebook_resident = false;
  std::uint32_t planes_resident = 0;  // a prefix of `planes`
};

struct ResidentCell {
  std::uint64_t id = 0;
  std::uint32_t group = 0;  // into groups()
  bundle::CellKind kind = bundle::CellKind::Surface;
  std::uint32_t first_sample = 0, sample_count = 0;
  std::uint32_t outputs = 1;
  // vec4 index, in the page of the group's samples, of output 0 of its first sample; then sample by sample.
  std::uint32_t first_output = 0;
  gpu::Allocation block;  // transfer arena: light weights and codebooks; reserved with the first of them
  std::vector<ResidentTransfer> transfers;
  std::vector<std::uint32_t> light_probes;  // of the group; light weights name them by place
  std::uint32_t light_weights_word = 0;     // per sample two words: four places, four weights of 255
  bool light_weights_resident = false;      // always, where there is one light probe
  std::uint64_t version = 0;

  // Enough has arrived to look better than no shadows at all: light weights, every transfer with its codebook
  // and with planes that carry kUsableVariance of what all its planes carry.
  bool usable() const;
  // Light transferred by matrices, the glossy effect's to shade: of glossy surfaces, of neighborhoods, and of
  // volumes with as many outputs.
  bool matrices() const { return bundle::isGlossy(outputs) || kind == bundle::CellKind::Neighborhood; }
};
inline constexpr float kUsableVariance = 0.9f;

// The grids of a volume. Its samples are those of its group, all in volume cells.
struct ResidentVolume {
  std::uint64_t id = 0;
  std::uint32_t group = 0;  // into groups()
  bundle::VolumeGrid grid;
  std::uint32_t outputs = 1;        // of its samples
  gpu::Texture density;             // red: share of grid.density_max; empty handle: not here yet
  std::vector<float> block_maxima;  // volume_blocks.hpp; stays in memory
  gpu::Buffer voxels;  // a word per sample: its voxel of the transfer grid; empty handle: not here yet
  std::uint32_t sample_count = 0;
  std::uint64_t version = 0;

  bool ready() const { return density && voxels; }
};

struct ResidentGroup {
  std::uint64_t id = 0;
  std::uint32_t bundle = 0, index = 0;  // in its description
  std::uint32_t order = 1, light_columns = 0;
  std::uint32_t first_cell = 0, cell_count = 0;  // into cells()
  // Samples of surfaces by their outputs, in this order: one, nine, and those of glossy surfaces. Those of
  // its volume and its neighborhood lie behind them (ResidentCell::first_output).
  std::uint32_t diffuse_samples = 0, mapped_samples = 0;
  std::uint32_t glossy_outputs = 0;  // of its glossy samples; 0: it has none
  // A vec4 per sample and output, zero until shaded. w: 1 once it is; of glossy samples V_i, the visibility's
  // own coefficient.
  gpu::Allocation samples;
  std::vector<glm::vec3> light_probes;  // group frame
  std::int32_t volume = -1;             // into volumes(); -1: it is surfaces
  // What other groups see of it; stays in memory, for it is small. None: not here yet, or nothing to see.
  std::optional<bundle::CaptureProxy> proxy;

  // vec4 index of output o of sample s in the page: sampleBase(outputs) + outputs * s + o. May wrap round.
  std::uint32_t sampleBase(std::uint32_t outputs) const {
    const std::uint32_t plain = outputs > 1 ? (outputs - 1) * diffuse_samples : 0;
    const std::uint32_t mapped =
        bundle::isGlossy(outputs) ? (outputs - bundle::kMappedOutputs) * mapped_samples : 0;
    return samples.word() / 4 - plain - mapped;
  }
};

struct ResidentDraw {
  std::uint64_t id = 0;
  std::uint32_t bundle = 0, index = 0;     // in its description
  std::uint32_t group = 0, mesh = 0;       // into groups() and meshes()
  std::int32_t material = -1;              // of the bundle
  bool back = false;                       // the back of a double-sided surface
  std::uint32_t outputs = 1;               // 9: normal-mapped; more: glossy
  glm::mat3 group_from_mesh_normal{1.0f};  // of a back, negated
  gpu::Allocation
      rows;  // vertex_count + 1 offsets, row_entries samples, row_entries unorm16 weights; empty: not here
  std::uint32_t row_entries = 0;
  gpu::Allocation
      radiance;  // radianceWords(outputs) floats per vertex, once the mesh is here; none where glossy
  std::uint64_t version = 0;

  bool glossy() const { return bundle::isGlossy(outputs); }
};

// Entries of each table.
struct TableSizes {
  std::uint32_t meshes = 0, groups = 0, cells = 0, draws = 0, volumes = 0;
};

struct ResidentBundle {
  bool present = false;  // else all of it is empty: the slot of one that was closed
  std::vector<gltf::Material> materials;
  std::vector<gltf::Texture> textures;
  // By image; empty handle: not here yet. Colours are decoded from sRGB where they are looked up, numbers are
  // not; an image that serves as both lies in both, for each way of reading it has mip levels of its own.
  std::vector<gpu::Texture> images, linear_images;
  std::vector<ImageUse> image_uses;
  std::vector<bundle::BrdfFamily> brdf_families;  // of the tables
  std::vector<BrdfTexture> brdf_tables;           // without a texture: not here yet
  std::uint64_t texture_bytes = 0;                // of all these, of densities and of lists of voxels
  // Its entries of the tables, one after the other.
  TableSizes first, count;
  std::vector<std::uint32_t> first_primitive;  // of each mesh, among the bundle's entries of meshes()
};

// The tables of what is shown, bundle after bundle in the order of their slots: or of one bundle alone,
// before it is shown. Indices between tables are of the same ResidentTables. Cells, volumes, groups and draws
// have ids that no other entry of the residency ever had: what somebody keeps for them follows by ids
// (base/keyed_state.hpp).
struct ResidentTables {
  std::vector<ResidentBundle> bundles;
  std::vector<ResidentMesh> meshes;
  std::vector<ResidentGroup> groups;
  std::vector<ResidentCell> cells;
  std::vector<ResidentDraw> draws;
  std::vector<ResidentVolume> volumes;
};

inline ResidentCell& cellOf(ResidentTables& tables, const ResidentBundle& bundle, std::uint32_t group,
                            std::uint32_t cell) {
  return tables.cells[tables.groups[bundle.first.groups + group].first_cell + cell];
}

// Of one bundle, with nothing of it here yet; ids from next_id on, which rises.
ResidentTables tablesOf(const bundle::Description& description, std::uint64_t version,
                        std::uint64_t& next_id);
// Puts `one`, of a single bundle, into a slot that is empty or new.
void insert(ResidentTables& tables, std::uint32_t slot, ResidentTables one);
// Leaves the slot empty.
ResidentTables extract(ResidentTables& tables, std::uint32_t slot);

}  // namespace lambent::streaming
