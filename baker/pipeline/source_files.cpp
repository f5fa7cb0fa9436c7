#include <algorithm>

#include <nlohmann/json.hpp>

#include "baker/import/scene_files.hpp"
#include "baker/pipeline/source_watch.hpp"

namespace lambent::baker {

namespace {

using nlohmann::json;

// Returns the member of that name, or null. Nothing in the text has been validated.
const json& memberOf(const json& value, const char* name) {
  static const json kNone;
  if (!value.is_object()) return kNone;
  const auto found = value.find(name);
  return found == value.end() ? kNone : *found;
}

void add(const json& uri, const std::filesystem::path& folder, std::vector<std::filesystem::path>& files) {
  if (!uri.is_string()) return;
  const auto text = uri.get<std::string>();
  if (text.empty() || text.find(':') != std::string::npos) return;  // such as data:, procedural: and http:
  const std::filesystem::path file = folder / decodePercent(text);
  if (std::ranges::find(files, file) == files.end()) files.push_back(file);
}

}  // namespace

std::vector<std::filesystem::path> sourceFiles(const std::filesystem::path& scene) {
  std::vector<std::filesystem::path> files = {scene};
  const auto container = openContainer(scene);
  if (!container) return files;
  const json document = json::parse(container->json, nullptr, /*allow_exceptions=*/false);
  const std::filesystem::path folder = scene.parent_path();
  for (const char* list : {"buffers", "images"})
    for (const json& entry : memberOf(document, list)) add(memberOf(entry, "uri"), folder, files);
  for (const json& node : memberOf(document, "nodes"))
    add(memberOf(memberOf(memberOf(memberOf(node, "extras"), "lambent"), "volume"), "file"), folder, files);
  for (const json& material : memberOf(document, "materials"))
    add(memberOf(memberOf(memberOf(material, "extras"), "lambent"), "brdf"), folder, files);
  return files;
}

bool isSceneFile(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  if (name.empty() || name.front() == '.' || name.ends_with(".lmb.glb")) return false;
  return path.extension() == ".gltf" || path.extension() == ".glb";
}

std::filesystem::path bundleBeside(const std::filesystem::path& scene) {
  return scene.parent_path() / (scene.stem().string() + ".lmb.glb");
}

}  // namespace lambent::baker
