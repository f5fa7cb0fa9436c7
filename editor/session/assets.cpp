#include "editor/session/assets.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "baker/pipeline/source_watch.hpp"
#include "editor/document/world_file.hpp"
#include "editor/session/session.hpp"
#include "runtime/base/lower_case.hpp"
#include "runtime/spec/light.hpp"

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
  constexpr std::array<std::string_view, 4> kKindWords = {"environment map", "scene", "bundle", "world"};
  return kKindWords[static_cast<std::size_t>(kind)];
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

namespace {

// Returns the folder of what was opened last, which may be a folder itself, or an empty path.
std::filesystem::path folderInUse(const Preferences& preferences) {
  if (preferences.recent.empty()) return {};
  const std::filesystem::path last = std::filesystem::path(preferences.recent.front()).lexically_normal();
  std::error_code ignored;
  return std::filesystem::is_directory(last, ignored) ? last : last.parent_path();
}

}  // namespace

void AssetBrowser::update(const Session& session) {
  std::vector<AssetGroup> groups;
  const auto add = [&](const std::filesystem::path& named) {
    std::error_code ignored;
    const std::filesystem::path folder =
        std::filesystem::weakly_canonical(named.empty() ? "." : named, ignored);
    if (std::ranges::find(samples_, folder) == samples_.end() &&
        std::ranges::find(groups, folder.string(), &AssetGroup::title) == groups.end())
      groups.push_back({.title = folder.string(), .folders = {folder}, .assets = {}});
  };
  if (const std::filesystem::path folder = folderInUse(session.preferences); !folder.empty()) add(folder);
  for (const std::string& word : session.document.world().lights)
    if (isEnvironmentMap(word)) add(std::filesystem::path(word).parent_path());
  for (const SceneEntry& entry : session.scenes.entries())
    add((entry.source.empty() ? entry.bundle : entry.source).parent_path());
  if (!samples_.empty()) groups.push_back({.title = "Samples", .folders = samples_, .assets = {}});
  std::vector<std::filesystem::path> folders;
  std::vector<std::filesystem::file_time_type> times;
  for (const AssetGroup& group : groups)
    for (const std::filesystem::path& one : group.folders) {
      std::error_code ignored;
      folders.push_back(one);
      times.push_back(std::filesystem::last_write_time(one, ignored));
    }
  if (!changed_.renew(folders, times, session.scenes.version())) return;
  for (AssetGroup& group : groups)
    for (const std::filesystem::path& folder : group.folders)
      for (Asset& asset : listAssets(folder)) group.assets.push_back(std::move(asset));
  groups_ = std::move(groups);
}

const AssetGroup* AssetBrowser::samples() const {
  const auto found = std::ranges::find(groups_, samples_, &AssetGroup::folders);
  return found == groups_.end() ? nullptr : &*found;
}

const Asset* AssetBrowser::find(std::string_view name) const {
  for (const AssetGroup& group : groups_)
    for (const Asset& asset : group.assets)
      if (asset.file == name || asset.file.filename() == name) return &asset;
  return nullptr;
}

namespace {

constexpr std::uint32_t kMapWidth = 128, kMapHeight = 64;
constexpr std::uint32_t kViewWidth = 192, kViewHeight = 108;

std::uint8_t coded(float value) {
  const float clamped = std::clamp(value, 0.0f, 1.0f);
  return static_cast<std::uint8_t>(255.0f * std::pow(clamped, 1.0f / 2.2f) + 0.5f);
}

}  // namespace

spec::Rgba8Image smallPictureOf(const spec::RgbImage& environment_map) {
  std::vector<glm::vec3> texels;
  std::vector<float> brightness;
  for (std::uint32_t y = 0; y < kMapHeight; ++y)
    for (std::uint32_t x = 0; x < kMapWidth; ++x) {
      const std::size_t from_x = (2 * std::size_t{x} + 1) * environment_map.width / (2 * kMapWidth);
      const std::size_t from_y = (2 * std::size_t{y} + 1) * environment_map.height / (2 * kMapHeight);
      texels.push_back(environment_map.texels[from_y * environment_map.width + from_x]);
      const float luminance = glm::dot(texels.back(), glm::vec3(0.2126f, 0.7152f, 0.0722f));
      brightness.push_back(std::isfinite(luminance) ? luminance : 0.0f);
    }
  const auto median = brightness.begin() + kMapWidth * kMapHeight / 2;
  std::nth_element(brightness.begin(), median, brightness.end());
  const float scale = 0.22f / std::max(1e-6f, *median);
  spec::Rgba8Image made{kMapWidth, kMapHeight, {}};
  for (const glm::vec3& texel : texels)
    for (const float value : {texel.r, texel.g, texel.b, 1.0f / scale})
      made.texels.push_back(std::isfinite(value) ? coded(scale * value) : std::uint8_t{255});
  return made;
}

