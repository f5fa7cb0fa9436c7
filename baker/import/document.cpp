#include "baker/import/document.hpp"

#include <algorithm>
#include <cstring>
#include <exception>
#include <limits>
#include <map>
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

// Returns how many bytes the UTF-8 sequence at `at` has, or 0 if there is none.
std::size_t sequenceBytes(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(i < text.size() ? text[i] : 0); };
  const unsigned char first = byte(at);
  if (first < 0x80) return 1;
  const std::size_t bytes = first >= 0xc2 && first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  if (first < 0xc2 || first > 0xf4) return 0;
  // Overlong forms, surrogates, and what is past U+10FFFF.
  const unsigned char second = byte(at + 1);
  if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
      (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f))
    return 0;
  for (std::size_t i = 1; i < bytes; ++i)
    if ((byte(at + i) & 0xc0) != 0x80) return 0;
  return bytes;
}

// Takes bytes that are no UTF-8 for Latin-1, in which exporters write names.
void makeUtf8(std::string& text, std::vector<std::string>& warnings) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    if (const std::size_t bytes = sequenceBytes(text, at); bytes > 0) {
      out.append(text, at, bytes);
      at += bytes;
    } else {
      const auto byte = static_cast<unsigned char>(text[at++]);
      out += {static_cast<char>(0xc0 | (byte >> 6)), static_cast<char>(0x80 | (byte & 0x3f))};
    }
  }
  if (out == text) return;
  warnings.emplace_back("its JSON is not UTF-8 and is read as Latin-1");
  text = std::move(out);
}

Result<json> parseJson(const std::string& text, const std::string& file) {
  bool too_deep = false;
  try {
    json document = json::parse(text, [&](int depth, json::parse_event_t, json&) {
      too_deep = too_deep || depth > kMaxDepth;
      return !too_deep;
    });
    if (too_deep)
      return fail(file, fmt::format("nests JSON deeper than {} levels", kMaxDepth), "simplify its extras");
    return document;
  } catch (const json::exception& exception) {
    return fail(file, fmt::format("is not glTF: its JSON cannot be parsed ({})", reasonOf(exception)),
                kExportAgain);
  }
}

// Decodes EXT_meshopt_compression: bufferViews coded by meshoptimizer (with the codecs and filters of the
// glTF extension, which gltfpack writes). The bytes are checked before use and decoded into the buffer that
// the view names, so accessors read them like any others.

// The most decoded bytes per coded byte: vertex blocks of equal bytes take 2 bits for 16 bytes, triangles one
// byte for 12. A file that claims more is refused before memory is taken.
constexpr std::size_t kMeshoptLargestRatio = 256;

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

// Gives the buffers of a checked document by number. They come from files beside it, data: URIs, the binary
// chunk, or views coded by meshoptimizer. Each is found, bounds-checked and read here.
class BufferSource {
 public:
  BufferSource(Document& document, std::vector<std::byte> binary)
      : document_(document), binary_(std::move(binary)) {
    for (const json& buffer : document.list("buffers"))
      wanted_.push_back({buffer.value("uri", ""), buffer.at("byteLength").get<std::size_t>(), {}});
    // Views that meshoptimizer coded belong to a buffer without bytes of its own; buffers that have bytes
    // keep them.
    for (std::size_t v = 0; v < document.list("bufferViews").size(); ++v) {
      const json& view = document.at("bufferViews", v);
      Wanted& buffer = wanted_[view.at("buffer").get<std::size_t>()];
      const json& extension = memberOf(view, {"extensions", kMeshopt});
      if (!buffer.uri.empty() || extension.is_null()) continue;
      buffer.coded.push_back(
          {v, view.value("byteOffset", std::size_t{0}), view.at("byteLength").get<std::size_t>(), extension});
      sources_[buffer.coded.back().source()] = {};
    }
  }

  // Returns as many bytes as the buffer announces. Errors name the file and "buffer 2".
  Result<std::vector<std::byte>> read(std::size_t i) {
    if (wanted_[i].length == 0) return std::vector<std::byte>();
    auto bytes = wanted_[i].coded.empty() ? load(i) : decode(wanted_[i]);
    if (bytes) bytes->resize(wanted_[i].length);
    return bytes;
  }

 private:
  struct CodedView {
    std::size_t index = 0, offset = 0, length = 0;
    const json& extension;

    std::size_t source() const { return extension.at("buffer").get<std::size_t>(); }
    std::size_t first() const { return extension.value("byteOffset", std::size_t{0}); }
    std::size_t bytes() const { return extension.at("byteLength").get<std::size_t>(); }
  };
  struct Wanted {
    std::string uri;
    std::size_t length = 0;
    std::vector<CodedView> coded;  // if not empty, the buffer is made of these
  };

