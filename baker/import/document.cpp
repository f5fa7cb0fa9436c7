#include "baker/import/document.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <meshoptimizer.h>

#include "baker/import/check.hpp"
#include "baker/import/scene_files.hpp"

namespace lambent::baker {
namespace {

using nlohmann::json;

// Mends walk the document recursively, so the depth must be limited.
constexpr int kMaxDepth = 64;

json parseJson(const std::string& text, std::vector<std::string>& warnings) {
  bool too_deep = false;
  const auto shallow = [&](int depth, json::parse_event_t, json&) {
    too_deep = too_deep || depth > kMaxDepth;
    return !too_deep;
  };
  json document;
  try {
    document = json::parse(text, shallow);
  } catch (const json::exception& exception) {
    // Some exporters write names in Latin-1.
    std::string utf8;
    for (const char c : text)
      if (const auto byte = static_cast<unsigned char>(c); byte < 0x80)
        utf8 += c;
      else
        utf8 += {static_cast<char>(0xc0 | (byte >> 6)), static_cast<char>(0x80 | (byte & 0x3f))};
    if (utf8 != text) document = json::parse(utf8, shallow, /*allow_exceptions=*/false);
    if (utf8 == text || document.is_discarded())
      refuse("is not glTF: its JSON cannot be parsed ({})", reasonOf(exception));
    warnings.emplace_back("its JSON is not UTF-8 and is read as Latin-1");
  }
  if (too_deep)
    throw Error{{}, fmt::format("nests JSON deeper than {} levels", kMaxDepth), "simplify its extras"};
  return document;
}

// Decodes EXT_meshopt_compression: bufferViews coded by meshoptimizer (with the codecs and filters of the
// glTF extension, which gltfpack writes). The bytes are checked before use and decoded into the buffer that
// the view names, so accessors read them like any others.

// The most decoded bytes per coded byte: vertex blocks of equal bytes take 2 bits for 16 bytes, triangles one
// byte for 12. A file that claims more is refused before memory is taken.
constexpr std::size_t kMeshoptLargestRatio = 256;

// Decodes one view by its checked extension object. `view` has its count * stride bytes. Errors name its
// number: the bytes are damaged.
void decodeMeshopt(const nlohmann::json& extension, std::span<const std::byte> coded,
                   std::span<std::byte> view, std::size_t number) {
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
    refuse("bufferView {}: its {} bytes are not {} coded by meshoptimizer", number, coded.size(), mode);
  if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(view.data(), count, stride);
  if (filter == "QUATERNION") meshopt_decodeFilterQuat(view.data(), count, stride);
  if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(view.data(), count, stride);
}

// Loads the buffers of a checked document, with as many bytes as each announces: from files beside it, data:
// URIs and the binary chunk. A buffer without bytes of its own is made of its views that meshoptimizer coded;
// buffers that have bytes keep them.
void loadBuffers(Document& document, std::vector<std::byte> binary) {
  std::vector<bool> bare;  // by buffer
  for (const json& buffer : document.list("buffers")) {
    const std::size_t i = bare.size(), length = buffer.at("byteLength").get<std::size_t>();
    const std::string object = fmt::format("buffer {}", i), uri = buffer.value("uri", "");
    bare.push_back(uri.empty() && (i != 0 || binary.empty()));
    std::vector<std::byte>& bytes = document.buffers.emplace_back();
    if (length == 0 || bare.back()) continue;
    bytes = uri.empty() ? std::exchange(binary, {})
                        : readUri(document.path, uri, document.options, object, document.warnings);
    if (bytes.size() < length)
      throw Error{{},
                  fmt::format("{} has {} bytes of {}", object, bytes.size(), length),
                  "the file is truncated; copy or export it again"};
    bytes.resize(length);
  }
  const auto forEachCoded = [&](auto visit) {  // visit(view, extension, buffer)
    for (std::size_t v = 0; v < document.list("bufferViews").size(); ++v) {
      const json& extension = memberOf(document.at("bufferViews", v), {"extensions", kMeshopt});
      const auto buffer = document.at("bufferViews", v).at("buffer").get<std::size_t>();
      if (!extension.is_null() && bare[buffer]) visit(v, extension, buffer);
    }
  };
  std::map<std::size_t, std::set<std::size_t>> sources;  // by bare buffer
  forEachCoded([&](std::size_t, const json& extension, std::size_t buffer) {
    sources[buffer].insert(extension.at("buffer").get<std::size_t>());
  });
  for (std::size_t i = 0; i < bare.size(); ++i) {
    const auto length = document.at("buffers", i).at("byteLength").get<std::size_t>();
    if (!bare[i] || length == 0) continue;
    std::size_t coded_bytes = 0;
    for (const std::size_t source : sources[i])
      coded_bytes += bare[source] ? 0 : document.buffers[source].size();
    if (coded_bytes == 0) refuse("buffer {} has neither a URI nor a binary chunk", i);
    if (length / kMeshoptLargestRatio > coded_bytes)
      refuse("claims {} bytes coded in {}", length, coded_bytes);
    document.buffers[i].resize(length);
  }
  forEachCoded([&](std::size_t v, const json& extension, std::size_t buffer) {
    const auto source = extension.at("buffer").get<std::size_t>();
    if (bare[source]) refuse("buffer {} has neither a URI nor a binary chunk", source);
    const auto coded = std::span<const std::byte>(document.buffers[source])
                           .subspan(extension.value("byteOffset", std::size_t{0}),
                                    extension.at("byteLength").get<std::size_t>());
    const json& view = document.at("bufferViews", v);
    const auto decoded =
        std::span(document.buffers[buffer])
            .subspan(view.value("byteOffset", std::size_t{0}), view.at("byteLength").get<std::size_t>());
    decodeMeshopt(extension, coded, decoded, v);
  });
}

}  // namespace

Document::Document(std::filesystem::path file, const ImportOptions& import)
    : path(std::move(file)), options(import) {
  Container container = orThrow(openContainer(path));
  json = parseJson(container.json, warnings);
  checkDocument(json, warnings);
  loadBuffers(*this, std::move(container.binary));
}

namespace {

// Component types of accessors; any other one is float.
constexpr std::uint32_t kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123,
                        kUnsignedInt = 5125;

template <typename T>
T load(const std::byte* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));  // glTF and all supported machines are little-endian
  return value;
}