spec::Rgba8Image smallPictureOf(const spec::Rgba8Image& view) {
  // The part of the view that is shown: as wide or as high as the view, and in the shape of the small
  // picture.
  const std::uint32_t width = std::min(view.width, view.height * kViewWidth / kViewHeight);
  const std::uint32_t height = std::min(view.height, view.width * kViewHeight / kViewWidth);
  const std::uint32_t left = (view.width - width) / 2, top = (view.height - height) / 2;
  spec::Rgba8Image made{kViewWidth, kViewHeight, {}};
  for (std::uint32_t y = 0; y < kViewHeight; ++y)
    for (std::uint32_t x = 0; x < kViewWidth; ++x) {
      const std::uint32_t x_begin = left + x * width / kViewWidth, y_begin = top + y * height / kViewHeight;
      const std::uint32_t x_end = std::max(x_begin + 1, left + (x + 1) * width / kViewWidth);
      const std::uint32_t y_end = std::max(y_begin + 1, top + (y + 1) * height / kViewHeight);
      std::array<std::uint32_t, 3> sum{};
      for (std::uint32_t from_y = y_begin; from_y < y_end; ++from_y)
        for (std::uint32_t from_x = x_begin; from_x < x_end; ++from_x)
          for (std::size_t channel = 0; channel < 3; ++channel)
            sum[channel] += view.texels[4 * (std::size_t{from_y} * view.width + from_x) + channel];
      const std::uint32_t count = (x_end - x_begin) * (y_end - y_begin);
      for (const std::uint32_t channel : sum)
        made.texels.push_back(static_cast<std::uint8_t>((channel + count / 2) / count));
      made.texels.push_back(255);
    }
  return made;
}

namespace {

// How many pictures are held in memory; a window shows far fewer at a time.
constexpr std::size_t kMostPictures = 512;

// Returns the picture that came with the file: one of its name beside it, in the shape of a view, since
// textures are named like their scenes, too. The samples have such pictures.
spec::Rgba8Image pictureBeside(const Asset& asset) {
  const std::filesystem::path file = asset.file.parent_path() / (nameOf(asset) + ".png");
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return {};
  const auto picture = spec::readPng(file);
  if (!picture || std::uint64_t{9} * picture->width != std::uint64_t{16} * picture->height) return {};
  return smallPictureOf(*picture);
}

AssetPictures::Made make(const Asset& asset) {
  try {
    if (asset.kind != AssetKind::EnvironmentMap) return {.asset = asset, .image = pictureBeside(asset)};
    const auto map = spec::readLightImage(asset.file);
    if (!map) return {.asset = asset, .error = map.error().line()};
    return {.asset = asset, .image = smallPictureOf(*map)};
  } catch (const std::exception& failure) {  // out of memory, mostly
    return {.asset = asset, .error = failure.what()};
  }
}

}  // namespace

const AssetPictures::Picture& AssetPictures::of(const Asset& asset) {
  const auto [asked, first] = asked_.try_emplace(asset.file, asset);
  Picture& picture = pictures_[asset.file];
  if (!first && asked->second == asset) return picture;
  asked->second = asset;
  picture = {};
  wanted_.push_back(asset);
  return picture;
}

void AssetPictures::update() {
  if (coming_.valid() && coming_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    Made made = coming_.get();
    // The file may have changed in the meantime.
    const auto asked = asked_.find(made.asset.file);
    if (asked != asked_.end() && asked->second == made.asset) {
      Picture& picture = pictures_[made.asset.file];
      picture.image = std::move(made.image);
      picture.error = std::move(made.error);
    }
  }
  if (!coming_.valid() && !wanted_.empty()) {
    coming_ = std::async(std::launch::async, make, std::move(wanted_.front()));
    wanted_.pop_front();
  }
  // Pictures that are still shown are made again.
  if (pictures_.size() <= kMostPictures || busy()) return;
  pictures_.clear();
  asked_.clear();
}

}  // namespace lambent::editor
