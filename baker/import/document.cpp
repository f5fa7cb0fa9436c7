#include "baker/import/document.hpp"

#include <algorithm>
#include <charconv>
#include <exception>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/import/buffer_source.hpp"
#include "baker/import/check.hpp"
#include "baker/import/error_text.hpp"
#include "baker/import/scene_files.hpp"
#include "baker/import/tinygltf.hpp"

namespace lambent::baker {
namespace {

using nlohmann::json;

// tinygltf walks `extras` recursively, so the depth must be limited.
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

// Connects tinygltf, which asks for buffers by name and knows no errors, with the source.
struct BufferAsker {
  BufferSource& source;
  std::optional<Error> error;

  bool read(std::vector<unsigned char>& out, const std::string& name) {
    std::size_t i = 0;
    std::from_chars(name.data(), name.data() + name.size(), i);
    auto bytes = source.read(i);
    if (!bytes) {
      error = std::move(bytes.error());
      return false;
    }
    const auto* first = reinterpret_cast<const unsigned char*>(bytes->data());
    out.assign(first, first + bytes->size());
    return true;
  }

  tinygltf::FsCallbacks callbacks() { return filled(tinygltf::FsCallbacks{}); }

 private:
  // tinygltf from 2.8 on asks for a file's size, too, and ignores callbacks of which one is missing. This is
  // a template because older versions lack that member.
  template <typename Callbacks>
  Callbacks filled(Callbacks callbacks) {
    callbacks.FileExists = [](const std::string&, void*) { return true; };
    callbacks.ExpandFilePath = [](const std::string& name, void*) { return name; };
    callbacks.ReadWholeFile = [](std::vector<unsigned char>* out, std::string*, const std::string& name,
                                 void* self) { return static_cast<BufferAsker*>(self)->read(*out, name); };
    callbacks.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&,
                                  void*) { return false; };
    // The size is for a limit of tinygltf's own; the source has its limits.
    if constexpr (requires { callbacks.GetFileSizeInBytes; })
      callbacks.GetFileSizeInBytes = [](std::size_t* bytes, std::string*, const std::string&, void*) {
        *bytes = 0;
        return true;
      };
    callbacks.user_data = this;
    return callbacks;
  }
};

void setIndicesAside(json& document) {
  if (!document.contains("meshes")) return;
  for (json& mesh : document["meshes"]) {
    if (!mesh.contains("primitives")) continue;
    for (json& primitive : mesh["primitives"]) {
      // An extension of this name in the file would be unchecked.
      if (primitive.contains("extensions")) primitive["extensions"].erase(kIndicesAside);
      if (!primitive.contains("indices")) continue;
      const bool draco =
          primitive.contains("extensions") && primitive["extensions"].contains("KHR_draco_mesh_compression");
      if (!draco && document["accessors"][primitive["indices"].get<std::size_t>()].contains("bufferView"))
        continue;
      primitive["extensions"][kIndicesAside]["accessor"] = primitive["indices"];
      primitive.erase("indices");
    }
  }
}

// Returns the text for tinygltf without what this room reads itself: it would decode images, drop parts of
// skins and animations that it does not accept, and refuse strides that are no multiples of 4.
std::string textForTinygltf(json& document) {
  std::map<const char*, json> aside;
  for (const char* key : {"images", "skins", "animations"}) {
    if (!document.contains(key)) continue;
    aside[key] = std::move(document[key]);
    document.erase(key);
  }
  if (document.contains("bufferViews")) {
    aside["bufferViews"] = document["bufferViews"];
    for (json& view : document["bufferViews"]) view.erase("byteStride");
  }
  std::string text = document.dump();
  for (auto& [key, value] : aside) document[key] = std::move(value);
  return text;
}

// Cuts tinygltf's message to one short line.
std::string firstLine(const std::string& text) {
  return text.substr(0, std::min<std::size_t>(text.find('\n'), 160));
}

}  // namespace

Document::Document(std::filesystem::path path, const ImportOptions& options,
                   std::unique_ptr<tinygltf::Model> model, std::unique_ptr<nlohmann::json> text,
                   std::vector<std::string> warnings)
    : path_(std::move(path)),
      options_(options),
      model_(std::move(model)),
      json_(std::move(text)),
      warnings_(std::move(warnings)) {}
Document::Document(Document&&) noexcept = default;
Document& Document::operator=(Document&&) noexcept = default;
Document::~Document() = default;

Result<Document> Document::open(const std::filesystem::path& path, const ImportOptions& options) {
  const std::string file = path.string();
  auto container = openContainer(path);
  if (!container) return failAgain(std::move(container.error()));
  std::vector<std::string> warnings;
  makeUtf8(container->json, warnings);
  auto document = parseJson(container->json, file);
  if (!document) return failAgain(std::move(document.error()));
  if (auto checked = checkDocument(*document, file, warnings); !checked)
    return failAgain(std::move(checked.error()));
  try {
    setIndicesAside(*document);
    BufferSource buffers(*document, std::move(container->binary), path, options, warnings);
    const std::string text = textForTinygltf(*document);
    if (text.size() > std::numeric_limits<unsigned>::max())
      return fail(file, "has more than 4 GiB of JSON", "keep buffers in files of their own");

    auto model = std::make_unique<tinygltf::Model>();
    tinygltf::TinyGLTF loader;
    BufferAsker asker{buffers, std::nullopt};
    loader.SetFsCallbacks(asker.callbacks());
    std::string error, ignored;
    const bool loaded =
        loader.LoadASCIIFromString(model.get(), &error, &ignored, text.data(),
                                   static_cast<unsigned>(text.size()), /*base_dir=*/"", tinygltf::NO_REQUIRE);
    if (asker.error) return failAgain(*asker.error);
    if (!loaded) return fail(file, fmt::format("is not valid glTF ({})", firstLine(error)), kExportAgain);
    return Document(path, options, std::move(model), std::make_unique<nlohmann::json>(std::move(*document)),
                    std::move(warnings));
  } catch (const std::exception& exception) {
    return fail(file, fmt::format("cannot be read ({})", reasonOf(exception)), kExportAgain);
  }
}

}  // namespace lambent::baker
