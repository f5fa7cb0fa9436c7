#include "baker/pipeline/bake_request.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/bake/bake.hpp"
#include "baker/bake/options.hpp"
#include "runtime/bundle/container.hpp"

namespace lambent::baker {

namespace {

constexpr std::uint32_t kCoarseRays = 128;
constexpr float kCoarseErrorBound = 0.03f;
constexpr std::uint32_t kCoarseVolumeGrid = 12;
constexpr glm::uvec3 kCoarseNeighborhoodGrid{12, 12, 6};

}  // namespace

const char* previewLevelName(PreviewLevel preview_level) {
  static constexpr std::array kNames = {"unshadowed", "coarse", "final"};
  return kNames[static_cast<std::size_t>(preview_level)];
}

BakeOptions previewLevelOptions(PreviewLevel preview_level, const BakeOptions& asked) {
  BakeOptions options = asked;
  if (preview_level != PreviewLevel::Coarse) return options;
  options.quality = Quality::Draft;
  options.rays = kCoarseRays;
  options.bounces = asked.bounces == 0 ? 0 : 1;
  options.picture_bound = 0.0f;
  options.error_bound = std::max(kCoarseErrorBound, asked.effectiveErrorBound());
  options.refine_bound = 0.0f;
  options.fit = false;
  options.volume_grid = glm::min(asked.volume_grid, glm::uvec3(kCoarseVolumeGrid));
  options.neighborhood_grid = asked.neighborhood_grid == glm::uvec3(0u)
                                  ? kCoarseNeighborhoodGrid
                                  : glm::min(asked.neighborhood_grid, kCoarseNeighborhoodGrid);
  return options;
}

Result<BakeReport> bakePreviewLevel(PreviewLevel preview_level, const Scene& scene, const BakeOptions& asked,
                                    const std::filesystem::path& output, const BakeContext& context) {
  const BakeOptions options = previewLevelOptions(preview_level, asked);
  if (preview_level == PreviewLevel::Unshadowed) return bakeUnshadowed(scene, options, output, context);
  return bake(scene, options, output, context);
}

namespace {

using nlohmann::json;

constexpr int kVersion = 3;

// Writes every option as a word.
json optionsJson(const BakeOptions& options) {
  json words = json::object();
  for (const OptionRow& row : optionRows()) words[std::string(row.name)] = row.word(options);
  return words;
}

BakeOptions readOptions(const json& words) {
  BakeOptions options;
  for (const OptionRow& row : optionRows())
    if (!row.read(options, words.at(std::string(row.name)).get<std::string>()))
      throw json::other_error::create(501, std::string(row.name), nullptr);
  return options;
}

}  // namespace

std::filesystem::path plainPath(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::filesystem::path absolute = std::filesystem::absolute(path, ignored);
  return (ignored ? path : absolute).lexically_normal();
}

std::string requestKey(const BakeRequest& request) {
  const std::string text = plainPath(request.scene).string() + '\n' + plainPath(request.output).string();
  return fmt::format("{:016x}", bundle::checksum(std::as_bytes(std::span(text))));
}

std::string requestText(const BakeRequest& request) {
  const json text = {{"version", kVersion},
                     {"program", LAMBENT_VERSION},
                     {"scene", plainPath(request.scene).string()},
                     {"output", plainPath(request.output).string()},
                     {"allowOutside", request.import.allow_outside},
                     {"options", optionsJson(request.options)},
                     {"edits", json::parse(editsText(request.edits))},
                     {"last", static_cast<int>(request.last)}};
  // Paths need not be UTF-8.
  return text.dump(2, ' ', false, json::error_handler_t::replace) + '\n';
}

std::optional<BakeRequest> readRequest(const std::string& text) {
  const json value = json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!value.is_object()) return std::nullopt;
  try {
    if (value.at("version").get<int>() != kVersion) return std::nullopt;
    BakeRequest request{.scene = value.at("scene").get<std::string>(),
                        .output = value.at("output").get<std::string>(),
                        .options = readOptions(value.at("options")),
                        .import = {.allow_outside = value.at("allowOutside").get<bool>()}};
    const auto edits = readEdits(value.at("edits").dump());
    const int last = value.at("last").get<int>();
    if (!edits || last < 0 || last > static_cast<int>(PreviewLevel::Final)) return std::nullopt;
    request.edits = *edits;
    request.last = static_cast<PreviewLevel>(last);
    return request;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

}  // namespace lambent::baker
