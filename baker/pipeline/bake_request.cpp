#include "baker/pipeline/bake_request.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "runtime/bundle/checksum.hpp"

namespace lambent::baker {

namespace {

using nlohmann::json;

constexpr int kVersion = 2;

std::filesystem::path plain(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::filesystem::path absolute = std::filesystem::absolute(path, ignored);
  return (ignored ? path : absolute).lexically_normal();
}

json gridJson(const glm::uvec3& grid) {
  return {grid.x, grid.y, grid.z};
}

glm::uvec3 readGrid(const json& value) {
  return {value.at(0).get<std::uint32_t>(), value.at(1).get<std::uint32_t>(),
          value.at(2).get<std::uint32_t>()};
}

json optionsJson(const BakeOptions& o) {
  return {{"quality", static_cast<int>(o.quality)},
          {"order", o.order},
          {"glossyOrder", o.glossy_order},
          {"rays", o.rays},
          {"bounces", o.bounces},
          {"errorBound", o.error_bound},
          {"maxEdge", o.max_edge_m},
          {"neighborhoodGrid", gridJson(o.neighborhood_grid)},
          {"refineBound", o.refine_bound},
          {"fit", o.fit ? json(*o.fit) : json()},
          {"lightSamples", o.light_samples},
          {"volumeGrid", gridJson(o.volume_grid)},
          {"effects", o.effects},
          {"threads", o.threads},
          {"memory", o.memory_bytes}};
}

BakeOptions readOptions(const json& value) {
  BakeOptions o;
  const int quality = value.at("quality").get<int>();
  if (quality < 0 || quality > static_cast<int>(Quality::High))
    throw json::other_error::create(501, "quality", nullptr);
  o.quality = static_cast<Quality>(quality);
  value.at("order").get_to(o.order);
  value.at("glossyOrder").get_to(o.glossy_order);
  value.at("rays").get_to(o.rays);
  value.at("bounces").get_to(o.bounces);
  value.at("errorBound").get_to(o.error_bound);
  value.at("maxEdge").get_to(o.max_edge_m);
  o.neighborhood_grid = readGrid(value.at("neighborhoodGrid"));
  value.at("refineBound").get_to(o.refine_bound);
  if (const json& fit = value.at("fit"); !fit.is_null()) o.fit = fit.get<bool>();
  value.at("lightSamples").get_to(o.light_samples);
  o.volume_grid = readGrid(value.at("volumeGrid"));
  value.at("effects").get_to(o.effects);
  value.at("threads").get_to(o.threads);
  value.at("memory").get_to(o.memory_bytes);
  return o;
}

}  // namespace

std::string requestKey(const BakeRequest& request) {
  const std::string text = plain(request.scene).string() + '\n' + plain(request.output).string();
  return fmt::format("{:016x}", bundle::checksum(std::as_bytes(std::span(text))));
}

std::string requestText(const BakeRequest& request) {
  const json text = {{"version", kVersion},
                     {"program", LAMBENT_VERSION},
                     {"scene", plain(request.scene).string()},
                     {"output", plain(request.output).string()},
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
    if (!edits || last < 0 || last > static_cast<int>(Rung::Final)) return std::nullopt;
    request.edits = *edits;
    request.last = static_cast<Rung>(last);
    return request;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

}  // namespace lambent::baker
