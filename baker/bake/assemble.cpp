#include <algorithm>
#include <tuple>

#include <glm/geometric.hpp>

#include "baker/bake/bake_group.hpp"
#include "baker/transport/texel_samples.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::baker {

namespace {

constexpr std::uint32_t kRowsPriority = 1, kCodebookPriority = 2, kFirstPlanePriority = 3;

std::uint32_t outputsOf(SampleKind kind, int glossy_order) {
  if (kind == SampleKind::Diffuse) return 1;
  return kind == SampleKind::NormalMapped ? transfer::kMappedOutputs
                                          : static_cast<std::uint32_t>(glossy_order * glossy_order);
}

class Assembler {
  // The coded transfer of a cell of a group, and the bounds that it was coded with.
  struct Cell {
    std::size_t group, index;
    const std::vector<CodedTransfer>& coded;
    float bound, glossy_bound;
  };

 public:
  Assembler(const SceneBake& bake, BakeReport& report)
      : scene_(bake.scene), plan_(bake.plan), options_(bake.options), tables_(bake.tables), report_(report) {}

  void copyScene() {
    description_.generator = generatorOf(scene_, options_);
    description_.origin = scene_.origin;
    description_.nodes = scene_.nodes;
    description_.roots = scene_.roots;
    description_.materials = scene_.materials;
    description_.textures = scene_.textures;
    description_.cameras = scene_.cameras;
    description_.lights = scene_.lights;
    description_.animations = scene_.animations;
  }

  void addMeshes(ShippedMeshes& meshes) {
    for (std::size_t m = 0; m < scene_.meshes.size(); ++m) {
      bundle::Mesh mesh{scene_.meshes[m].name, {}};
      for (std::size_t p = 0; p < meshes.decoded[m].size(); ++p) {
        const bundle::MeshData& data = meshes.decoded[m][p];
        bundle::Primitive primitive;
        report_.mesh_bytes += meshes.draco[m][p].size();
        primitive.view = addView(std::move(meshes.draco[m][p]));
        primitive.attributes = meshes.attributes[m][p];
        primitive.material = scene_.meshes[m].primitives[p].material;
        primitive.vertex_count = static_cast<std::uint32_t>(data.positions.size());
        primitive.index_count = static_cast<std::uint32_t>(data.indices.size());
        primitive.bounds_min = primitive.bounds_max = data.positions.front();
        for (const glm::vec3& position : data.positions) {
          primitive.bounds_min = glm::min(primitive.bounds_min, position);
          primitive.bounds_max = glm::max(primitive.bounds_max, position);
        }
        for (std::size_t i = 0; i + 2 < data.indices.size(); i += 3) {
          const glm::vec3 a = data.positions[data.indices[i]], b = data.positions[data.indices[i + 1]];
          primitive.vector_area += 0.5f * glm::cross(b - a, data.positions[data.indices[i + 2]] - a);
        }
        primitive.digest = bundle::meshDigest(data);
        mesh.primitives.push_back(primitive);
      }
      description_.meshes.push_back(std::move(mesh));
    }
  }

  void addGroups(const std::vector<BakedGroup>& baked) {
    for (std::size_t g = 0; g < baked.size(); ++g) {
      const RigidGroup& planned = plan_.groups[g];
      bundle::Group& group = description_.groups.emplace_back();
      group.name = planned.name;
      group.node = planned.root;
      group.rest_translation = planned.rest_translation;
      group.rest_rotation = planned.rest_rotation;
      const glm::vec3 origin = baked[g].geometry.origin;
      group.bounds_min = origin + baked[g].geometry.bounds_min;
      group.bounds_max = origin + baked[g].geometry.bounds_max;
      group.sample_count = static_cast<std::uint32_t>(baked[g].samples.size());
      for (const PlannedLight& light : baked[g].lights)
        group.lights.push_back({light.kind == PlannedLight::Kind::Material
                                    ? bundle::GroupLight::Kind::Material
                                    : bundle::GroupLight::Kind::Node,
                                light.index, light.color, light.spheres});
      group.light_probes.clear();
      for (const glm::vec3& point : baked[g].light_probes.points)
        group.light_probes.push_back(origin + point);
      const SurfaceCells& surfaces = baked[g].surfaces;
      for (std::size_t c = 0; c < baked[g].samples.cells.size(); ++c) {
        const SampleCell& cell = baked[g].samples.cells[c];
        cells_.push_back({g, group.cells.size(), surfaces.cells[c], surfaces.figures.codes_bound,
                          surfaces.figures.glossy_codes_bound});
        group.cells.push_back({.first_sample = cell.first,
                               .sample_count = cell.count,
                               .bounds_min = origin + cell.bounds_min,
                               .bounds_max = origin + cell.bounds_max,
                               .transfers = {},
                               .light_probes = baked[g].light_probes.cells[c].points});
      }
      group.picture_error = baked[g].surfaces.figures.picture_error;
      if (baked[g].volume) addVolume(*baked[g].volume, planned, group);
      if (baked[g].neighborhood) addNeighborhood(*baked[g].neighborhood, group);
      for (std::size_t d = 0; d < planned.draws.size(); ++d)
        addDraw(planned.draws[d], static_cast<std::uint32_t>(g), d, baked[g]);
    }
  }

