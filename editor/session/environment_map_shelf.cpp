#include "editor/session/environment_map_shelf.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/spec/image.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::editor {

namespace {

constexpr std::uint32_t kWidth = 128, kHeight = 64;
constexpr std::size_t kMostMaps = 64;

bool isEnvironmentMap(const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  return ending == ".hdr" || ending == ".exr";
}

std::uint8_t coded(float value) {
  const float clamped = std::clamp(value, 0.0f, 1.0f);
  return static_cast<std::uint8_t>(255.0f * std::pow(clamped, 1.0f / 2.2f) + 0.5f);
}

std::vector<std::filesystem::path> foldersOf(std::vector<std::filesystem::path> folders,
                                             const std::vector<std::string>& light_words,
                                             const Scenes& scenes) {
  for (const std::string& word : light_words)
    if (const auto light = spec::parseLight(word);
        light && std::holds_alternative<spec::EnvironmentMapLight>(*light))
      folders.push_back(std::filesystem::path(word).parent_path());
  for (const SceneEntry& entry : scenes.entries())
    folders.push_back((entry.source.empty() ? entry.bundle : entry.source).parent_path());
  for (std::filesystem::path& folder : folders) {
    std::error_code ignored;
    folder = std::filesystem::weakly_canonical(folder.empty() ? "." : folder, ignored);
  }
  std::sort(folders.begin(), folders.end());
  folders.erase(std::unique(folders.begin(), folders.end()), folders.end());
  return folders;
}

}  // namespace

void EnvironmentMapShelf::addFolder(const std::filesystem::path& folder) {
  if (std::find(added_.begin(), added_.end(), folder) == added_.end()) added_.push_back(folder);
}

// Samples nearest texels and exposes them so that the median becomes middle grey.
EnvironmentMapShelf::Thumbnail EnvironmentMapShelf::read(const std::filesystem::path& file) {
  try {
    const auto image = spec::readLightImage(file);
    if (!image) return {.image = {}, .error = image.error().line()};
    std::vector<glm::vec3> texels;
    std::vector<float> brightness;
    for (std::uint32_t y = 0; y < kHeight; ++y)
      for (std::uint32_t x = 0; x < kWidth; ++x) {
        const std::size_t from_x = (2 * std::size_t{x} + 1) * image->width / (2 * kWidth);
        const std::size_t from_y = (2 * std::size_t{y} + 1) * image->height / (2 * kHeight);
        texels.push_back(image->texels[from_y * image->width + from_x]);
        const float luminance = glm::dot(texels.back(), glm::vec3(0.2126f, 0.7152f, 0.0722f));
        brightness.push_back(std::isfinite(luminance) ? luminance : 0.0f);
      }
    std::nth_element(brightness.begin(), brightness.begin() + kWidth * kHeight / 2, brightness.end());
    const float scale = 0.22f / std::max(1e-6f, brightness[kWidth * kHeight / 2]);
    Thumbnail made{{kWidth, kHeight, {}}, {}};
    for (const glm::vec3& texel : texels)
      for (const float value : {texel.r, texel.g, texel.b, 1.0f / scale})
        made.image.texels.push_back(std::isfinite(value) ? coded(scale * value) : std::uint8_t{255});
    return made;
  } catch (const std::exception& failure) {
    return {.image = {}, .error = failure.what()};
  }
}

void EnvironmentMapShelf::look() {
  std::vector<EnvironmentMap> found;
  for (const std::filesystem::path& folder : folders_) {
    std::error_code ignored;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
      if (entry.is_regular_file(ignored) && isEnvironmentMap(entry.path())) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (std::filesystem::path& file : files)
      if (found.size() < kMostMaps)
        found.push_back({.file = std::move(file), .thumbnail = {}, .error = {}, .texture = 0});
  }
  for (EnvironmentMap& environment_map : found)
    for (EnvironmentMap& old : environment_maps_)
      if (old.file == environment_map.file) environment_map = std::move(old);
  environment_maps_ = std::move(found);
}

void EnvironmentMapShelf::update(const std::vector<std::string>& light_words, const Scenes& scenes) {
  const bool coming = coming_.valid();
  if (!coming && changed_.renew(light_words, scenes.version(), added_.size())) {
    std::vector<std::filesystem::path> folders = foldersOf(added_, light_words, scenes);
    if (folders != folders_) {
      folders_ = std::move(folders);
      look();
    }
  }
  if (coming) {
    if (coming_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    Thumbnail made = coming_.get();
    environment_maps_[coming_for_].error = std::move(made.error);
    environment_maps_[coming_for_].thumbnail = std::move(made.image);
    return;
  }
  for (std::size_t i = 0; i < environment_maps_.size(); ++i)
    if (environment_maps_[i].thumbnail.texels.empty() && environment_maps_[i].error.empty()) {
      coming_for_ = i;
      coming_ = std::async(std::launch::async, &EnvironmentMapShelf::read, environment_maps_[i].file);
      return;
    }
}

bool EnvironmentMapShelf::busy() const {
  return coming_.valid() && coming_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
}

}  // namespace lambent::editor
