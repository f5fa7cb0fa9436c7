// Writes and reads the extension LAMBENT_radiance_transfer, which says what was baked and where it lies.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "runtime/bundle/description.hpp"
#include "runtime/bundle/gltf_parts.hpp"
#include "runtime/bundle/json_fields.hpp"
#include "runtime/transfer/weights.hpp"

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

template <typename Enum, std::size_t N>
Enum readWord(const Field& field, const std::array<const char*, N>& words) {
  const std::string text = field.text();
  const auto found = std::find(words.begin(), words.end(), text);
  if (found == words.end()) field.fault("is \"" + text + "\", which this program does not know");
  return static_cast<Enum>(found - words.begin());
}

template <typename Enum, std::size_t N>
const char* word(Enum value, const std::array<const char*, N>& words) {
  return words[static_cast<std::size_t>(value)];
}

Json cellTransferJson(const CellTransfer& transfer) {
  Json planes = Json::array();
  for (const WeightPlane& plane : transfer.planes)
    planes.push_back({{"payload", plane.payload},
                      {"bits", plane.bits},
                      {"count", plane.count},
                      {"variance", plane.variance}});
  Json json = {{"order", transfer.shape.order},
               {"lightColumns", transfer.shape.light_columns},
               {"shadowedChannels", transfer.shape.shadowed_channels},
               {"fullChannels", transfer.shape.full_channels},
               {"outputs", transfer.shape.outputs},
               {"clusters", transfer.clusters},
               {"axes", transfer.axes},
               {"codebook", transfer.codebook},
               {"planes", planes},
               {"errorBound", transfer.error_bound},
               {"error", transfer.error}};
  if (transfer.shape.isVisibility()) json["visibilityBands"] = transfer.shape.visibility_bands;
  if (transfer.cluster_ids >= 0) json["clusterIds"] = transfer.cluster_ids;
  return json;
}

std::uint32_t readOutputs(const Field& field) {
  const auto outputs = static_cast<std::uint32_t>(field.count(kMaxGlossyOrder * kMaxGlossyOrder));
  if (outputs != 1 && outputs != transfer::kMappedOutputs && outputs != 16 && outputs != 25 && outputs != 36)
    field.fault("is none of 1, 9, 16, 25 and 36");
  return outputs;
}

std::uint32_t readChannels(const Field& field, bool may_be_none) {
  const auto channels = static_cast<std::uint32_t>(field.count(3));
  if (channels == 2 || (channels == 0 && !may_be_none))
    field.fault(may_be_none ? "is neither 0, 1 nor 3" : "is neither 1 nor 3");
  return channels;
}

transfer::TransferShape readShape(const Field& field, const std::vector<GroupLight>& lights,
                                  transfer::Domain domain) {
  transfer::TransferShape shape;
  shape.order = static_cast<std::uint32_t>(field["order"].count(kMaxOrder));
  shape.light_columns = static_cast<std::uint32_t>(field["lightColumns"].count(kMaxColumns));
  if ((shape.order == 0) == (shape.light_columns == 0))
    field["order"].fault("and lightColumns: not just one of them is 0");
  if (shape.light_columns != 0 && shape.light_columns != lights.size())
    field["lightColumns"].fault("are not as many as the group has lights");
  shape.outputs = readOutputs(field["outputs"]);
  // These cells transfer light by matrices and may store only the visibility.
  const bool glossy = transfer::evaluatedAsMatrix(domain, shape.outputs);
  if (glossy && shape.order > kMaxGlossyOrder) field["order"].fault("is over 6 for glossy surfaces");
  shape.full_channels = readChannels(field["fullChannels"], /*may_be_none=*/true);
  // Bounced light that is stored beside the visibility has no shadowed part.
  shape.shadowed_channels =
      readChannels(field["shadowedChannels"],
                   /*may_be_none=*/glossy && shape.order > 0 && shape.full_channels > 0);
  if (field.has("visibilityBands")) {
    shape.visibility_bands = static_cast<std::uint32_t>(field["visibilityBands"].count(2 * kMaxGlossyOrder));
    if (!glossy || shape.order == 0 ||
        shape.visibility_bands != shape.order + transfer::bandsOf(shape.outputs) - 1 ||
        shape.shadowed_channels != 1 || shape.full_channels != 0)
      field["visibilityBands"].fault("are not those of the product of the light and the outputs");
  }
  return shape;
}

