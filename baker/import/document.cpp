#include "baker/import/document.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <exception>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/import/check.hpp"
#include "baker/import/container.hpp"
#include "baker/import/meshopt.hpp"
#include "baker/import/tinygltf.hpp"
#include "baker/import/uri.hpp"

namespace lambent::baker {
namespace {

using nlohmann::json;

// tinygltf walks `extras` by recursion: a file must not choose how deep.
constexpr int kMaxDepth = 64;

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
    return fail(file, fmt::format("is not glTF: its JSON cannot be parsed ({})", exception.what()),
                "export the scene again");
  }
}

// Gives tinygltf the buffers by number; they are found, bounded and read here, never by tinygltf.
class BufferSource {
 public:
  BufferSource(json& document, std::vector<std::byte> binary, const std::filesystem::path& path)
      : binary_(std::move(binary)), path_(path) {
    std::size_t i = 0;
    if (!document.contains("buffers")) return;
    for (json& buffer : document["buffers"]) {
      const std::string uri = buffer.value("uri", std::string());
      wanted_.push_back({uri, buffer["byteLength"].get<std::size_t>(), {}});
      if (!uri.starts_with("data:")) buffer["uri"] = std::to_string(i);
      ++i;
    }
    // Views that meshoptimizer coded belong to a buffer without bytes of its own; those that have bytes keep
    // them.
    if (!document.contains("bufferViews")) return;
    for (std::size_t v = 0; v < document["bufferViews"].size(); ++v) {
      const json& view = document["bufferViews"][v];
      Wanted& buffer = wanted_[view["buffer"].get<std::size_t>()];
      if (buffer.uri.empty() && view.contains("extensions") && view["extensions"].contains(kMeshopt))
        buffer.coded.push_back({v, view.value("byteOffset", std::size_t{0}),
                                view["byteLength"].get<std::size_t>(), view["extensions"][kMeshopt]});
    }
  }

  // A data: URI that tinygltf would not recognize, or that is not as long as announced, is named before it
  // tries.
  Result<void> checkEmbedded() const {
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
      const std::string& uri = wanted_[i].uri;
      const std::size_t length = wanted_[i].length;
      if (!uri.starts_with("data:")) continue;
      std::vector<unsigned char> bytes;
      std::string mime_type;
      if (!tinygltf::IsDataURI(uri) ||
          !tinygltf::DecodeDataURI(&bytes, mime_type, uri, length, /*checkSize=*/true))
        return fail(path_.string(),
                    fmt::format("buffer {}: its data URI does not hold {} bytes in base64", i, length),
                    "export the scene again");
    }
    return {};
  }

  const std::optional<Error>& error() const { return error_; }

  tinygltf::FsCallbacks callbacks() {
    return {.FileExists = [](const std::string&, void*) { return true; },
            .ExpandFilePath = [](const std::string& name, void*) { return name; },
            .ReadWholeFile = [](std::vector<unsigned char>* out, std::string*, const std::string& name,
                                void* self) { return static_cast<BufferSource*>(self)->read(*out, name); },
            .WriteWholeFile = nullptr,
            .user_data = this};
  }

 private:
  struct CodedView {
    std::size_t index = 0, offset = 0, length = 0;
    json extension;
  };
  struct Wanted {
    std::string uri;
    std::size_t length = 0;
    std::vector<CodedView> coded;  // not empty: the buffer is made of these
  };

  bool read(std::vector<unsigned char>& out, const std::string& name) {
    std::size_t i = 0;
    std::from_chars(name.data(), name.data() + name.size(), i);
    if (i >= wanted_.size()) return false;
    auto bytes = wanted_[i].coded.empty() ? load(i) : decode(wanted_[i]);
    if (!bytes) {
      error_ = std::move(bytes.error());
      return false;
    }
    const auto* first = reinterpret_cast<const unsigned char*>(bytes->data());
    out.assign(first, first + wanted_[i].length);
    return true;
  }

  // A buffer of views that meshoptimizer coded.
  Result<std::vector<std::byte>> decode(const Wanted& buffer) {
    std::size_t coded_bytes = 0;
    for (const CodedView& view : buffer.coded) coded_bytes += view.extension["byteLength"].get<std::size_t>();
    if (buffer.length / kMeshoptLargestRatio > coded_bytes)
      return fail(path_.string(), fmt::format("claims {} bytes coded in {}", buffer.length, coded_bytes),
                  "export the scene again");
    std::vector<std::byte> bytes(buffer.length);
    std::map<std::size_t, std::vector<std::byte>> sources;
    for (const CodedView& view : buffer.coded) {
      const auto source = view.extension["buffer"].get<std::size_t>();
      if (!sources.contains(source)) {
        auto loaded = load(source);
        if (!loaded) return loaded;
        sources[source] = std::move(*loaded);
      }
      const auto coded = std::span<const std::byte>(sources[source])
                             .subspan(view.extension.value("byteOffset", std::size_t{0}),
                                      view.extension["byteLength"].get<std::size_t>());
      const auto decoded =
          decodeMeshopt(view.extension, coded, std::span(bytes).subspan(view.offset, view.length),
                        path_.string(), fmt::format("bufferView {}", view.index));
      if (!decoded) return failAgain(decoded.error());
    }
    return bytes;
  }

  Result<std::vector<std::byte>> load(std::size_t i) {
    const std::string& uri = wanted_[i].uri;
    const std::size_t length = wanted_[i].length;
    const std::string object = fmt::format("buffer {}", i);
    std::vector<std::byte> bytes;
    if (uri.empty()) {
      if (i != 0 || binary_.empty())
        return fail(path_.string(), object + " has neither a URI nor a binary chunk",
                    "export the scene again");
      bytes = binary_;  // a copy: views that meshoptimizer coded may ask again
    } else if (uri.starts_with("data:")) {
      std::vector<unsigned char> decoded;
      std::string mime_type;
      tinygltf::DecodeDataURI(&decoded, mime_type, uri, length,
                              /*checkSize=*/true);  // checkEmbedded() saw to it
      bytes.assign(reinterpret_cast<const std::byte*>(decoded.data()),
                   reinterpret_cast<const std::byte*>(decoded.data() + decoded.size()));
    } else {
      auto file = resolveUri(path_.parent_path(), uri, path_.string(), object);
      if (!file) return failAgain(std::move(file.error()));
      auto read =
          readBytes(*file, fmt::format("{}: {} ({})", path_.string(), object, file->filename().string()));
      if (!read) return failAgain(std::move(read.error()));
      bytes = std::move(*read);
    }
    if (bytes.size() < length)
      return fail(path_.string(), fmt::format("{} has {} bytes of {}", object, bytes.size(), length),
                  "the file is truncated; copy or export it again");
    return bytes;
  }

  std::vector<Wanted> wanted_;
  std::vector<std::byte> binary_;
  const std::filesystem::path& path_;
  std::optional<Error> error_;
};