// Returns visit(number) of a component.
template <typename Visit>
auto visitNumber(const std::byte* bytes, std::uint32_t type, Visit visit) {
  switch (type) {
    case kByte:
      return visit(load<std::int8_t>(bytes));
    case kUnsignedByte:
      return visit(load<std::uint8_t>(bytes));
    case kShort:
      return visit(load<std::int16_t>(bytes));
    case kUnsignedShort:
      return visit(load<std::uint16_t>(bytes));
    case kUnsignedInt:
      return visit(load<std::uint32_t>(bytes));
    default:
      return visit(load<float>(bytes));
  }
}

float toFloat(const std::byte* bytes, std::uint32_t type, bool normalized) {
  return visitNumber(bytes, type, [&]<typename T>(T number) {
    const auto value = static_cast<float>(number);
    if (std::is_same_v<T, float> || !normalized) return value;
    return std::max(value / static_cast<float>(std::numeric_limits<T>::max()), -1.0f);
  });
}

std::uint32_t toIndex(const std::byte* bytes, std::uint32_t type) {
  return visitNumber(bytes, type, [](auto number) { return static_cast<std::uint32_t>(number); });
}

// Calls put(i, bytes of the value) for every element of an accessor, and again for those that its sparse part
// replaces. checkDocument() compared the extents with the byteLengths, and the buffers were loaded with
// exactly these. Without a bufferView, all bytes are 0.
template <typename Put>
void forEachElement(const Document& document, const json& accessor, std::size_t element, Put put) {
  const auto firstOf = [&](const json& place) {
    return document.view(place.at("bufferView").get<std::size_t>()).data() +
           place.value("byteOffset", std::size_t{0});
  };
  const auto count = accessor.at("count").get<std::size_t>();
  const std::vector<std::byte> zeros(element);
  const std::byte* first = zeros.data();
  std::size_t stride = 0;
  if (accessor.contains("bufferView") && count > 0) {
    first = firstOf(accessor);
    stride =
        document.at("bufferViews", accessor["bufferView"].get<std::size_t>()).value("byteStride", element);
  }
  for (std::size_t i = 0; i < count; ++i) put(i, first + i * stride);

  const json& sparse = memberOf(accessor, {"sparse"});
  if (sparse.is_null() || count == 0) return;
  const auto type = sparse.at("indices").at("componentType").get<std::uint32_t>();
  const std::byte *indices = firstOf(sparse.at("indices")), *values = firstOf(sparse.at("values"));
  const auto replaced = sparse.at("count").get<std::size_t>();
  for (std::size_t i = 0; i < replaced; ++i) {
    const std::size_t target = toIndex(indices + i * componentBytes(type), type);
    if (target < count) put(target, values + i * element);  // otherwise there is nothing to replace
  }
}

}  // namespace

Floats readFloats(const Document& document, std::size_t index, const std::string& use,
                  std::initializer_list<std::string_view> types, std::size_t components) {
  const json& accessor = document.at("accessors", index);
  const auto type = accessor.at("type").get<std::string>();
  if (std::ranges::find(types, type) == types.end())
    refuse("accessor {} ({}) has the wrong type", index, use);
  const auto component = accessor.at("componentType").get<std::uint32_t>();
  const std::size_t stored = componentsOf(type), bytes = componentBytes(component);
  const bool normalized = memberOf(accessor, {"normalized"}) == true;
  if (components == 0) components = stored;
  Floats floats{std::vector<float>(accessor.at("count").get<std::size_t>() * components, 1.0f), components};
  forEachElement(document, accessor, stored * bytes, [&](std::size_t i, const std::byte* value) {
    for (std::size_t c = 0; c < stored; ++c)
      floats.values[i * components + c] = toFloat(value + c * bytes, component, normalized);
  });
  return floats;
}

std::vector<std::uint32_t> readIndices(const Document& document, std::size_t index) {
  const json& accessor = document.at("accessors", index);
  const auto type = accessor.at("componentType").get<std::uint32_t>();
  if (accessor.at("type") != "SCALAR" ||
      (type != kUnsignedByte && type != kUnsignedShort && type != kUnsignedInt))
    refuse("accessor {} does not hold unsigned indices", index);
  std::vector<std::uint32_t> indices(accessor.at("count").get<std::size_t>());
  forEachElement(document, accessor, componentBytes(type),
                 [&](std::size_t i, const std::byte* value) { indices[i] = toIndex(value, type); });
  return indices;
}

}  // namespace lambent::baker
