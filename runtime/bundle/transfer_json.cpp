// The extension LAMBENT_radiance_transfer: what was baked and where it lies.
#include <algorithm>
#include <array>

#include "runtime/bundle/description.hpp"
#include "runtime/bundle/json_fields.hpp"

namespace lambent::bundle {

namespace {

constexpr std::uint32_t kMaxOrder = 8, kMaxColumns = 4096, kMaxCellSamples = 65536;
constexpr std::uint64_t kMaxPayloadBytes = std::uint64_t{1} << 32;  // refuse to allocate more for one payload
constexpr std::array kPayloadTypes = {"vertexRows", "transferBasis", "weightPlane"};
constexpr std::array kCodecs = {"raw", "zstd"};
constexpr std::array kParts = {"direct"};
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

Json diffuseJson(const DiffuseTransfer& transfer) {
  Json planes = Json::array();
  for (const WeightPlane& plane : transfer.planes)
    planes.push_back({{"payload", plane.payload},
                      {"bits", plane.bits},
                      {"offset", plane.offset},
                      {"scale", plane.scale},
                      {"variance", plane.variance}});
  return {{"part", word(transfer.part, kParts)},
          {"order", transfer.order},
          {"lightColumns", transfer.light_columns},
          {"channels", transfer.channels},
          {"basis", transfer.basis},
          {"planes", planes},
          {"errorBound", transfer.error_bound},
          {"error", transfer.error}};
}

// A payload of the type wanted, of the size wanted.
std::uint32_t payloadIndex(const Field& field, const Description& d, PayloadType type,
                           std::uint64_t raw_length) {
  const std::uint32_t index = field.index(d.payloads.size());
  if (d.payloads[index].type != type) field.fault("is a payload of another type");
  if (raw_length != 0 && d.payloads[index].raw_length != raw_length)
    field.fault("is a payload of another size");
  return index;
}

DiffuseTransfer readDiffuse(const Field& field, const Description& d, std::uint32_t sample_count) {
  DiffuseTransfer transfer;
  transfer.part = readWord<TransferPart>(field["part"], kParts);
  transfer.order = static_cast<std::uint32_t>(field["order"].count(kMaxOrder));
  if (transfer.order == 0) field["order"].fault("is 0");
  transfer.light_columns = static_cast<std::uint32_t>(field["lightColumns"].count(kMaxColumns));
  transfer.channels = static_cast<std::uint32_t>(field["channels"].count(3));
  if (transfer.channels != 1 && transfer.channels != 3) field["channels"].fault("is neither 1 nor 3");
  const auto planes = field["planes"].items();
  const std::uint64_t vector_values = std::uint64_t{transfer.channels} * transfer.columns();
  if (planes.size() > vector_values) field["planes"].fault("are more than the vector has values");
  transfer.basis =
      payloadIndex(field["basis"], d, PayloadType::TransferBasis, (1 + planes.size()) * vector_values * 2);
  for (const Field& entry : planes) {
    WeightPlane plane;
    plane.bits = static_cast<std::uint32_t>(entry["bits"].count(16));
    if (plane.bits != 8 && plane.bits != 16) entry["bits"].fault("is neither 8 nor 16");
    plane.payload = payloadIndex(entry["payload"], d, PayloadType::WeightPlane,
                                 std::uint64_t{sample_count} * plane.bits / 8);
    plane.offset = entry["offset"].number();
    plane.scale = entry["scale"].number();
    plane.variance = entry["variance"].number();
    transfer.planes.push_back(plane);
  }
  transfer.error_bound = field["errorBound"].number();
  transfer.error = field["error"].number();
  return transfer;
}

Json cellJson(const Cell& cell) {
  Json diffuse = Json::array();
  for (const DiffuseTransfer& transfer : cell.diffuse) diffuse.push_back(diffuseJson(transfer));
  return {{"firstSample", cell.first_sample},
          {"sampleCount", cell.sample_count},
          {"boundsMin", vectorJson(cell.bounds_min)},
          {"boundsMax", vectorJson(cell.bounds_max)},
          {"diffuse", diffuse}};
}

Json groupJson(const Group& group) {
  const glm::quat& r = group.rest_rotation;
  Json json = {{"name", group.name},
               {"restTranslation", vectorJson(group.rest_translation)},
               {"restRotation", {r.x, r.y, r.z, r.w}},  // glTF's order
               {"boundsMin", vectorJson(group.bounds_min)},
               {"boundsMax", vectorJson(group.bounds_max)},
               {"sampleCount", group.sample_count},
               {"cells", Json::array()}};
  if (group.node >= 0) json["node"] = group.node;
  for (const Cell& cell : group.cells) json["cells"].push_back(cellJson(cell));
  return json;
}

Group readGroup(const Field& field, const Description& d) {
  Group group;
  group.name = field["name"].text();
  if (field.has("node")) group.node = static_cast<std::int32_t>(field["node"].index(d.nodes.size()));
  group.rest_translation = field["restTranslation"].vector<glm::vec3>();
  const auto r = field["restRotation"].vector<glm::vec4>();
  group.rest_rotation = glm::quat(r.w, r.x, r.y, r.z);
  if (std::abs(glm::dot(r, r) - 1.0f) > 1e-3f) field["restRotation"].fault("is not a unit quaternion");
  group.bounds_min = field["boundsMin"].vector<glm::vec3>();
  group.bounds_max = field["boundsMax"].vector<glm::vec3>();
  group.sample_count = static_cast<std::uint32_t>(field["sampleCount"].count(0xfffffffeu));
  std::uint32_t next = 0;
  for (const Field& entry : field["cells"].items()) {
    Cell cell;
    cell.first_sample = static_cast<std::uint32_t>(entry["firstSample"].count(group.sample_count));
    if (cell.first_sample != next) entry["firstSample"].fault("leaves a gap between cells");
    cell.sample_count = static_cast<std::uint32_t>(
        entry["sampleCount"].count(std::min(kMaxCellSamples, group.sample_count - cell.first_sample)));
    cell.bounds_min = entry["boundsMin"].vector<glm::vec3>();
    cell.bounds_max = entry["boundsMax"].vector<glm::vec3>();
    for (const Field& transfer : entry["diffuse"].items())
      cell.diffuse.push_back(readDiffuse(transfer, d, cell.sample_count));
    next += cell.sample_count;
    group.cells.push_back(std::move(cell));
  }
  if (next != group.sample_count) field["cells"].fault("do not hold all samples of the group");
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
  draw.rows = payloadIndex(field["rows"], d, PayloadType::VertexRows, 0);
  return draw;
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
  for (const Group& group : d.groups) groups.push_back(groupJson(group));
  for (const Draw& draw : d.draws)
    draws.push_back({{"node", draw.node},
                     {"primitive", draw.primitive},
                     {"group", draw.group},
                     {"side", word(draw.back, kSides)},
                     {"rows", draw.rows}});
  return {{"version", d.version},
          {"generator",
           {{"program", d.generator.program},
            {"version", d.generator.version},
            {"isa", d.generator.isa},
            {"settings", d.generator.settings}}},
          {"checksums", checksums},
          {"payloads", payloads},
          {"groups", groups},
          {"draws", draws}};
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
  for (const Field& field : extension["groups"].items()) d.groups.push_back(readGroup(field, d));
  for (const Field& field : extension["draws"].items()) d.draws.push_back(readDraw(field, d));
}

}  // namespace lambent::bundle
