// Holds tables of what is resident on the GPU, for effects and the frame: meshes, rigid groups, cells of
// transfer, volumes and draws. The version of an entry rises when something that it refers to is loaded.
// Residency (residency.hpp) owns the memory and changes the entries. The functions here make tables from a
// bundle's description, and insert and remove bundles, without GL.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/mat3x3.hpp>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/gpu/arena.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/streaming/textures.hpp"
#include "runtime/transfer/seen_sky_shared.h"

namespace lambent::streaming {

// Computes the GPU memory of a bundle from its description, in bytes for each arena. Residency limits its
// pages to these sizes, and parts.hpp counts with them.

// Returns the number of floats that are written per vertex of a draw: E/pi as RGB and the luminance of what
// comes straight from lights that are shaded per pixel, or light in bands 0..2 for normal maps as RGB. Glossy
// draws need none, since they use samples at each pixel.
constexpr std::uint32_t radianceWords(transfer::Form form) {
  if (form == transfer::Form::Vector) return 4;
  return form == transfer::Form::NormalMapped ? 3 * transfer::kMappedOutputs : 0;
}

// Returns the number of words per vertex that a draw keeps beside its mesh: these, and with a specular layer
// what it sees of the sky.
constexpr std::uint32_t vertexWords(transfer::Form form, bool layered) {
  return radianceWords(form) + (layered ? transfer::kSeenWords : 0);
}

// Words per sample if its cell has several light probes.
inline constexpr std::uint32_t kLightWeightWords = 2;

// Returns the size of a plane's codes, which are a block of their own.
std::uint64_t planeBytes(const bundle::WeightPlane& plane);
// Returns the size of a codebook as the kernels read it (transfer_shared.h), with the positions of the
// samples.
std::uint64_t codebookBytesOnGpu(const bundle::CellTransfer& transfer, std::uint32_t sample_count);
std::uint64_t cellBytes(const bundle::Cell& cell);
// Returns the number of vec4 for the shaded samples of a group.
std::uint64_t samplesOf(const bundle::Group& group);

// Returns the size of the density on the GPU, which has 16 bits per voxel.
constexpr std::uint64_t densityBytes(const glm::uvec3& size) {
  return std::uint64_t{2} * size.x * size.y * size.z;
}
// Returns the size of a square texture of E/pi with all mip levels.
std::uint64_t irradianceBytes(std::uint32_t side);
// Returns the size of the density and the list of voxels.
std::uint64_t volumeBytes(const bundle::VolumeGrid& grid, std::uint64_t sample_count);
// Returns the size of the light in a volume: a texel of half floats per voxel of the transfer grid and
// output.
std::uint64_t volumeLightBytes(const bundle::Group& group);

// Size limits for a group that is drawn as its capture proxy (surface/proxy_lods.hpp).
inline constexpr std::uint64_t kProxyLodTriangleBytes = 64, kProxyLodGroupBytes = 208;
// Returns an upper bound of the memory of such a group.
std::uint64_t proxyLodBytes(const bundle::Description& description, bundle::GroupIndex group);

struct Needs {
  std::uint64_t geometry = 0, transfer = 0, samples = 0, rows = 0, radiance = 0, textures = 0, volumes = 0;

  std::uint64_t total() const { return geometry + transfer + samples + rows + radiance + textures + volumes; }
};
// Returns upper bounds, since the sizes of rows are derived from their length in the file.
Needs needsOf(const bundle::Description& description);

// Describes a primitive of a mesh, which is one block of the geometry arena. Words count from the start of
// the page; an absent attribute has kAbsent.
struct ResidentMesh {
  static constexpr std::uint32_t kAbsent = 0xffffffffu;
  gpu::Allocation block;  // empty until the mesh is loaded
  std::uint32_t vertex_count = 0, index_count = 0;
  glm::vec3 center{0.0f};                                // centre of the bounds, in mesh space
  float mean_edge = 0.0f;                                // mean edge length in mesh space, once loaded
  std::uint32_t positions_word = 0, normals_word = 0;    // 3 floats each
  std::uint32_t texcoords_word[2] = {kAbsent, kAbsent};  // 2 floats
  std::uint32_t colors_word = kAbsent;                   // 4 x unorm16
  std::uint32_t tangents_word = kAbsent;                 // 4 floats
  std::uint32_t indices_word = 0;                        // uint32
};

struct ResidentPlane : bundle::WeightPlane {
  gpu::Allocation block{};  // codes by position, in the page of the cell; empty if not loaded
};

// Describes one transfer of a cell. Words are in the cell's page; transfer_shared.h has the layout.
struct ResidentTransfer {
  transfer::TransferShape shape;
  std::uint32_t clusters = 1, axes = 0;
  std::uint32_t clusters_word = 0;   // first vector and number of axes of each cluster
  std::uint32_t weights_word = 0;    // offset and scale of each vector's weight; 1 and 0 for a mean
  std::uint32_t vectors_word = 0;    // mean and axes of each cluster, shape.size() floats each
  std::uint32_t positions_word = 0;  // sample of the cell | cluster << 16, for each position
  std::vector<ResidentPlane> planes;
  bool codebook_resident = false;
  std::uint32_t planes_resident = 0;  // number of loaded planes, which are the first ones
};

struct ResidentCell {
  std::uint64_t id = 0;
  std::uint32_t group = 0;  // index into groups()
  transfer::Domain domain = transfer::Domain::Vertex;
  std::uint32_t first_sample = 0, sample_count = 0;
  std::uint32_t outputs = 1;
  // Index, as vec4 in the page of the group's samples, of output 0 of the cell's first sample. The other
  // outputs and samples follow, sample by sample.
  std::uint32_t first_output = 0;
  gpu::Allocation block;  // light weights and codebooks; allocated when the first of them is uploaded
  std::vector<ResidentTransfer> transfers;
  std::vector<std::uint32_t> light_probes;  // probes of the group; light weights refer to places in this list
  std::uint32_t light_weights_word = 0;     // two words per sample: four places, then four weights of 255
  bool light_weights_resident = false;      // always true if there is one light probe
  std::uint64_t version = 0;

