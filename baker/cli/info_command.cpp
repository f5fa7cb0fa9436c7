// Implements lambent info BUNDLE.
#include <algorithm>
#include <map>
#include <memory>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "baker/cli/commands.hpp"
#include "baker/plan/counted.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/command_line/help.hpp"

namespace lambent::baker {

namespace {

struct InfoArguments {
  std::filesystem::path bundle;
  bool json = false;
};

// Bytes of a bundle, by the names that text and JSON have for what they hold.
struct SizeRow {
  const char *name, *key;
  std::uint64_t bytes;
  bool shown = true;  // in the text
};

std::vector<SizeRow> sizesOf(const bundle::Reader& reader) {
  using Type = bundle::PayloadType;
  const bundle::Description& d = reader.description();
  std::uint64_t meshes = 0, images = 0;
  for (const bundle::Mesh& mesh : d.meshes)
    for (const bundle::Primitive& primitive : mesh.primitives) meshes += d.views[primitive.view].length;
  for (const bundle::Image& image : d.images) images += d.views[image.view].length;
  std::map<Type, std::uint64_t> of;
  for (const bundle::Payload& payload : d.payloads) of[payload.type] += d.views[payload.view].length;
  const std::uint64_t densities = of[Type::Density] + of[Type::Voxels];
  return {{"meshes", "meshBytes", meshes},
          {"images", "imageBytes", images},
          {"vertex rows", "rowBytes", of[Type::VertexWeights]},
          {"codebooks", "codebookBytes", of[Type::Codebook]},
          {"cluster ids", "clusterIdBytes", of[Type::ClusterIds]},
          {"weight planes", "planeBytes", of[Type::WeightPlane]},
          {"light weights", "lightWeightBytes", of[Type::LightWeights]},
          {"proxies", "proxyBytes", of[Type::CaptureProxy]},
          {"BRDF tables", "brdfTableBytes", of[Type::BrdfTable], !d.brdf_tables.empty()},
          {"densities", "densityBytes", densities, densities > 0},
          {"importance", "importanceBytes", of[Type::Importance]},
          {"whole file", "fileBytes", reader.fileBytes()}};
}

struct Counts {
  std::uint64_t vertices = 0, triangles = 0, texels = 0;
};

Counts countsOf(const bundle::Description& d) {
  Counts counts;
  for (const bundle::Draw& draw : d.draws) {
    const bundle::Primitive& primitive = d.meshes[draw.mesh].primitives[draw.primitive];
    counts.vertices += primitive.vertex_count;
    counts.triangles += primitive.index_count / 3;
    counts.texels += draw.texels * draw.texels;
  }
  return counts;
}

// Returns the triangles of each level, finest first; empty if the group has no proxy.
std::vector<std::uint32_t> proxyTriangles(const bundle::Reader& reader, const bundle::Group& group) {
  const bundle::GroupIndex index{static_cast<std::uint32_t>(&group - reader.description().groups.data())};
  std::vector<std::uint32_t> counts;
  if (const auto proxy = reader.readProxy(index))  // checked before anything is printed
    for (const bundle::ProxyLevel& level : proxy->levels) counts.push_back(level.triangle_count);
  return counts;
}

const char* effectName(const bundle::Cell& cell, const bundle::CellTransfer& transfer) {
  if (cell.domain == transfer::Domain::Voxel) return "volume";
  if (cell.domain == transfer::Domain::GridPoint) return "neighborhood";
  return transfer.shape.beyondDiffuse() ? "glossy" : "diffuse";
}

// Returns null if there is none.
nlohmann::json neighborhoodJson(const bundle::Group& group) {
  if (!group.neighborhood) return nullptr;
  const auto& [size, low, high] = *group.neighborhood;
  return {{"size", {size.x, size.y, size.z}},
          {"boundsMin", {low.x, low.y, low.z}},
          {"boundsMax", {high.x, high.y, high.z}}};
}

const char* partName(const transfer::TransferShape& shape) {
  if (shape.isVisibility()) return "visibility";
  if (shape.shadowed_channels == 0) return "bounced";
  return shape.full_channels > 0 ? "shadowed and full" : "shadowed";
}

void printBundleJson(const bundle::Reader& reader) {
  const bundle::Description& d = reader.description();
  const Counts counts = countsOf(d);
  nlohmann::json groups = nlohmann::json::array();
  for (const bundle::Group& group : d.groups) {
    nlohmann::json cells = nlohmann::json::array();
    for (const bundle::Cell& cell : group.cells)
      for (const bundle::CellTransfer& transfer : cell.transfers)
        cells.push_back({{"samples", cell.sample_count},
                         {"effect", effectName(cell, transfer)},
                         {"light", transfer.fromEnvironment() ? "environment" : "lamps"},
                         {"outputs", transfer.shape.outputs},
                         {"visibilityBands", transfer.shape.visibility_bands},
                         {"order", transfer.shape.order},
                         {"lightColumns", transfer.shape.light_columns},
                         {"shadowedChannels", transfer.shape.shadowed_channels},
                         {"fullChannels", transfer.shape.full_channels},
                         {"normalMapped", transfer.shape.outputs == transfer::kMappedOutputs},
                         {"clusters", transfer.clusters},
                         {"planes", transfer.planes.size()},
                         {"errorBound", transfer.error_bound},
                         {"error", transfer.error}});
    groups.push_back({{"name", group.name},
                      {"samples", group.sample_count},
                      {"lightSamples", group.light_probes.size()},
                      {"proxyTriangles", proxyTriangles(reader, group)},
                      {"neighborhood", neighborhoodJson(group)},
                      {"pictureError", pictureErrorJson(group.picture_error)},
                      {"transfer", cells}});
  }
  nlohmann::json json = {
      {"file", reader.path().string()},
      {"formatVersion", d.version},
      {"generator",
       {{"program", d.generator.program}, {"version", d.generator.version}, {"isa", d.generator.isa}}},
      {"settings", d.generator.settings},
      {"origin", {d.origin.x, d.origin.y, d.origin.z}},
      {"draws", d.draws.size()},
      {"vertices", counts.vertices},
      {"triangles", counts.triangles},
      {"texels", counts.texels},
      {"groups", groups}};
  for (const SizeRow& row : sizesOf(reader)) json[row.key] = row.bytes;
  fmt::print("{}\n", json.dump(2));
}

void printBundle(const bundle::Reader& reader) {
  const bundle::Description& d = reader.description();
  const Counts counts = countsOf(d);
  fmt::print("{}: format {}, {} {} ({})\n", reader.path().string(), d.version, d.generator.program,
             d.generator.version, d.generator.isa);
  for (const auto& [name, value] : d.generator.settings) fmt::print("  {:<13} {}\n", name, value);
  if (d.origin != glm::dvec3(0.0))
    fmt::print("  {:<13} {}, {}, {} m\n", "origin", d.origin.x, d.origin.y, d.origin.z);
  fmt::print("{}, {} vertices, {} triangles\n", counted(d.draws.size(), "draw"), counts.vertices,
             counts.triangles);
  if (counts.texels > 0) fmt::print("{} texels of E/pi\n", counts.texels);
  const double vertices = static_cast<double>(std::max<std::uint64_t>(counts.vertices, 1));
  for (const SizeRow& row : sizesOf(reader)) {
    const auto bytes = static_cast<double>(row.bytes);
    if (row.shown)
      fmt::print("  {:<13} {:>10}  {:6.2f} bytes a vertex\n", row.name, bytesText(bytes), bytes / vertices);
  }
  std::size_t missed = 0;
  for (const bundle::Group& group : d.groups) {
    fmt::print("group \"{}\": {} in {}\n", group.name, counted(group.sample_count, "sample"),
               counted(group.cells.size(), "cell"));
    const std::vector<std::uint32_t> proxy = proxyTriangles(reader, group);
    fmt::print("  {}, {}\n", counted(group.light_probes.size(), "light probe"),
               proxy.empty() ? "no proxy" : fmt::format("proxy of {} triangles", fmt::join(proxy, ", ")));
    if (const auto& error = group.picture_error) {
      fmt::print("  surfaces are {}\n", pictureErrorText(*error));
      missed += error->bound > 0.0f && bundle::missesBound(error->all, error->bound);
    }
    if (const auto& around = group.neighborhood)
      fmt::print(
          "  neighborhood of {} x {} x {} points, ({:.2f}, {:.2f}, {:.2f}) to ({:.2f}, {:.2f}, {:.2f})\n",
          around->size.x, around->size.y, around->size.z, around->bounds_min.x, around->bounds_min.y,
          around->bounds_min.z, around->bounds_max.x, around->bounds_max.y, around->bounds_max.z);
    if (group.volume)
      fmt::print(
          "  volume of {} x {} x {} voxels in {} bits, extinction of at most {:.4g} 1/m; transfer on {} x {} "
          "x {}\n",
          group.volume->size.x, group.volume->size.y, group.volume->size.z, group.volume->bits,
          double{group.volume->density_max}, group.volume->transfer_size.x, group.volume->transfer_size.y,
          group.volume->transfer_size.z);
    for (const bundle::Cell& cell : group.cells)
      for (const bundle::CellTransfer& transfer : cell.transfers) {
        fmt::print("  {} {}: {}, {}, {}, {}, error {} (bound {})\n", effectName(cell, transfer),
                   transfer.fromEnvironment() ? fmt::format("order {}", transfer.shape.order)
                                              : counted(transfer.shape.light_columns, "lamp"),
                   partName(transfer.shape), counted(cell.sample_count, "sample"),
                   counted(transfer.clusters, "cluster"), counted(transfer.planes.size(), "plane"),
                   percentText(double{transfer.error}, 3), percentText(double{transfer.error_bound}, 3));
      }
  }
  if (missed > 0)
    fmt::print("missed: pictures of {} err by more than their bound\n", counted(missed, "group"));
}

int runInfo(const InfoArguments& a) {
  const auto reader = bundle::Reader::open(a.bundle);
  if (!reader) return reportError(reader.error());
  if (const auto checked = reader->checkAll(); !checked) return reportError(checked.error());
  (a.json ? printBundleJson : printBundle)(*reader);
  return 0;
}

}  // namespace

void addInfoCommand(CLI::App& app, Command& run) {
  auto a = std::make_shared<InfoArguments>();
  CLI::App* command =
      app.add_subcommand("info", "Check a bundle and say what is in it: sizes, orders, errors");
  command->add_option("BUNDLE", a->bundle, "The bundle, .lmb.glb")->required();
  command->add_flag("--json", a->json, "Print as JSON");
  command_line::addExamples(
      *command, {{"lambent info scene.lmb.glb", "checks the bundle and lists sizes, orders and errors"}});
  command->callback([a, &run] { run = [a] { return runInfo(*a); }; });
}

}  // namespace lambent::baker