void setDracoIndicesAside(json& document) {
  if (!document.contains("meshes")) return;
  for (json& mesh : document["meshes"]) {
    if (!mesh.contains("primitives")) continue;
    for (json& primitive : mesh["primitives"]) {
      if (!primitive.contains("extensions")) continue;
      const auto draco = primitive["extensions"].find("KHR_draco_mesh_compression");
      if (draco == primitive["extensions"].end()) continue;
      draco->erase(kDracoIndices);  // the file's own would be unchecked
      if (!primitive.contains("indices")) continue;
      (*draco)[kDracoIndices] = primitive["indices"];
      primitive.erase("indices");
    }
  }
}

bool keepEncoded(tinygltf::Image* image, const int, std::string*, std::string*, int, int,
                 const unsigned char* bytes, int size, void*) {
  image->image.assign(bytes, bytes + size);
  image->as_is = true;
  return true;
}

// What tinygltf says, cut to one short line.
std::string firstLine(const std::string& text) {
  return text.substr(0, std::min<std::size_t>(text.find('\n'), 160));
}

}  // namespace

Document::Document(std::filesystem::path path, std::unique_ptr<tinygltf::Model> model)
    : path_(std::move(path)), model_(std::move(model)) {}
Document::Document(Document&&) noexcept = default;
Document& Document::operator=(Document&&) noexcept = default;
Document::~Document() = default;

Result<Document> Document::open(const std::filesystem::path& path) {
  const std::string file = path.string();
  auto container = openContainer(path);
  if (!container) return failAgain(std::move(container.error()));
  auto document = parseJson(container->json, file);
  if (!document) return failAgain(std::move(document.error()));
  if (auto checked = checkDocument(*document, file); !checked) return failAgain(std::move(checked.error()));
  try {
    setDracoIndicesAside(*document);
    BufferSource buffers(*document, std::move(container->binary), path);
    if (auto embedded = buffers.checkEmbedded(); !embedded) return failAgain(std::move(embedded.error()));
    const std::string text = document->dump();
    if (text.size() > std::numeric_limits<unsigned>::max())
      return fail(file, "has more than 4 GiB of JSON", "keep buffers in files of their own");

    auto model = std::make_unique<tinygltf::Model>();
    tinygltf::TinyGLTF loader;
    loader.SetFsCallbacks(buffers.callbacks());
    loader.SetImageLoader(keepEncoded, nullptr);
    std::string error, warning;
    const bool loaded =
        loader.LoadASCIIFromString(model.get(), &error, &warning, text.data(),
                                   static_cast<unsigned>(text.size()), /*base_dir=*/"", tinygltf::NO_REQUIRE);
    if (buffers.error()) return failAgain(*buffers.error());
    if (!loaded)
      return fail(file, fmt::format("is not valid glTF ({})", firstLine(error)), "export the scene again");
    return Document(path, std::move(model));
  } catch (const std::exception& exception) {
    return fail(file, fmt::format("cannot be read ({})", exception.what()), "export the scene again");
  }
}

}  // namespace lambent::baker