  // Returns whether enough is loaded to look better than no shadows at all. This needs the light weights and,
  // for every transfer, the codebook and planes with kUsableVariance of the variance of all planes.
  bool usable() const;
  // Returns whether light is transferred by matrices, so that the glossy effect shades the cell. This holds
  // for glossy surfaces, neighborhoods, and volumes with as many outputs.
  bool matrices() const { return transfer::evaluatedAsMatrix(domain, outputs); }
  transfer::Form form() const { return transfer::formOf(domain, outputs); }
};
inline constexpr float kUsableVariance = 0.9f;

// Describes the grids of a volume. Its samples are those of its group, which has volume cells only.
struct ResidentVolume {
  std::uint64_t id = 0;
  std::uint32_t group = 0;  // index into groups()
  bundle::VolumeGrid grid;
  std::uint32_t outputs = 1;        // outputs of its samples
  gpu::Texture density;             // share of grid.density_max in red; empty until loaded
  std::vector<float> block_maxima;  // loader.hpp; kept in memory of the CPU
  gpu::Buffer voxels;               // voxel of the transfer grid for each sample; empty until loaded
  std::uint32_t sample_count = 0;
  std::uint64_t version = 0;

  bool ready() const { return density && voxels; }
};

// Samples of one form, which lie one after the other among those of a group and in the page that holds them.
struct SampleStretch {
  std::uint32_t first_sample = 0;  // among the group's samples
  std::uint32_t first_output = 0;  // vec4 index, in the page, of output 0 of that sample
  std::uint32_t outputs = 1;       // vec4s of a sample

  // Returns the vec4 index of output 0 of a sample of the group.
  std::uint32_t outputOf(std::uint32_t sample) const {
    return first_output + outputs * (sample - first_sample);
  }
};

struct ResidentGroup {
  std::uint64_t id = 0;
  std::uint32_t bundle = 0;  // slot of the bundle
  bundle::GroupIndex index;
  std::uint32_t order = 1, light_columns = 0;
  std::uint32_t first_cell = 0, cell_count = 0;  // range of cells()
  // Samples of surfaces are ordered by outputs: those with one, with nine, and glossy ones. The samples of
  // the group's volume and neighborhood follow (ResidentCell::first_output).
  std::uint32_t diffuse_samples = 0, mapped_samples = 0;
  std::uint32_t glossy_outputs = 0;  // outputs of its glossy samples; 0 if it has none
  // One vec4 per sample and output, which is zero until shaded. w is then 1, or, for glossy samples, the
  // coefficient V_i of the visibility.
  gpu::Allocation samples;
  std::vector<glm::vec3> light_probes;  // in the group's frame
  std::int32_t volume = -1;             // index into volumes(); -1 if the group has surfaces instead
  // The capture proxy that other groups see, which is small and kept in memory. It is absent until loaded, or
  // if the group has none.
  std::optional<bundle::CaptureProxy> proxy;