  void addImages() {
    for (const SceneImage& image : scene_.images) {
      report_.image_bytes += image.file_bytes.size();
      description_.images.push_back({image.name, image.mime_type, addView(image.file_bytes)});
    }
  }

  // Adds the codebooks of all cells and what else belongs to their light, then plane after plane: what is
  // wanted first lies first.
  void addTransfer(const std::vector<BakedGroup>& baked) {
    std::size_t most_planes = 0;
    const auto storedOf = [&](const Cell& cell) -> std::vector<bundle::CellTransfer>& {
      return description_.groups[cell.group].cells[cell.index].transfers;
    };
    for (const Cell& cell : cells_)
      for (const CodedTransfer& coded : cell.coded) {
        storedOf(cell).push_back(addCodebook(coded, cell));
        most_planes = std::max(most_planes, coded.planes.size());
      }
    addBrdfTables();
    addLightWeights(baked);
    addProxies(baked);
    for (std::size_t j = 0; j < most_planes; ++j)
      for (const Cell& cell : cells_)
        for (std::size_t t = 0; t < cell.coded.size(); ++t)
          if (const auto& planes = cell.coded[t].planes; j < planes.size())
            storedOf(cell)[t].planes.push_back(addPlane(planes[j], j));
    addImportance(baked, kFirstPlanePriority + static_cast<std::uint32_t>(most_planes));
  }

  AssembledBundle take() { return {std::move(description_), std::move(blobs_)}; }

 private:
  std::uint32_t addView(bundle::Blob bytes) {
    blobs_.push_back(std::move(bytes));
    return static_cast<std::uint32_t>(blobs_.size() - 1);
  }

  // Compresses the payload if that makes it smaller. A payload of nothing is compressed, too, since glTF has
  // no empty bufferViews.
  std::uint32_t addPayload(bundle::PayloadType type, bundle::Blob raw, std::uint32_t priority) {
    bundle::Payload payload{type, bundle::PayloadCodec::Raw, 0, raw.size(), priority};
    bundle::Blob packed = bundle::compressZstd(raw, options_.zstdLevel());
    if (raw.empty() || packed.size() < raw.size()) {
      payload.codec = bundle::PayloadCodec::Zstd;
      raw = std::move(packed);
    }
    payload.view = addView(std::move(raw));
    description_.payloads.push_back(payload);
    return static_cast<std::uint32_t>(description_.payloads.size() - 1);
  }

  std::uint32_t addTransferPayload(bundle::PayloadType type, bundle::Blob raw, std::uint32_t priority) {
    const std::uint32_t index = addPayload(type, std::move(raw), priority);
    report_.transfer_bytes += blobs_.back().size();
    return index;
  }

  void addGridCells(const std::vector<CodedCell>& cells, transfer::Domain domain, std::uint32_t light_probe,
                    bundle::Group& group) {
    for (const CodedCell& cell : cells) {
      cells_.push_back({description_.groups.size() - 1, group.cells.size(), cell.transfers,
                        options_.effectiveErrorBound(), options_.effectiveGlossyErrorBound()});
      group.cells.push_back({.first_sample = group.sample_count,
                             .sample_count = cell.count,
                             .bounds_min = cell.bounds_min,
                             .bounds_max = cell.bounds_max,
                             .transfers = {},
                             .light_probes = {light_probe},
                             .domain = domain});
      group.sample_count += cell.count;
    }
  }

