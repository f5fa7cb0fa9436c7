#include "baker/import/buffer_source.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <meshoptimizer.h>
#include <nlohmann/json.hpp>

#include "baker/import/check.hpp"
#include "baker/import/error_text.hpp"
#include "baker/import/scene_files.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

namespace {

// Decodes EXT_meshopt_compression: bufferViews coded by meshoptimizer (with the codecs and filters of the
// glTF extension, which gltfpack writes). The bytes are checked before use and decoded into the buffer that
// the view names, so accessors read them like any others.

// The most decoded bytes per coded byte: vertex blocks of equal bytes take 2 bits for 16 bytes, triangles one
// byte for 12. A file that claims more is refused before memory is taken.
inline constexpr std::size_t kMeshoptLargestRatio = 256;

// Decodes one view by its checked extension object. `view` has its count * stride bytes. Errors name
// `subject` and `object`: the bytes are damaged.
Result<void> decodeMeshopt(const nlohmann::json& extension, std::span<const std::byte> coded,
                           std::span<std::byte> view, const std::string& subject, const std::string& object) {
  const auto count = extension["count"].get<std::size_t>(),
             stride = extension["byteStride"].get<std::size_t>();
  const std::string mode = extension["mode"].get<std::string>(), filter = extension.value("filter", "NONE");
  const auto* bytes = reinterpret_cast<const unsigned char*>(coded.data());
  int failed = 0;
  if (mode == "ATTRIBUTES")
    failed = meshopt_decodeVertexBuffer(view.data(), count, stride, bytes, coded.size());
  else if (mode == "TRIANGLES")
    failed = meshopt_decodeIndexBuffer(view.data(), count, stride, bytes, coded.size());
  else
    failed = meshopt_decodeIndexSequence(view.data(), count, stride, bytes, coded.size());
  if (failed != 0)
    return fail(subject,
                fmt::format("{}: its {} bytes are not {} coded by meshoptimizer", object, coded.size(), mode),
                kExportAgain);
  if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(view.data(), count, stride);
  if (filter == "QUATERNION") meshopt_decodeFilterQuat(view.data(), count, stride);
  if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(view.data(), count, stride);
  return {};
}

using nlohmann::json;

// Returns how many bytes are covered by views, counting shared bytes once.
std::size_t bytesCovered(std::vector<std::pair<std::size_t, std::size_t>> ranges) {
  std::sort(ranges.begin(), ranges.end());
  std::size_t covered = 0, end = 0;
  for (const auto& [first, last] : ranges) {
    if (last <= end) continue;
    covered += last - std::max(first, end);
    end = last;
  }
  return covered;
}

}  // namespace

BufferSource::BufferSource(json& document, std::vector<std::byte> binary, const std::filesystem::path& path,
                           const ImportOptions& options, std::vector<std::string>& warnings)
    : binary_(std::move(binary)), path_(path), options_(options), warnings_(warnings) {
  if (!document.contains("buffers")) return;
  for (json& buffer : document["buffers"]) {
    // tinygltf refuses an empty buffer, of which nothing is read.
    if (buffer["byteLength"] == 0) buffer.update({{"byteLength", 1u}, {"uri", "data:,0"}});
    wanted_.push_back({buffer.value("uri", std::string()), buffer["byteLength"].get<std::size_t>(), {}});
    buffer["uri"] = std::to_string(wanted_.size() - 1);
  }
  // Views that meshoptimizer coded belong to a buffer without bytes of its own; buffers that have bytes keep
  // them.
  if (!document.contains("bufferViews")) return;
  for (std::size_t v = 0; v < document["bufferViews"].size(); ++v) {
    const json& view = document["bufferViews"][v];
    Wanted& buffer = wanted_[view["buffer"].get<std::size_t>()];
    if (!buffer.uri.empty() || !view.contains("extensions") || !view["extensions"].contains(kMeshopt))
      continue;
    const json& extension = view["extensions"][kMeshopt];
    buffer.coded.push_back(
        {v, view.value("byteOffset", std::size_t{0}), view["byteLength"].get<std::size_t>(), extension});
    sources_.insert(extension["buffer"].get<std::size_t>());
  }
}

Result<std::vector<std::byte>> BufferSource::read(std::size_t i) {
  if (i >= wanted_.size())
    return fail(path_.string(), fmt::format("buffer {} does not exist", i), kExportAgain);
  auto bytes = wanted_[i].coded.empty() ? load(i) : decode(wanted_[i]);
  if (bytes) bytes->resize(wanted_[i].length);
  return bytes;
}

// Makes a buffer from its views that meshoptimizer coded.
Result<std::vector<std::byte>> BufferSource::decode(const Wanted& buffer) {
  std::map<std::size_t, std::vector<std::pair<std::size_t, std::size_t>>> ranges;  // by source buffer
  for (const CodedView& view : buffer.coded) {
    const auto first = view.extension.value("byteOffset", std::size_t{0});
    ranges[view.extension["buffer"].get<std::size_t>()].emplace_back(
        first, first + view.extension["byteLength"].get<std::size_t>());
  }
  std::size_t coded_bytes = 0;
  for (const auto& [source, list] : ranges) coded_bytes += bytesCovered(list);
  if (buffer.length / kMeshoptLargestRatio > coded_bytes)
    return fail(path_.string(), fmt::format("claims {} bytes coded in {}", buffer.length, coded_bytes),
                kExportAgain);
  std::vector<std::byte> bytes(buffer.length);
  for (const CodedView& view : buffer.coded) {
    const auto source = view.extension["buffer"].get<std::size_t>();
    if (!kept_.contains(source))
      if (auto loaded = load(source); !loaded) return loaded;
    const auto coded = std::span<const std::byte>(kept_.at(source))
                           .subspan(view.extension.value("byteOffset", std::size_t{0}),
                                    view.extension["byteLength"].get<std::size_t>());
    const auto decoded =
        decodeMeshopt(view.extension, coded, std::span(bytes).subspan(view.offset, view.length),
                      path_.string(), fmt::format("bufferView {}", view.index));
    if (!decoded) return failAgain(decoded.error());
  }
  return bytes;
}

Result<std::vector<std::byte>> BufferSource::load(std::size_t i) {
  if (const auto kept = kept_.find(i); kept != kept_.end()) return kept->second;
  const std::string& uri = wanted_[i].uri;
  const std::size_t length = wanted_[i].length;
  const std::string object = fmt::format("buffer {}", i);
  std::vector<std::byte> bytes;
  if (uri.empty()) {
    if (i != 0 || binary_.empty())
      return fail(path_.string(), object + " has neither a URI nor a binary chunk", kExportAgain);
    bytes = std::exchange(binary_, {});
  } else {
    auto read = readUri(path_, uri, options_, object, warnings_);
    if (!read) return read;
    bytes = std::move(*read);
  }
  if (bytes.size() < length)
    return fail(path_.string(), fmt::format("{} has {} bytes of {}", object, bytes.size(), length),
                "the file is truncated; copy or export it again");
  if (sources_.contains(i)) kept_[i] = bytes;
  return bytes;
}

}  // namespace lambent::baker