  // Returns where the samples of surfaces of a form lie.
  SampleStretch stretchOf(transfer::Form form) const {
    const std::uint32_t base = samples.word() / 4, mapped_output = base + diffuse_samples;
    if (form == transfer::Form::Vector) return {.first_sample = 0, .first_output = base, .outputs = 1};
    if (form == transfer::Form::NormalMapped)
      return {.first_sample = diffuse_samples,
              .first_output = mapped_output,
              .outputs = transfer::kMappedOutputs};
    return {.first_sample = diffuse_samples + mapped_samples,
            .first_output = mapped_output + transfer::kMappedOutputs * mapped_samples,
            .outputs = glossy_outputs};
  }
  // Returns the form of a sample of its surfaces.
  transfer::Form formOf(std::uint32_t sample) const {
    if (sample < diffuse_samples) return transfer::Form::Vector;
    return sample < diffuse_samples + mapped_samples ? transfer::Form::NormalMapped : transfer::Form::Matrix;
  }
};

struct ResidentDraw {
  std::uint64_t id = 0;
  std::uint32_t bundle = 0, index = 0;  // slot of the bundle, and index in its description
  std::uint32_t group = 0, mesh = 0;    // indices into groups() and meshes()
  std::int32_t material = -1;           // material of the bundle
  bool back = false;                    // true for the back of a double-sided surface
  std::uint32_t outputs = 1;            // 9 if normal-mapped, more if glossy
  bool layered = false;                 // has a specular layer over diffuse transfer, see bundle::isLayered()
  glm::mat3 group_from_mesh{1.0f};      // without the translation
  glm::mat3 group_from_mesh_normal{1.0f};  // of any length, negated for a back
  // vertex_count + 1 offsets, row_entries samples and row_entries unorm16 weights; empty until loaded.
  gpu::Allocation rows;
  std::uint32_t row_entries = 0;
  // radianceWords(form) floats per vertex, once the mesh is loaded; empty for glossy draws. With a layer,
  // what each vertex sees of the sky follows (transfer/seen_sky_shared.h).
  gpu::Allocation radiance;
  // Side of its texture of E/pi, and the set of texture coordinates that looks it up; 0: it has none.
  std::uint32_t texels = 0, texel_set = 0;
  gpu::Allocation texel_rows;  // the sample of each texel; empty until loaded
  // E/pi in rgb times the share of it that is shaded, and that share in alpha, with all mip levels; once the
  // mesh is loaded.
  gpu::Texture irradiance;
  std::uint64_t version = 0;

  transfer::Form form() const { return transfer::formOf(transfer::Domain::Vertex, outputs); }
  bool glossy() const { return form() == transfer::Form::Matrix; }
  // Returns the first word of what the vertices see of the sky; its mesh must be loaded.
  std::uint32_t seenWord(const ResidentMesh& of) const;
};

// Numbers of entries of each table.
struct TableSizes {
  std::uint32_t meshes = 0, groups = 0, cells = 0, draws = 0, volumes = 0;
};

struct ResidentBundle {
  bool present = false;  // false if the slot is empty
  std::vector<gltf::Material> materials;
  std::vector<gltf::Texture> textures;
  // Textures by image, which are empty until loaded. Look-ups decode colours from sRGB, but not numbers. An
  // image that serves as both is in both lists, because its mip levels differ.
  std::vector<gpu::Texture> images, linear_images;
  std::vector<ImageUse> image_uses;
  std::vector<bundle::BrdfFamily> brdf_families;  // family of each table
  std::vector<BrdfTexture> brdf_tables;           // without a texture until loaded
  std::uint64_t texture_bytes = 0;                // size of all these, of densities and of lists of voxels
  // Ranges of the bundle's entries in the tables.
  TableSizes first, count;
  std::vector<std::uint32_t> first_primitive;  // first of each mesh, among the bundle's entries of meshes()
};

// The tables of all bundles that are shown, in the order of their slots, or of one bundle that is staged.
// Indices refer to tables of the same ResidentTables. Cells, volumes, groups and draws have ids that no other
// entry of the residency ever had, so other code can keep state for them by id (base/change_gate.hpp).
struct ResidentTables {
  std::vector<ResidentBundle> bundles;
  std::vector<ResidentMesh> meshes;
  std::vector<ResidentGroup> groups;
  std::vector<ResidentCell> cells;
  std::vector<ResidentDraw> draws;
  std::vector<ResidentVolume> volumes;
};

inline ResidentCell& cellOf(ResidentTables& tables, const ResidentBundle& bundle, bundle::GroupIndex group,
                            bundle::CellIndex cell) {
  return tables.cells[tables.groups[bundle.first.groups + group.value].first_cell + cell.value];
}

// Makes the tables of one bundle with nothing loaded. Ids start at next_id, which it advances.
ResidentTables tablesOf(const bundle::Description& description, std::uint64_t version,
                        std::uint64_t& next_id);
// Inserts the tables of a single bundle into a slot that is empty or new.
void insert(ResidentTables& tables, std::uint32_t slot, ResidentTables one);
// Removes the tables of the bundle in a slot and returns them. The slot is then empty.
ResidentTables extract(ResidentTables& tables, std::uint32_t slot);

}  // namespace lambent::streaming