  void addVolume(const BakedVolume& baked, const RigidGroup& planned, bundle::Group& group) {
    group.within = planned.within;
    group.light_probes = {baked.light_probe};
    std::tie(group.bounds_min, group.bounds_max) = baked.bounds();
    bundle::VolumeGrid grid{.size = baked.size,
                            .group_from_grid = baked.group_from_grid,
                            .density = 0,
                            .bits = baked.bits,
                            .density_max = baked.density_max,
                            .albedo = baked.albedo,
                            .g = baked.g,
                            .transfer_size = baked.transfer_size,
                            .voxels = 0};
    grid.density = addTransferPayload(bundle::PayloadType::Density, baked.density, kRowsPriority);
    grid.voxels =
        addTransferPayload(bundle::PayloadType::Voxels, bundle::encodeVoxels(baked.voxels), kRowsPriority);
    group.volume = grid;
    addGridCells(baked.cells, transfer::Domain::Voxel, 0, group);
  }

  // The group is taken to stand in the light of the light probe nearest to its middle.
  void addNeighborhood(const BakedNeighborhood& baked, bundle::Group& group) {
    const glm::vec3 center = 0.5f * (group.bounds_min + group.bounds_max);
    const auto nearer = [&](const glm::vec3& a, const glm::vec3& b) {
      return glm::distance(a, center) < glm::distance(b, center);
    };
    const auto nearest = std::min_element(group.light_probes.begin(), group.light_probes.end(), nearer);
    group.neighborhood = {baked.size, baked.bounds_min, baked.bounds_max};
    addGridCells(baked.cells, transfer::Domain::GridPoint,
                 static_cast<std::uint32_t>(nearest - group.light_probes.begin()), group);
  }

  // Adds all of a cell's transfer but the planes, which come after the codebooks of all cells.
  bundle::CellTransfer addCodebook(const CodedTransfer& coded, const Cell& cell) {
    bundle::CellTransfer transfer;
    transfer.shape = coded.shape;
    transfer.clusters = static_cast<std::uint32_t>(coded.codebook.clusters());
    transfer.axes = static_cast<std::uint32_t>(coded.codebook.axes.size());
    transfer.codebook = addTransferPayload(bundle::PayloadType::Codebook,
                                           transfer::encodeCodebook(coded.codebook), kCodebookPriority);
    if (transfer.clusters > 1)
      transfer.cluster_ids = static_cast<std::int32_t>(addTransferPayload(
          bundle::PayloadType::ClusterIds, transfer::encodeClusterIds(coded.cluster_of, transfer.clusters),
          kCodebookPriority));
    transfer.error_bound = coded.shape.beyondDiffuse() ? cell.glossy_bound : cell.bound;
    transfer.error = coded.error;
    return transfer;
  }

  void addBrdfTables() {
    if (tables_.entries.empty()) return;
    for (const BrdfTables::Entry& entry : tables_.entries) {
      description_.brdf_tables.push_back({entry.family, entry.name, 0});
      description_.brdf_tables.back().payload = addTransferPayload(
          bundle::PayloadType::BrdfTable,
          bundle::encodeBrdfTable(firstBands(entry.table, options_.glossy_order)), kCodebookPriority);
    }
    // Materials with a table of their own name it by its index in the bundle.
    for (std::size_t m = 0; m < tables_.of_material.size(); ++m) {
      const std::int32_t table = tables_.of_material[m];
      const bool own = table >= 0 && tables_.entries[static_cast<std::size_t>(table)].family ==
                                         bundle::BrdfFamily::Measured;
      if (own || description_.materials[m].brdf >= 0) description_.materials[m].brdf = table;
    }
  }

  void addLightWeights(const std::vector<BakedGroup>& baked) {
    for (std::size_t g = 0; g < baked.size(); ++g)
      for (std::size_t c = 0; c < baked[g].light_probes.cells.size(); ++c)
        if (const auto& weights = baked[g].light_probes.cells[c].weights; !weights.empty())
          description_.groups[g].cells[c].light_weights = static_cast<std::int32_t>(addTransferPayload(
              bundle::PayloadType::LightWeights, transfer::encodeLightWeights(weights), kCodebookPriority));
  }

