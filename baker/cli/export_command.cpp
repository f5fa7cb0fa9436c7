// Implements lambent export BUNDLE -o DIR: the numbers of a bundle as arrays that NumPy reads, and a JSON
// that says what they are (docs/python.md).
#include <array>
#include <bit>
#include <cassert>
#include <functional>
#include <memory>
#include <numeric>
#include <span>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/cli/commands.hpp"
#include "lambent/bundle.hpp"
#include "lambent/sh.hpp"
#include "runtime/base/atomic_file.hpp"
#include "runtime/command_line/help.hpp"

namespace lambent::baker {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct ExportArguments {
  fs::path bundle, folder;
  std::vector<std::string> light;
  int order = kMaxBands;
  bool json = false;
  SayOptions say;
};

Error errorOf(const Failure& failure) {
  return {failure.subject, failure.problem, failure.hint};
}

std::array<float, 3> numbers(const Vec3& v) {
  return {v.x, v.y, v.z};
}

using ArrayShape = std::vector<std::size_t>;  // its product is the number of values

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

// Writes a .npy file of version 1.0, which NumPy and most tools for numbers read: little-endian, in the order
// of C.
template <class Value>
Result<void> writeNpy(const fs::path& path, const ArrayShape& shape, const std::vector<Value>& values) {
  static_assert(std::is_same_v<Value, float> || std::is_same_v<Value, std::uint32_t>);
  assert(std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>()) == values.size());
  constexpr const char* type = std::is_same_v<Value, float> ? "<f4" : "<u4";
  std::string sides;
  for (const std::size_t side : shape) sides += fmt::format("{}, ", side);
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", type, sides);
  // The magic word, the version and the length of the header come before it; together they fill blocks of 64.
  constexpr std::size_t kBefore = 10, kBlock = 64;
  header.append((kBlock - (kBefore + header.size() + 1) % kBlock) % kBlock, ' ');
  header += '\n';
  std::string text = "\x93NUMPY";
  text += {'\1', '\0', static_cast<char>(header.size() & 0xff), static_cast<char>(header.size() >> 8)};
  text += header;
  text.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
  return writeFile(path, std::as_bytes(std::span(text)));
}

// Writes arrays into the folder, and keeps the first error.
class ArrayWriter {
 public:
  explicit ArrayWriter(fs::path folder) : folder_(std::move(folder)) {}

  // Returns the name under which the JSON refers to the array.
  template <class Value>
  std::string write(const std::string& name, const ArrayShape& shape, const std::vector<Value>& values) {
    if (done_) done_ = writeNpy(folder_ / (name + ".npy"), shape, values);
    ++arrays_;
    return name + ".npy";
  }
  std::string write(const std::string& name, const std::vector<Vec3>& values) {
    std::vector<float> flat;
    for (const Vec3& v : values) flat.insert(flat.end(), {v.x, v.y, v.z});
    return write(name, {values.size(), 3}, flat);
  }
  void fail(const Failure& failure) {
    if (done_) done_ = failAgain(errorOf(failure));
  }
  const Result<void>& done() const { return done_; }
  int arrays() const { return arrays_; }

 private:
  fs::path folder_;
  Result<void> done_;
  int arrays_ = 0;
};

json describe(const TransferBlock& block) {
  return {{"form", nameOf(block.form)},
          {"place", nameOf(block.place)},
          {"firstSample", block.first_sample},
          {"samples", block.samples},
          {"order", block.order},
          {"lamps", block.lamps},
          {"shadowedChannels", block.shadowed_channels},
          {"fullChannels", block.full_channels},
          {"outputs", block.outputs},
          {"columns", block.columns}};
}

json exportGroup(const Bundle& bundle, std::uint32_t index, ArrayWriter& arrays) {
  const GroupInfo& group = bundle.groups()[index];
  const std::string prefix = fmt::format("group{}", index);
  json described = {{"name", group.name},
                    {"samples", group.samples},
                    {"worldFromGroup", group.world_from_group},
                    {"boundsMin", numbers(group.bounds_min)},
                    {"boundsMax", numbers(group.bounds_max)},
                    {"lamps", group.lamps},
                    {"transfer", json::array()}};
  for (std::uint32_t b = 0; b < group.blocks.size() && arrays.done(); ++b) {
    const TransferBlock& block = group.blocks[b];
    const Expected<std::vector<float>> values = bundle.transfer(index, b);
    if (!values) {
      arrays.fail(values.failure());
      break;
    }
    json one = describe(block);
    one["values"] = arrays.write(fmt::format("{}.transfer{}", prefix, b),
                                 {block.samples, block.channels(), block.outputs, block.columns}, *values);
    described["transfer"].push_back(std::move(one));
  }
  return described;
}

