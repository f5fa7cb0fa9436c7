#include "editor/session/assets.hpp"

#include <algorithm>
#include <fstream>
#include <string>

#include "baker/pipeline/source_watch.hpp"
#include "editor/document/world_file.hpp"
#include "editor/session/word_search.hpp"
#include "runtime/base/lower_case.hpp"

namespace lambent::editor {

namespace {

std::optional<AssetKind> kindByName(const std::filesystem::path& file) {
  const std::string ending = lowerCase(file.extension().string());
  if (ending == ".hdr" || ending == ".exr") return AssetKind::EnvironmentMap;
  if (file.filename().string().ends_with(".lmb.glb")) return AssetKind::Bundle;
  if (baker::isSceneFile(file)) return AssetKind::Scene;
  if (ending == ".json") return AssetKind::World;
  return std::nullopt;
}

// Looks for the mark of world files in the beginning of the file.
bool holdsWorld(const std::filesystem::path& file) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  std::string head(kMostBytes, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  return head.find('"' + std::string(kWorldFileMark) + '"') != std::string::npos;
}

}  // namespace

std::string_view kindWord(AssetKind kind) {
  switch (kind) {
    case AssetKind::EnvironmentMap:
      return "environment map";
    case AssetKind::Scene:
      return "scene";
    case AssetKind::Bundle:
      return "bundle";
    case AssetKind::World:
      return "world";
  }
  return {};
}

std::string nameOf(const Asset& asset) {
  const std::filesystem::path stem = asset.file.stem();
  const std::string second = stem.extension().string();
  const bool told = (asset.kind == AssetKind::Bundle && second == ".lmb") ||
                    (asset.kind == AssetKind::World && second == ".world");
  return (told ? stem.stem() : stem).string();
}

std::optional<Asset> assetAt(const std::filesystem::path& file) {
  const auto kind = kindByName(file);
  std::error_code wrong;
  if (!kind || !std::filesystem::is_regular_file(file, wrong)) return std::nullopt;
  Asset asset{.file = std::filesystem::absolute(file, wrong).lexically_normal(), .kind = *kind};
  asset.bytes = std::filesystem::file_size(file, wrong);
  if (!wrong) asset.written = std::filesystem::last_write_time(file, wrong);
  if (wrong) return std::nullopt;  // it was removed in between
  return asset;
}

std::vector<Asset> listAssets(const std::filesystem::path& folder, std::optional<AssetKind> only) {
  std::vector<Asset> assets;
  std::error_code wrong;
  for (auto at = std::filesystem::directory_iterator(folder, wrong);
       !wrong && at != std::filesystem::directory_iterator(); at.increment(wrong))
    if (auto asset = assetAt(at->path()); asset && (!only || asset->kind == *only))
      if (asset->kind != AssetKind::World || holdsWorld(asset->file)) assets.push_back(std::move(*asset));
  std::ranges::sort(assets, {}, &Asset::file);
  return assets;
}

bool matches(const Asset& asset, std::string_view search) {
  return holdsWords(asset.file.filename().string() + ' ' + std::string(kindWord(asset.kind)), search);
}

}  // namespace lambent::editor