  void addImportance(const std::vector<BakedGroup>& baked, std::uint32_t priority) {
    for (std::size_t g = 0; g < baked.size(); ++g)
      for (bundle::Cell& cell : description_.groups[g].cells) {
        if (baked[g].surfaces.importance.empty() || cell.domain != transfer::Domain::Vertex) continue;
        const auto codes = std::as_bytes(std::span(baked[g].surfaces.importance))
                               .subspan(cell.first_sample, cell.sample_count);
        cell.importance = static_cast<std::int32_t>(
            addTransferPayload(bundle::PayloadType::Importance, {codes.begin(), codes.end()}, priority));
      }
  }

  void addProxies(const std::vector<BakedGroup>& baked) {
    for (std::size_t g = 0; g < baked.size(); ++g) {
      if (baked[g].proxy.bytes.empty()) continue;
      description_.groups[g].proxy = static_cast<std::int32_t>(
          addPayload(bundle::PayloadType::CaptureProxy, baked[g].proxy.bytes, kCodebookPriority));
      report_.proxy_bytes += blobs_.back().size();
    }
  }

  bundle::WeightPlane addPlane(const CodedPlane& coded, std::size_t j) {
    bundle::WeightPlane plane{.payload = 0,
                              .bits = coded.bits,
                              .count = static_cast<std::uint32_t>(coded.codes.size()),
                              .variance = coded.variance};
    plane.payload = addTransferPayload(bundle::PayloadType::WeightPlane,
                                       transfer::encodeWeightPlane(coded.codes, coded.bits),
                                       kFirstPlanePriority + static_cast<std::uint32_t>(j));
    return plane;
  }

  void addDraw(const PlannedDraw& planned, std::uint32_t group, std::size_t index, const BakedGroup& baked) {
    const DrawGeometry& geometry = baked.geometry.draws[index];
    const SampleSet& samples = baked.samples;
    transfer::VertexWeights rows;
    rows.offsets.push_back(0);
    // Rows without a sample show the light that falls on them, unshadowed (bakeUnshadowed).
    const auto addRow = [&](std::uint32_t sample) {
      if (sample != kNoSample) {
        rows.samples.push_back(sample);
        rows.weights.push_back(1.0f);
      }
      rows.offsets.push_back(static_cast<std::uint32_t>(rows.samples.size()));
    };
    for (std::uint32_t v = 0; v < geometry.vertex_count; ++v)
      addRow(samples.vertex_sample[geometry.first_vertex + v]);
    bundle::Draw draw{planned.node,
                      planned.mesh,
                      planned.primitive,
                      group,
                      planned.back,
                      0,
                      outputsOf(geometry.kind, options_.glossy_order)};
    for (const TexelMap& map : samples.texels) {
      if (map.draw != index) continue;
      draw.texels = map.side;
      draw.texel_set = scene_.meshes[planned.mesh].primitives[planned.primitive].texel_set;
      for (const std::uint32_t sample : dilated(map)) addRow(sample);
      report_.texel_samples += static_cast<std::uint64_t>(
          std::ranges::count_if(map.sample_of, [](std::uint32_t sample) { return sample != kNoSample; }));
    }
    draw.rows =
        addTransferPayload(bundle::PayloadType::VertexWeights, transfer::encodeRows(rows), kRowsPriority);
    description_.draws.push_back(draw);
  }

  const Scene& scene_;
  const EffectPlan& plan_;
  const BakeOptions& options_;
  const BrdfTables& tables_;
  BakeReport& report_;
  bundle::Description description_;
  std::vector<bundle::Blob> blobs_;
  std::vector<Cell> cells_;
};

}  // namespace

AssembledBundle assemble(const SceneBake& bake, ShippedMeshes meshes, const std::vector<BakedGroup>& baked,
                         BakeReport& report) {
  Assembler assembler(bake, report);
  assembler.copyScene();
  assembler.addMeshes(meshes);
  assembler.addGroups(baked);
  assembler.addImages();
  assembler.addTransfer(baked);
  return assembler.take();
}

}  // namespace lambent::baker
