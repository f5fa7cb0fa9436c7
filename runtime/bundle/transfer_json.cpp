// Writes and reads the extension LAMBENT_radiance_transfer, which says what was baked and where it lies.
#include <algorithm>
#include <array>
#include <cmath>

#include <glm/matrix.hpp>

#include "runtime/bundle/description_json.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::bundle {

namespace {

constexpr std::uint32_t kMaxOrder = 8, kMaxColumns = 4096, kMaxCellSamples = 65536;
constexpr std::uint32_t kMaxClusters = 65536;
constexpr std::uint64_t kMaxPayloadBytes = std::uint64_t{1} << 32;  // limits what one payload may allocate
constexpr std::array kPayloadTypes = {"vertexRows",   "codebook",     "clusterIds", "weightPlane",
                                      "lightWeights", "captureProxy", "brdfTable",  "density",
                                      "voxels",       "importance"};
constexpr std::array kDomains = {"surface", "volume", "neighborhood"};
constexpr std::array kBrdfFamilies = {"ggx", "anisotropicGgx", "measured"};
// Glossy surfaces have transferred light in 4, 5 or 6 bands and incident light in at most 6.
constexpr std::uint32_t kMaxGlossyOrder = 6;
constexpr std::array kCodecs = {"raw", "zstd"};
constexpr std::array kLightKinds = {"material", "node"};
constexpr std::array kSides = {"front", "back"};
constexpr std::uint32_t kMaxVolumeSide = 2048, kMaxTransferSide = 256;

void outputsField(const auto& io, auto& outputs) {
  io.count("outputs", outputs, kMaxGlossyOrder * kMaxGlossyOrder);
  io.require(
      outputs == 1 || outputs == transfer::kMappedOutputs || outputs == 16 || outputs == 25 || outputs == 36,
      "outputs", "is none of 1, 9, 16, 25 and 36");
}

void bitsField(const auto& io, auto& bits) {
  io.count("bits", bits, 16);
  io.require(bits == 8 || bits == 16, "bits", "is neither 8 nor 16");
}

void shapeFields(const auto& io, auto& shape, const std::vector<GroupLight>& lights,
                 transfer::Domain domain) {
  io.count("order", shape.order, kMaxOrder);
  io.count("lightColumns", shape.light_columns, kMaxColumns);
  io.require((shape.order == 0) != (shape.light_columns == 0), "order",
             "and lightColumns: not just one of them is 0");
  io.require(shape.light_columns == 0 || shape.light_columns == lights.size(), "lightColumns",
             "are not as many as the group has lights");
  outputsField(io, shape.outputs);
  // These cells transfer light by matrices and may store only the visibility.
  const bool glossy = transfer::evaluatedAsMatrix(domain, shape.outputs);
  io.require(!glossy || shape.order <= kMaxGlossyOrder, "order", "is over 6 for glossy surfaces");
  io.count("fullChannels", shape.full_channels, 3);
  io.require(shape.full_channels != 2, "fullChannels", "is neither 0, 1 nor 3");
  // Bounced light that is stored beside the visibility has no shadowed part.
  const bool may_be_none = glossy && shape.order > 0 && shape.full_channels > 0;
  io.count("shadowedChannels", shape.shadowed_channels, 3);
  io.require(shape.shadowed_channels != 2 && (shape.shadowed_channels != 0 || may_be_none),
             "shadowedChannels", may_be_none ? "is neither 0, 1 nor 3" : "is neither 1 nor 3");
  if (!io.has("visibilityBands", shape.isVisibility())) return;
  io.count("visibilityBands", shape.visibility_bands, 2 * kMaxGlossyOrder);
  io.require(glossy && shape.order != 0 &&
                 shape.visibility_bands == shape.order + transfer::bandsOf(shape.outputs) - 1 &&
                 shape.shadowed_channels == 1 && shape.full_channels == 0,
             "visibilityBands", "are not those of the product of the light and the outputs");
}

template <class Io>
void transferFields(const Io& io, auto& transfer, const std::vector<GroupLight>& lights, const Cell& cell) {
  shapeFields(io, transfer.shape, lights, cell.domain);
  io.count("clusters", transfer.clusters, kMaxClusters);
  io.require(transfer.clusters != 0, "clusters", "is 0");
  std::uint32_t largest_count = cell.sample_count;
  io.list("planes", transfer.planes, [&](const auto& fields, auto& plane) {
    bitsField(fields, plane.bits);
    fields.count("count", plane.count, largest_count);
    largest_count = plane.count;  // a sample with an axis j + 1 has an axis j, too
    fields.payload("payload", plane.payload, PayloadType::WeightPlane,
                   std::uint64_t{plane.count} * plane.bits / 8);
    fields("variance", plane.variance);
  });
  io.require(transfer.planes.size() <= transfer.shape.size(), "planes",
             "are more than the vector has values");
  io.count("axes", transfer.axes, std::uint64_t{transfer.clusters} * transfer.planes.size());
  // The length depends on the coding, so decodeCodebook() checks it.
  io.payload("codebook", transfer.codebook, PayloadType::Codebook);
  if (Io::kReads ? transfer.clusters > 1 : transfer.cluster_ids >= 0)
    io.payload("clusterIds", transfer.cluster_ids, PayloadType::ClusterIds,
               std::uint64_t{cell.sample_count} * (transfer.clusters <= 256 ? 1 : 2));
  io("errorBound", transfer.error_bound);
  io("error", transfer.error);
}

// The light probes of a cell and, if there are several, the payload of their weights; and importance.
template <class Io>
void cellLightFields(const Io& io, auto& cell, const Group& group) {
  if constexpr (Io::kReads) {
    cell.light_probes.clear();
    for (const Field& entry : io.field()["lightSamples"].items()) {
      const std::uint32_t sample = entry.index(group.light_probes.size());
      if (!cell.light_probes.empty() && sample <= cell.light_probes.back()) entry.fault("does not rise");
      cell.light_probes.push_back(sample);
    }
  } else {
    io("lightSamples", cell.light_probes);
  }
  io.require(!cell.light_probes.empty() && cell.light_probes.size() <= kMaxLightProbes, "lightSamples",
             fmt::format("are not 1 to {}", kMaxLightProbes));
  if (Io::kReads ? cell.light_probes.size() > 1 : cell.light_weights >= 0)
    io.payload("lightWeights", cell.light_weights, PayloadType::LightWeights,
               std::uint64_t{cell.sample_count} * sizeof(transfer::LightWeights));
  else
    io.require(!io.has("lightWeights", false), "lightWeights", "are there for one light probe");
  if (io.has("importance", cell.importance >= 0))
    io.payload("importance", cell.importance, PayloadType::Importance, cell.sample_count);
}

// Checks that the parts of a cell's transfer stand in this order, each at most once: the environment (for
// glossy cells visibility, then bounced light), then the group's lights.
void checkParts(const Field& field, const Cell& cell) {
  enum Part { Environment, Bounced, Lights };
  const auto partOf = [&](const transfer::TransferShape& shape) {
    if (shape.order == 0) return Lights;
    const bool matrices = transfer::evaluatedAsMatrix(cell.domain, shape.outputs);
    return matrices && !shape.isVisibility() ? Bounced : Environment;
  };
  for (std::size_t t = 0; t < cell.transfers.size(); ++t) {
    const transfer::TransferShape& shape = cell.transfers[t].shape;
    if (shape.outputs != cell.outputs()) field.fault("differ in their outputs");
    if (t == 0 ? partOf(shape) != Environment : partOf(shape) <= partOf(cell.transfers[t - 1].shape))
      field.fault("are not the group's lights after the environment");
    if (partOf(shape) == Bounced && shape.order != cell.transfers.front().shape.order)
      field.fault("differ in their orders");
  }
}

template <class Io>
void cellFields(const Io& io, auto& cell, const Group& group, std::uint32_t first_sample) {
  io.count("firstSample", cell.first_sample, group.sample_count);
  io.require(cell.first_sample == first_sample, "firstSample", "leaves a gap between cells");
  io.count("sampleCount", cell.sample_count,
           std::min(kMaxCellSamples, group.sample_count - cell.first_sample));
  io.word("kind", cell.domain, kDomains);
  io("boundsMin", cell.bounds_min);
  io("boundsMax", cell.bounds_max);
  io.list("transfers", cell.transfers,
          [&](const auto& fields, auto& transfer) { transferFields(fields, transfer, group.lights, cell); });
  if constexpr (Io::kReads) checkParts(io.field()["transfers"], cell);
  cellLightFields(io, cell, group);
  if constexpr (Io::kReads) {
    if (group.cells.empty()) return;
    const Cell& before = group.cells.back();
    if (before.domain > cell.domain) io.field()["kind"].fault("is out of order");
    if (before.domain == transfer::Domain::Vertex && cell.domain == transfer::Domain::Vertex &&
        before.outputs() > cell.outputs())
      io.field().fault("has fewer outputs than the cell before it");
    if (before.domain == cell.domain && cell.domain != transfer::Domain::Vertex &&
        before.outputs() != cell.outputs())
      io.field().fault("has other outputs than the cell before it");
  }
}

void lampSphereFields(const auto& io, auto& sphere) {
  io("center", sphere.center);
  io("radius", sphere.radius_m);
  io("bodyRadius", sphere.body_radius_m);
  io.require(sphere.radius_m > 0.0f, "radius", "is not above 0");
  io.require(sphere.body_radius_m >= sphere.radius_m, "bodyRadius", "is below the radius");
}

template <class Io>
void groupLightFields(const Io& io, auto& light, const Description& d) {
  io.word("kind", light.kind, kLightKinds);
  const bool of_node = light.kind == GroupLight::Kind::Node;
  io.index(of_node ? "node" : "material", light.index, of_node ? d.nodes.size() : d.materials.size());
  if constexpr (Io::kReads)
    io.require(!of_node || d.nodes[light.index].light >= 0, "node", "carries no light");
  io("color", light.color);
  if (!io.has("spheres", !light.spheres.empty())) return;
  io.list("spheres", light.spheres,
          [](const auto& fields, auto& sphere) { lampSphereFields(fields, sphere); });
  io.require(light.spheres.size() <= kMaxLampSpheres, "spheres", "are too many");
  io.require(!of_node || light.spheres.empty(), "spheres", "are those of a node");
}

void pictureErrorFields(const auto& io, auto& error) {
  io.notNegative("all", error.all);
  io.notNegative("samples", error.samples);
  io.notNegative("codes", error.codes);
  io.notNegative("interpolation", error.interpolation);
  io.count("points", error.points, 0xffffffffu);
  if (io.has("bound", error.bound > 0.0f)) io.notNegative("bound", error.bound);
}

template <class Io>
void gridSizeField(const Io& io, const char* key, auto& size, std::uint32_t least, std::uint32_t most) {
  if constexpr (Io::kReads) {
    const Field field = io.field()[key];
    const auto entries = field.items();
    if (entries.size() != 3) field.fault("is not three numbers");
    for (int axis = 0; axis < 3; ++axis) {
      size[axis] = static_cast<std::uint32_t>(entries[static_cast<std::size_t>(axis)].count(most));
      if (size[axis] < least) field.fault(fmt::format("has fewer than {} along an axis", least));
    }
  } else {
    io(key, size);
  }
}

std::uint64_t countOf(const glm::uvec3& size) {
  return std::uint64_t{size.x} * size.y * size.z;
}

void volumeFields(const auto& io, auto& volume, std::uint32_t samples) {
  gridSizeField(io, "size", volume.size, 1, kMaxVolumeSide);
  io("matrix", volume.group_from_grid);
  io.require(std::abs(glm::determinant(glm::dmat3(glm::mat3(volume.group_from_grid)))) > 0.0, "matrix",
             "is flat");
  bitsField(io, volume.bits);
  io.payload("density", volume.density, PayloadType::Density, countOf(volume.size) * volume.bits / 8);
  io.notNegative("densityMax", volume.density_max);
  io("albedo", volume.albedo);
  for (int c = 0; c < 3; ++c)
    io.require(volume.albedo[c] >= 0.0f && volume.albedo[c] <= 1.0f, "albedo", "is not between 0 and 1");
  io("g", volume.g);
  io.require(std::abs(volume.g) < 1.0f, "g", "is not between -1 and 1");
  gridSizeField(io, "transferSize", volume.transfer_size, 1, kMaxTransferSide);
  io.payload("voxels", volume.voxels, PayloadType::Voxels, std::uint64_t{4} * samples);
}

void neighborhoodFields(const auto& io, auto& grid) {
  gridSizeField(io, "size", grid.size, 2, kMaxTransferSide);
  io("boundsMin", grid.bounds_min);
  io("boundsMax", grid.bounds_max);
  for (int axis = 0; axis < 3; ++axis)
    io.require(grid.bounds_min[axis] < grid.bounds_max[axis], "boundsMax", "is not beyond boundsMin");
}

// The grids of a group, whose cells have been read.
void gridFields(const auto& io, auto& group, const Description& d) {
  const std::uint32_t in_volume = group.samplesOf(transfer::Domain::Voxel);
  io.optional("volume", group.volume,
              [&](const auto& fields, auto& volume) { volumeFields(fields, volume, in_volume); });
  io.require(group.volume || in_volume == 0, "cells", "are of a volume that is not there");
  io.require(group.volume || !io.has("within", false), "within", "is there without a volume");
  io.optionalIndex("within", group.within, d.groups.size());
  io.optional("neighborhood", group.neighborhood,
              [](const auto& fields, auto& grid) { neighborhoodFields(fields, grid); });
  io.require(group.samplesOf(transfer::Domain::GridPoint) ==
                 (group.neighborhood ? countOf(group.neighborhood->size) : 0),
             "cells", "do not hold the points of the neighborhood");
}

template <class Io>
void groupFields(const Io& io, auto& group, const Description& d) {
  io("name", group.name);
  io.optionalIndex("node", group.node, d.nodes.size());
  glm::dvec3 translation = glm::dvec3(group.rest_translation) + d.origin;
  io("restTranslation", translation);
  const glm::quat& rest = group.rest_rotation;
  glm::vec4 r(rest.x, rest.y, rest.z, rest.w);  // in glTF's order
  io("restRotation", r);
  io.require(!(std::abs(glm::dot(r, r) - 1.0f) > 1e-3f), "restRotation", "is not a unit quaternion");
  if constexpr (Io::kReads) {
    group.rest_translation = glm::vec3(translation - d.origin);
    group.rest_rotation = glm::quat(r.w, r.x, r.y, r.z);
  }
  io("boundsMin", group.bounds_min);
  io("boundsMax", group.bounds_max);
  io.count("sampleCount", group.sample_count, 0xfffffffeu);
  io.list("lights", group.lights,
          [&](const auto& fields, auto& light) { groupLightFields(fields, light, d); });
  io.require(group.lights.size() <= kMaxColumns, "lights", "are too many");
  io("lightSamples", group.light_probes);
  io.require(!group.light_probes.empty(), "lightSamples", "are none");
  if (io.has("proxy", group.proxy >= 0)) io.payload("proxy", group.proxy, PayloadType::CaptureProxy);
  std::uint32_t next = 0;
  io.list("cells", group.cells, [&](const auto& fields, auto& cell) {
    cellFields(fields, cell, group, next);
    next += cell.sample_count;
  });
  io.require(next == group.sample_count, "cells", "do not hold all samples of the group");
  gridFields(io, group, d);
  io.optional("pictureError", group.picture_error,
              [](const auto& fields, auto& error) { pictureErrorFields(fields, error); });
  if constexpr (Io::kReads) {
    // Some cell must use each light probe, or light would be captured in vain. A group without cells has one,
    // too.
    std::vector<bool> used(group.light_probes.size(), group.cells.empty());
    for (const Cell& cell : group.cells)
      for (const std::uint32_t sample : cell.light_probes) used[sample] = true;
    io.require(std::find(used.begin(), used.end(), false) == used.end(), "lightSamples",
               "are not all taken by a cell");
  }
}

template <class Io>
void drawFields(const Io& io, auto& draw, const Description& d) {
  io.index("node", draw.node, d.nodes.size());
  std::size_t primitives = 0;
  if constexpr (Io::kReads) {
    const std::int32_t mesh = d.nodes[draw.node].mesh;
    io.require(mesh >= 0, "node", "has no mesh");
    draw.mesh = static_cast<std::uint32_t>(mesh);
    primitives = d.meshes[draw.mesh].primitives.size();
  }
  io.index("primitive", draw.primitive, primitives);
  io.index("group", draw.group, d.groups.size());
  io.word("side", draw.back, kSides);
  io.payload("rows", draw.rows, PayloadType::VertexWeights);
  outputsField(io, draw.outputs);
  if (!io.has("texels", draw.texels > 0)) return;
  io.require(draw.outputs == 1, "texels", "belong to a draw that is not shaded at its vertices");
  io.child("texels", [&](const auto& fields) {
    fields.count("side", draw.texels, kMostTexels);
    fields.require(draw.texels != 0, "side", "is 0");
    fields.index("texcoord", draw.texel_set, 2);
  });
  if constexpr (Io::kReads) {
    const DracoAttributes& attributes = d.meshes[draw.mesh].primitives[draw.primitive].attributes;
    io.require((draw.texel_set == 1 ? attributes.texcoord1 : attributes.texcoord0) >= 0, "texels",
               "lack their texture coordinates");
  }
}

template <class Io>
void payloadFields(const Io& io, auto& payload, const Description& d) {
  io.word("type", payload.type, kPayloadTypes);
  io.word("codec", payload.codec, kCodecs);
  io.index("bufferView", payload.view, d.views.size());
  io.count("rawLength", payload.raw_length, kMaxPayloadBytes);
  if constexpr (Io::kReads)
    io.require(payload.codec != PayloadCodec::Raw || payload.raw_length == d.views[payload.view].length,
               "rawLength", "is not the length of its bufferView");
  io.count("priority", payload.priority, 0xffffffffu);
}

void tableFields(const auto& io, auto& table) {
  io.word("family", table.family, kBrdfFamilies);
  io("name", table.name);
  io.payload("payload", table.payload, PayloadType::BrdfTable);
}

// Checks that all glossy surfaces have the same number of bands, and that the tables of their draws exist.
void checkBrdfTables(const Field& field, const Description& d) {
  const std::uint32_t outputs = d.glossyOutputs();
  for (const Group& group : d.groups)
    for (const Cell& cell : group.cells)
      if (cell.isGlossySurface() && cell.outputs() != outputs)
        field.fault("serve cells of different outputs");

  const auto has = [&](BrdfFamily family) {
    return std::any_of(d.brdf_tables.begin(), d.brdf_tables.end(),
                       [&](const BrdfTableEntry& entry) { return entry.family == family; });
  };
  for (const Draw& draw : d.draws) {
    const std::int32_t index = d.meshes[draw.mesh].primitives[draw.primitive].material;
    if (draw.glossy() && draw.outputs != outputs) field.fault("serve draws of different outputs");
    if (!draw.glossy() || index < 0) continue;
    const gltf::Material& material = d.materials[static_cast<std::size_t>(index)];
    const BrdfFamily family = brdfFamilyOf(material);
    const bool found = family == BrdfFamily::Measured
                           ? static_cast<std::size_t>(material.brdf) < d.brdf_tables.size() &&
                                 d.brdf_tables[static_cast<std::size_t>(material.brdf)].family == family
                           : has(family);
    if (!found) field.fault(fmt::format("lack the table of material {}", index));
  }
}

template <class Io>
void extensionFields(const Io& io, auto& d) {
  io.count("version", d.version, 0xffffffffu);
  io.child("generator", [&](const auto& fields) {
    fields("program", d.generator.program);
    fields("version", d.generator.version);
    fields("isa", d.generator.isa);
    fields("settings", d.generator.settings);
  });
  if constexpr (Io::kReads) {
    const auto checksums = io.field()["checksums"].items();
    io.require(checksums.size() == d.views.size(), "checksums", "are not one per bufferView");
    for (std::size_t i = 0; i < checksums.size(); ++i) d.views[i].checksum = checksums[i].hex64();
  } else {
    std::vector<Json> checksums;
    for (const View& view : d.views) checksums.push_back(hexJson(view.checksum));
    io("checksums", checksums);
  }
  if (io.has("origin", d.origin != glm::dvec3(0.0))) io("origin", d.origin);
  io.list("payloads", d.payloads,
          [&](const auto& fields, auto& payload) { payloadFields(fields, payload, d); });
  io.list("brdfTables", d.brdf_tables, [](const auto& fields, auto& table) { tableFields(fields, table); });
  io.list("groups", d.groups, [&](const auto& fields, auto& group) { groupFields(fields, group, d); });
  io.list("draws", d.draws, [&](const auto& fields, auto& draw) { drawFields(fields, draw, d); });
}

}  // namespace

Json writeTransfer(const Description& d) {
  return written(d, [&](const auto& io) { extensionFields(io, d); });
}

void readTransfer(const Field& extension, Description& d) {
  extensionFields(FieldReader(extension, d), d);
  checkBrdfTables(extension["brdfTables"], d);
}

}  // namespace lambent::bundle