json exportSurface(const SurfaceInfo& info, std::uint32_t index, const SurfaceData& data,
                   ArrayWriter& arrays) {
  const std::string prefix = fmt::format("surface{}", index);
  return {{"mesh", info.mesh},
          {"material", info.material},
          {"group", info.group},
          {"back", info.back},
          {"form", nameOf(info.form)},
          {"albedo", numbers(info.albedo)},
          {"positions", arrays.write(prefix + ".positions", data.positions)},
          {"normals", arrays.write(prefix + ".normals", data.normals)},
          {"triangles", arrays.write(prefix + ".triangles", {data.indices.size() / 3, 3}, data.indices)},
          {"rowOffsets", arrays.write(prefix + ".row_offsets", {data.offsets.size()}, data.offsets)},
          {"rowSamples", arrays.write(prefix + ".row_samples", {data.samples.size()}, data.samples)},
          {"rowWeights", arrays.write(prefix + ".row_weights", {data.weights.size()}, data.weights)}};
}

Result<void> exportBundle(const ExportArguments& a) {
  const Expected<Bundle> bundle = Bundle::open(a.bundle.string());
  if (!bundle) return failAgain(errorOf(bundle.failure()));
  std::error_code failed;
  fs::create_directories(a.folder, failed);
  if (failed)
    return fail(a.folder.string(), "cannot be made (" + failed.message() + ")", "name another folder");
  ArrayWriter arrays(a.folder);
  json described = {{"bundle", a.bundle.filename().string()},
                    {"program", std::string("lambent ") + LAMBENT_VERSION},
                    {"groups", json::array()},
                    {"surfaces", json::array()}};
  if (!a.light.empty()) {
    const Expected<LightVector> light = lightFrom(a.light, a.order);
    if (!light) return failAgain(errorOf(light.failure()));
    described["light"] = {
        {"words", a.light}, {"order", a.order}, {"coefficients", arrays.write("light", light->coefficients)}};
  }
  const std::vector<SurfaceInfo>& surfaces = bundle->surfaces();
  for (std::uint32_t s = 0; s < surfaces.size() && arrays.done(); ++s) {
    const Expected<SurfaceData> data = bundle->surface(s);
    if (!data) return failAgain(errorOf(data.failure()));
    described["surfaces"].push_back(exportSurface(surfaces[s], s, *data, arrays));
  }
  for (std::uint32_t g = 0; g < bundle->groups().size() && arrays.done(); ++g)
    described["groups"].push_back(exportGroup(*bundle, g, arrays));
  if (!arrays.done()) return arrays.done();
  // The description comes last, so that a folder that has one is whole.
  const std::string text = described.dump(2) + "\n";
  if (Result<void> done = writeFile(a.folder / "bundle.json", std::as_bytes(std::span(text))); !done)
    return done;
  if (a.json)
    fmt::print("{}\n", described.dump(2));
  else if (!a.say.quiet)
    fmt::print("{}: {} arrays of {} groups and {} surfaces; bundle.json says what they are\n",
               a.folder.string(), arrays.arrays(), bundle->groups().size(), surfaces.size());
  return {};
}

}  // namespace

void addExportCommand(CLI::App& app, Command& run) {
  auto a = std::make_shared<ExportArguments>();
  CLI::App* command = app.add_subcommand("export", "Write the numbers of a bundle as arrays for NumPy");
  command->add_option("BUNDLE", a->bundle, "The bundle, .lmb.glb")->required();
  command_line::addValue(*command, "-o,--output", a->folder, "DIR",
                         "The folder to write arrays (.npy) and bundle.json into")
      ->required();
  command_line::addValue(*command, "--light", a->light, "LIGHT",
                         "Also write the light vector of a light at infinity; several add up "
                         "(docs/conventions.md)");
  command->add_option("--order", a->order, "Bands of the light vector, 1..8")
      ->check(CLI::Range(1, kMaxBands))
      ->capture_default_str();
  command->add_flag("--json", a->json, "Print bundle.json");
  addQuiet(*command, a->say);
  command_line::group(*command, "Light", {"--light", "--order"});
  command_line::group(*command, "Output", {"--output", "--json", "--quiet"});
  command_line::addExamples(
      *command, {{"lambent export scene.lmb.glb -o arrays", "writes arrays/*.npy and arrays/bundle.json"}});
  command->callback([a, &run] {
    run = [a] {
      const Result<void> done = exportBundle(*a);
      return done ? 0 : reportError(done.error());
    };
  });
}

}  // namespace lambent::baker