  // Makes a buffer from its views that meshoptimizer coded.
  Result<std::vector<std::byte>> decode(const Wanted& buffer) {
    std::map<std::size_t, std::vector<std::pair<std::size_t, std::size_t>>> ranges;  // by source buffer
    for (const CodedView& view : buffer.coded)
      ranges[view.source()].emplace_back(view.first(), view.first() + view.bytes());
    std::size_t coded_bytes = 0;
    for (const auto& [source, list] : ranges) coded_bytes += bytesCovered(list);
    if (buffer.length / kMeshoptLargestRatio > coded_bytes)
      return fail(document_.file(), fmt::format("claims {} bytes coded in {}", buffer.length, coded_bytes),
                  kExportAgain);
    std::vector<std::byte> bytes(buffer.length);
    for (const CodedView& view : buffer.coded) {
      if (sources_.at(view.source()).empty())
        if (auto loaded = load(view.source()); !loaded) return loaded;
      const auto coded =
          std::span<const std::byte>(sources_.at(view.source())).subspan(view.first(), view.bytes());
      const auto decoded =
          decodeMeshopt(view.extension, coded, std::span(bytes).subspan(view.offset, view.length),
                        document_.file(), fmt::format("bufferView {}", view.index));
      if (!decoded) return failAgain(decoded.error());
    }
    return bytes;
  }

  Result<std::vector<std::byte>> load(std::size_t i) {
    const auto source = sources_.find(i);
    if (source != sources_.end() && !source->second.empty()) return source->second;
    const std::string& uri = wanted_[i].uri;
    const std::string object = fmt::format("buffer {}", i);
    std::vector<std::byte> bytes;
    if (uri.empty()) {
      if (i != 0 || binary_.empty())
        return fail(document_.file(), object + " has neither a URI nor a binary chunk", kExportAgain);
      bytes = std::exchange(binary_, {});
    } else {
      auto read = readUri(document_.path, uri, document_.options, object, document_.warnings);
      if (!read) return read;
      bytes = std::move(*read);
    }
    if (bytes.size() < wanted_[i].length)
      return fail(document_.file(),
                  fmt::format("{} has {} bytes of {}", object, bytes.size(), wanted_[i].length),
                  "the file is truncated; copy or export it again");
    if (source != sources_.end()) source->second = bytes;
    return bytes;
  }

  Document& document_;
  std::vector<Wanted> wanted_;
  std::map<std::size_t, std::vector<std::byte>> sources_;  // that coded views read from; empty until loaded
  std::vector<std::byte> binary_;
};

}  // namespace

Result<Document> Document::open(const std::filesystem::path& path, const ImportOptions& options) {
  const std::string file = path.string();
  auto container = openContainer(path);
  if (!container) return failAgain(std::move(container.error()));
  Document document;
  document.path = path;
  document.options = options;
  makeUtf8(container->json, document.warnings);
  auto parsed = parseJson(container->json, file);
  if (!parsed) return failAgain(std::move(parsed.error()));
  document.json = std::move(*parsed);
  if (auto checked = checkDocument(document.json, file, document.warnings); !checked)
    return failAgain(std::move(checked.error()));
  try {
    BufferSource source(document, std::move(container->binary));
    for (std::size_t i = 0; i < document.list("buffers").size(); ++i) {
      auto bytes = source.read(i);
      if (!bytes) return failAgain(std::move(bytes.error()));
      document.buffers.push_back(std::move(*bytes));
    }
    return document;
  } catch (const std::exception& exception) {
    return fail(file, fmt::format("cannot be read ({})", reasonOf(exception)), kExportAgain);
  }
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

template <typename T>
float integerToFloat(const std::byte* bytes, bool normalized) {
  const auto value = static_cast<float>(load<T>(bytes));
  if (!normalized) return value;
  return std::max(value / static_cast<float>(std::numeric_limits<T>::max()), -1.0f);
}

float toFloat(const std::byte* bytes, std::uint32_t type, bool normalized) {
  switch (type) {
    case kByte:
      return integerToFloat<std::int8_t>(bytes, normalized);
    case kUnsignedByte:
      return integerToFloat<std::uint8_t>(bytes, normalized);
    case kShort:
      return integerToFloat<std::int16_t>(bytes, normalized);
    case kUnsignedShort:
      return integerToFloat<std::uint16_t>(bytes, normalized);
    case kUnsignedInt:
      return integerToFloat<std::uint32_t>(bytes, normalized);
    default:
      return load<float>(bytes);
  }
}

std::uint32_t toIndex(const std::byte* bytes, std::uint32_t type) {
  switch (type) {
    case kUnsignedByte:
      return load<std::uint8_t>(bytes);
    case kUnsignedShort:
      return load<std::uint16_t>(bytes);
    default:
      return load<std::uint32_t>(bytes);
  }
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

Result<Floats> readFloats(const Document& document, std::size_t index, const std::string& use,
                          std::initializer_list<std::string_view> types, std::size_t components) {
  const json& accessor = document.at("accessors", index);
  const auto type = accessor.at("type").get<std::string>();
  if (std::ranges::find(types, type) == types.end())
    return fail(document.file(), fmt::format("accessor {} ({}) has the wrong type", index, use),
                kExportAgain);
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

Result<std::vector<std::uint32_t>> readIndices(const Document& document, std::size_t index) {
  const json& accessor = document.at("accessors", index);
  const auto type = accessor.at("componentType").get<std::uint32_t>();
  if (accessor.at("type") != "SCALAR" ||
      (type != kUnsignedByte && type != kUnsignedShort && type != kUnsignedInt))
    return fail(document.file(), fmt::format("accessor {} does not hold unsigned indices", index),
                kExportAgain);
  std::vector<std::uint32_t> indices(accessor.at("count").get<std::size_t>());
  forEachElement(document, accessor, componentBytes(type),
                 [&](std::size_t i, const std::byte* value) { indices[i] = toIndex(value, type); });
  return indices;
}

}  // namespace lambent::baker