WeightPlane readPlane(const Field& field, const Description& d, std::uint32_t largest_count) {
  WeightPlane plane;
  plane.bits = static_cast<std::uint32_t>(field["bits"].count(16));
  if (plane.bits != 8 && plane.bits != 16) field["bits"].fault("is neither 8 nor 16");
  plane.count = static_cast<std::uint32_t>(field["count"].count(largest_count));
  plane.payload = payloadIndex(field["payload"], d, PayloadType::WeightPlane,
                               std::uint64_t{plane.count} * plane.bits / 8);
  plane.variance = field["variance"].number();
  return plane;
}

CellTransfer readCellTransfer(const Field& field, const Description& d, const Group& group,
                              std::uint32_t sample_count, transfer::Domain domain) {
  CellTransfer transfer;
  transfer.shape = readShape(field, group.lights, domain);
  transfer.clusters = static_cast<std::uint32_t>(field["clusters"].count(kMaxClusters));
  if (transfer.clusters == 0) field["clusters"].fault("is 0");
  const auto planes = field["planes"].items();
  if (planes.size() > transfer.shape.size()) field["planes"].fault("are more than the vector has values");
  transfer.axes =
      static_cast<std::uint32_t>(field["axes"].count(std::uint64_t{transfer.clusters} * planes.size()));
  // The length depends on the coding, so decodeCodebook() checks it.
  transfer.codebook = payloadIndex(field["codebook"], d, PayloadType::Codebook, std::nullopt);
  if (transfer.clusters > 1)
    transfer.cluster_ids = static_cast<std::int32_t>(
        payloadIndex(field["clusterIds"], d, PayloadType::ClusterIds,
                     std::uint64_t{sample_count} * (transfer.clusters <= 256 ? 1 : 2)));
  std::uint32_t largest_count = sample_count;
  for (const Field& entry : planes) {
    transfer.planes.push_back(readPlane(entry, d, largest_count));
    largest_count = transfer.planes.back().count;  // a sample with an axis j + 1 has an axis j, too
  }
  transfer.error_bound = field["errorBound"].number();
  transfer.error = field["error"].number();
  return transfer;
}

// Reads the light probes of a cell and, if there are several, the payload of their weights; and importance.
void readCellLights(const Field& field, const Description& d, const Group& group, Cell& cell) {
  const Field list = field["lightSamples"];
  cell.light_probes.clear();
  for (const Field& entry : list.items()) {
    const std::uint32_t sample = entry.index(group.light_probes.size());
    if (!cell.light_probes.empty() && sample <= cell.light_probes.back()) entry.fault("does not rise");
    cell.light_probes.push_back(sample);
  }
  if (cell.light_probes.empty() || cell.light_probes.size() > kMaxLightProbes)
    list.fault(fmt::format("are not 1 to {}", kMaxLightProbes));
  if (cell.light_probes.size() > 1)
    cell.light_weights = static_cast<std::int32_t>(
        payloadIndex(field["lightWeights"], d, PayloadType::LightWeights,
                     std::uint64_t{cell.sample_count} * sizeof(transfer::LightWeights)));
  else if (field.has("lightWeights"))
    field["lightWeights"].fault("are there for one light probe");
  if (field.has("importance"))
    cell.importance = static_cast<std::int32_t>(
        payloadIndex(field["importance"], d, PayloadType::Importance, cell.sample_count));
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

Cell readCell(const Field& field, const Description& d, const Group& group, std::uint32_t first_sample) {
  Cell cell;
  cell.first_sample = static_cast<std::uint32_t>(field["firstSample"].count(group.sample_count));
  if (cell.first_sample != first_sample) field["firstSample"].fault("leaves a gap between cells");
  cell.sample_count = static_cast<std::uint32_t>(
      field["sampleCount"].count(std::min(kMaxCellSamples, group.sample_count - cell.first_sample)));
  cell.domain = readWord<transfer::Domain>(field["kind"], kDomains);
  cell.bounds_min = field["boundsMin"].vector<glm::vec3>();
  cell.bounds_max = field["boundsMax"].vector<glm::vec3>();
  for (const Field& entry : field["transfers"].items())
    cell.transfers.push_back(readCellTransfer(entry, d, group, cell.sample_count, cell.domain));
  checkParts(field["transfers"], cell);
  readCellLights(field, d, group, cell);
  if (!group.cells.empty()) {
    const Cell& before = group.cells.back();
    if (before.domain > cell.domain) field["kind"].fault("is out of order");
    if (before.domain == transfer::Domain::Vertex && cell.domain == transfer::Domain::Vertex &&
        before.outputs() > cell.outputs())
      field.fault("has fewer outputs than the cell before it");
    if (before.domain == cell.domain && cell.domain != transfer::Domain::Vertex &&
        before.outputs() != cell.outputs())
      field.fault("has other outputs than the cell before it");
  }
  return cell;
}

LampSphere readLampSphere(const Field& field) {
  LampSphere sphere{.center = field["center"].vector<glm::vec3>(),
                    .radius_m = field["radius"].number(),
                    .body_radius_m = field["bodyRadius"].number()};
  if (!(sphere.radius_m > 0.0f)) field["radius"].fault("is not above 0");
  if (sphere.body_radius_m < sphere.radius_m) field["bodyRadius"].fault("is below the radius");
  return sphere;
}

GroupLight readGroupLight(const Field& field, const Description& d) {
  GroupLight light;
  light.kind = readWord<GroupLight::Kind>(field["kind"], kLightKinds);
  light.index = light.kind == GroupLight::Kind::Material ? field["material"].index(d.materials.size())
                                                         : field["node"].index(d.nodes.size());
  if (light.kind == GroupLight::Kind::Node && d.nodes[light.index].light < 0)
    field["node"].fault("carries no light");
  light.color = field["color"].vector<glm::vec3>();
  for (const Field& entry : field.list("spheres")) light.spheres.push_back(readLampSphere(entry));
  if (light.spheres.size() > kMaxLampSpheres) field["spheres"].fault("are too many");
  if (light.kind == GroupLight::Kind::Node && !light.spheres.empty())
    field["spheres"].fault("are those of a node");
  return light;
}

Json cellJson(const Cell& cell) {
  Json transfers = Json::array();
  for (const CellTransfer& transfer : cell.transfers) transfers.push_back(cellTransferJson(transfer));
  Json json = {{"kind", word(cell.domain, kDomains)},      {"firstSample", cell.first_sample},
               {"sampleCount", cell.sample_count},         {"boundsMin", vectorJson(cell.bounds_min)},
               {"boundsMax", vectorJson(cell.bounds_max)}, {"transfers", transfers},
               {"lightSamples", cell.light_probes}};
  if (cell.light_weights >= 0) json["lightWeights"] = cell.light_weights;
  if (cell.importance >= 0) json["importance"] = cell.importance;
  return json;
}

Json groupLightJson(const GroupLight& light) {
  Json json = {{"kind", word(light.kind, kLightKinds)},
               {light.kind == GroupLight::Kind::Material ? "material" : "node", light.index},
               {"color", vectorJson(light.color)}};
  for (const LampSphere& sphere : light.spheres)
    json["spheres"].push_back({{"center", vectorJson(sphere.center)},
                               {"radius", sphere.radius_m},
                               {"bodyRadius", sphere.body_radius_m}});
  return json;
}

Json pictureErrorJson(const PictureError& error) {
  Json json = {{"all", error.all},
               {"samples", error.samples},
               {"codes", error.codes},
               {"interpolation", error.interpolation},
               {"points", error.points}};
  if (error.bound > 0.0f) json["bound"] = error.bound;
  return json;
}

PictureError readPictureError(const Field& field) {
  const auto share = [&](const char* name) {
    const float value = field[name].number();
    if (!(value >= 0.0f)) field[name].fault("is negative");
    return value;
  };
  return {.all = share("all"),
          .samples = share("samples"),
          .codes = share("codes"),
          .interpolation = share("interpolation"),
          .points = static_cast<std::uint32_t>(field["points"].count(0xffffffffu)),
          .bound = field.has("bound") ? share("bound") : 0.0f};
}

Json groupJson(const Group& group, const glm::dvec3& origin) {
  const glm::quat& r = group.rest_rotation;
  Json json = {{"name", group.name},
               {"restTranslation", vectorJson(glm::dvec3(group.rest_translation) + origin)},
               {"restRotation", {r.x, r.y, r.z, r.w}},  // in glTF's order
               {"boundsMin", vectorJson(group.bounds_min)},
               {"boundsMax", vectorJson(group.bounds_max)},
               {"sampleCount", group.sample_count},
               {"lights", Json::array()},
               {"lightSamples", Json::array()},
               {"cells", Json::array()}};
  if (group.node >= 0) json["node"] = group.node;
  if (group.proxy >= 0) json["proxy"] = group.proxy;
  if (group.volume) json["volume"] = volumeJson(*group.volume);
  if (group.within >= 0) json["within"] = group.within;
  if (group.neighborhood) json["neighborhood"] = neighborhoodJson(*group.neighborhood);
  if (group.picture_error) json["pictureError"] = pictureErrorJson(*group.picture_error);
  for (const glm::vec3& point : group.light_probes) json["lightSamples"].push_back(vectorJson(point));
  for (const GroupLight& light : group.lights) json["lights"].push_back(groupLightJson(light));
  for (const Cell& cell : group.cells) json["cells"].push_back(cellJson(cell));
  return json;
}

Group readGroup(const Field& field, const Description& d) {
  Group group;
  group.name = field["name"].text();
  if (field.has("node")) group.node = static_cast<std::int32_t>(field["node"].index(d.nodes.size()));
  group.rest_translation = glm::vec3(field["restTranslation"].vector<glm::dvec3>() - d.origin);
  const auto r = field["restRotation"].vector<glm::vec4>();
  group.rest_rotation = glm::quat(r.w, r.x, r.y, r.z);
  if (std::abs(glm::dot(r, r) - 1.0f) > 1e-3f) field["restRotation"].fault("is not a unit quaternion");
  group.bounds_min = field["boundsMin"].vector<glm::vec3>();
  group.bounds_max = field["boundsMax"].vector<glm::vec3>();
  group.sample_count = static_cast<std::uint32_t>(field["sampleCount"].count(0xfffffffeu));
  for (const Field& entry : field["lights"].items()) group.lights.push_back(readGroupLight(entry, d));
  if (group.lights.size() > kMaxColumns) field["lights"].fault("are too many");
  group.light_probes.clear();
  for (const Field& entry : field["lightSamples"].items())
    group.light_probes.push_back(entry.vector<glm::vec3>());
  if (group.light_probes.empty()) field["lightSamples"].fault("are none");
  if (field.has("proxy"))
    group.proxy =
        static_cast<std::int32_t>(payloadIndex(field["proxy"], d, PayloadType::CaptureProxy, std::nullopt));
  std::uint32_t next = 0;
  for (const Field& entry : field["cells"].items()) {
    group.cells.push_back(readCell(entry, d, group, next));
    next += group.cells.back().sample_count;
  }
  if (next != group.sample_count) field["cells"].fault("do not hold all samples of the group");
  readGrids(field, d, group);
  if (field.has("pictureError")) group.picture_error = readPictureError(field["pictureError"]);
  // Some cell must use each light probe, or light would be captured in vain. A group without cells has one,
  // too.
  std::vector<bool> used(group.light_probes.size(), group.cells.empty());
  for (const Cell& cell : group.cells)
    for (const std::uint32_t sample : cell.light_probes) used[sample] = true;
  if (std::find(used.begin(), used.end(), false) != used.end())
    field["lightSamples"].fault("are not all taken by a cell");
  return group;
}

Draw readDraw(const Field& field, const Description& d) {
  Draw draw;
  draw.node = field["node"].index(d.nodes.size());
  const std::int32_t mesh = d.nodes[draw.node].mesh;
  if (mesh < 0) field["node"].fault("has no mesh");
  draw.mesh = static_cast<std::uint32_t>(mesh);
  draw.primitive = field["primitive"].index(d.meshes[draw.mesh].primitives.size());
  draw.group = field["group"].index(d.groups.size());
  draw.back = readWord<bool>(field["side"], kSides);
  draw.rows = payloadIndex(field["rows"], d, PayloadType::VertexWeights, {});
  draw.outputs = readOutputs(field["outputs"]);
  if (!field.has("texels")) return draw;
  if (draw.outputs != 1) field["texels"].fault("belong to a draw that is not shaded at its vertices");
  draw.texels = static_cast<std::uint32_t>(field["texels"]["side"].count(kMostTexels));
  if (draw.texels == 0) field["texels"]["side"].fault("is 0");
  draw.texel_set = field["texels"]["texcoord"].index(2);
  const DracoAttributes& attributes = d.meshes[draw.mesh].primitives[draw.primitive].attributes;
  if ((draw.texel_set == 1 ? attributes.texcoord1 : attributes.texcoord0) < 0)
    field["texels"].fault("lack their texture coordinates");
  return draw;
}

BrdfTableEntry readBrdfTable(const Field& field, const Description& d) {
  BrdfTableEntry entry;
  entry.family = readWord<BrdfFamily>(field["family"], kBrdfFamilies);
  entry.name = field["name"].text();
  entry.payload = payloadIndex(field["payload"], d, PayloadType::BrdfTable, std::nullopt);
  return entry;
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

}  // namespace

Json writeTransfer(const Description& d) {
  Json checksums = Json::array(), payloads = Json::array(), groups = Json::array(), draws = Json::array();
  for (const View& view : d.views) checksums.push_back(hexJson(view.checksum));
  for (const Payload& payload : d.payloads)
    payloads.push_back({{"type", word(payload.type, kPayloadTypes)},
                        {"codec", word(payload.codec, kCodecs)},
                        {"bufferView", payload.view},
                        {"rawLength", payload.raw_length},
                        {"priority", payload.priority}});
  for (const Group& group : d.groups) groups.push_back(groupJson(group, d.origin));
  for (const Draw& draw : d.draws) {
    draws.push_back({{"node", draw.node},
                     {"primitive", draw.primitive},
                     {"group", draw.group},
                     {"side", word(draw.back, kSides)},
                     {"rows", draw.rows},
                     {"outputs", draw.outputs}});
    if (draw.texels > 0) draws.back()["texels"] = {{"side", draw.texels}, {"texcoord", draw.texel_set}};
  }
  Json tables = Json::array();
  for (const BrdfTableEntry& entry : d.brdf_tables)
    tables.push_back(
        {{"family", word(entry.family, kBrdfFamilies)}, {"name", entry.name}, {"payload", entry.payload}});
  Json json = {{"version", d.version},
               {"generator",
                {{"program", d.generator.program},
                 {"version", d.generator.version},
                 {"isa", d.generator.isa},
                 {"settings", d.generator.settings}}},
               {"checksums", checksums},
               {"payloads", payloads},
               {"brdfTables", tables},
               {"groups", groups},
               {"draws", draws}};
  if (d.origin != glm::dvec3(0.0)) json["origin"] = vectorJson(d.origin);
  return json;
}

void readTransfer(const Field& extension, Description& d) {
  d.version = static_cast<std::uint32_t>(extension["version"].count(0xffffffffu));
  const Field generator = extension["generator"];
  d.generator.program = generator["program"].text();
  d.generator.version = generator["version"].text();
  d.generator.isa = generator["isa"].text();
  d.generator.settings = generator.settings("settings");

  const auto checksums = extension["checksums"].items();
  if (checksums.size() != d.views.size()) extension["checksums"].fault("are not one per bufferView");
  for (std::size_t i = 0; i < checksums.size(); ++i) d.views[i].checksum = checksums[i].hex64();

  for (const Field& field : extension["payloads"].items()) {
    Payload payload;
    payload.type = readWord<PayloadType>(field["type"], kPayloadTypes);
    payload.codec = readWord<PayloadCodec>(field["codec"], kCodecs);
    payload.view = field["bufferView"].index(d.views.size());
    payload.raw_length = field["rawLength"].count(kMaxPayloadBytes);
    if (payload.codec == PayloadCodec::Raw && payload.raw_length != d.views[payload.view].length)
      field["rawLength"].fault("is not the length of its bufferView");
    payload.priority = static_cast<std::uint32_t>(field["priority"].count(0xffffffffu));
    d.payloads.push_back(payload);
  }
  for (const Field& field : extension["brdfTables"].items()) d.brdf_tables.push_back(readBrdfTable(field, d));
  for (const Field& field : extension["groups"].items()) d.groups.push_back(readGroup(field, d));
  for (const Field& field : extension["draws"].items()) d.draws.push_back(readDraw(field, d));
  checkBrdfTables(extension["brdfTables"], d);
}

}  // namespace lambent::bundle
