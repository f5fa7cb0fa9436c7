#include "runtime/demo/report.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "runtime/world/frame_times.hpp"

namespace lambent::demo {

namespace {

using Json = nlohmann::ordered_json;

// Leaves out the first frame, which also waits for what is made once.
frame::FrameTimes timesOf(const std::vector<double>& of_frames) {
  frame::FrameTimes times(of_frames.size());
  for (std::size_t i = of_frames.size() > 1 ? 1 : 0; i < of_frames.size(); ++i) times.add(of_frames[i]);
  return times;
}

Json countsJson(const frame::StepCounts& counts) {
  Json json = Json::object();
  for (const frame::StepCounts::Count& count : counts) json[std::string(count.name)] = count.value;
  return json;
}

Json frameTimesJson(const frame::FrameTimes& times) {
  if (times.count() == 0) return Json();
  const double median = times.median();
  return {{"median", median},
          {"p95", times.quantile(0.95)},
          {"max", times.worst()},
          {"over_twice_median", times.overTwiceMedian()},
          {"histogram_quarters_of_median", times.histogram()},
          {"frames_per_second", median > 0.0 ? 1000.0 / median : 0.0}};
}

Json streamingJson(const frame::StreamingStatus& status) {
  constexpr const char* kShown[] = {"nothing", "proxy", "partly", "full"};
  constexpr const char* kStates[] = {"closed", "loading", "partial", "whole", "damaged"};
  Json bundles = Json::array();
  for (const frame::BundleStreaming& bundle : status.bundles)
    bundles.push_back({{"name", bundle.name},
                       {"state", kStates[static_cast<std::size_t>(bundle.state)]},
                       {"shown", kShown[static_cast<std::size_t>(bundle.shown)]},
                       {"bytes_whole", bundle.whole_bytes},
                       {"bytes_wanted", bundle.wanted_bytes},
                       {"bytes_resident", bundle.resident_bytes},
                       {"size_seen", bundle.size}});
  const bool limited = status.budget_bytes != ~std::uint64_t{0};
  return {{"budget_bytes", limited ? Json(status.budget_bytes) : Json()},
          {"bytes_resident", status.resident_bytes},
          {"bytes_of_proxies", status.proxy_lod_bytes},
          {"shown_in_full", status.count(frame::Shown::Full)},
          {"shown_partly", status.count(frame::Shown::Partly)},
          {"shown_as_proxies", status.count(frame::Shown::ProxyLod)},
          {"not_shown", status.count(frame::Shown::Nothing)},
          {"queued", status.queued},
          {"bytes_in_flight", status.in_flight_bytes},
          {"megabytes_per_second", status.megabytes_per_s},
          {"bundles", bundles}};
}

Json frameJson(const FrameReport& frame) {
  Json list = Json::array();
  gpu::Counters total;
  double cpu_ms = 0.0, gpu_ms = 0.0;
  for (const gpu::PassTime& pass : frame.passes) {
    list.push_back({{"name", pass.name},
                    {"cpu_ms", pass.cpu_ms},
                    {"gpu_ms", pass.gpu_ms < 0.0 ? Json() : Json(pass.gpu_ms)},
                    {"reason", pass.reason},
                    {"dispatches", pass.counters.dispatches},
                    {"draws", pass.counters.draws},
                    {"draw_calls", pass.counters.draw_calls},
                    {"uploaded_bytes", pass.counters.uploaded_bytes}});
    total.dispatches += pass.counters.dispatches;
    total.draws += pass.counters.draws;
    total.draw_calls += pass.counters.draw_calls;
    cpu_ms += pass.cpu_ms;
    gpu_ms += std::max(pass.gpu_ms, 0.0);
  }
  return {{"passes", list},
          {"counts", countsJson(frame.counts)},
          {"cpu_ms", cpu_ms},
          {"gpu_ms", gpu_ms},
          {"dispatches", total.dispatches},
          {"draws", total.draws},
          {"draw_calls", total.draw_calls}};
}

// Lists key lights, brightest first, with the angles of light options: azimuth 0 is +Z, 90 is +X.
Json keysJson(std::vector<spec::Disc> keys) {
  const auto flux = [](const spec::Disc& key) {
    const float half = std::sin(0.5f * key.radius_rad);
    return half * half * (key.radiance.r + key.radiance.g + key.radiance.b);
  };
  std::ranges::stable_sort(keys, std::ranges::greater(), flux);
  Json list = Json::array();
  for (const spec::Disc& key : keys)
    list.push_back({{"azimuth_deg", glm::degrees(std::atan2(key.direction.x, key.direction.z))},
                    {"elevation_deg", glm::degrees(std::asin(std::clamp(key.direction.y, -1.0f, 1.0f)))},
                    {"radius_deg", glm::degrees(key.radius_rad)},
                    {"radiance", {key.radiance.r, key.radiance.g, key.radiance.b}}});
  return list;
}

// Lists the settings by the names of their options.
Json settingsJson(const frame::FrameSettings& settings) {
  Json json = Json::object();
  for (const frame::SettingRow& row : frame::settingRows())
    json[std::string(row.name)] = frame::settingWord(row, settings);
  return json;
}

}  // namespace

std::string reportJson(const Options& options, const gpu::DeviceInfo& device, const Report& report) {
  Json bundles = Json::array();
  for (const std::filesystem::path& path : options.bundles) bundles.push_back(path.string());
  const Json json = {{"program", "lambent-demo"},
                     {"version", LAMBENT_VERSION},
                     {"bundles", bundles},
                     {"picture", options.headless ? Json(options.headless->string()) : Json()},
                     {"size", {options.size.width, options.size.height}},
                     {"lights", options.light_words},
                     {"key_lights", keysJson(report.keys)},
                     {"key_shadow_bytes", report.key_shadow_bytes},
                     {"rotate_light_deg", options.rotate_light_deg},
                     {"fade_to", options.fade_words},
                     {"fade", options.fade},
                     {"time_s", options.time_s ? Json(*options.time_s) : Json()},
                     {"settings", settingsJson(options.settings)},
                     {"view", frame::wordOf(options.view)},
                     {"lamps", options.lamps},
                     {"exposure_ev", options.linear ? Json() : Json(report.exposure_ev)},
                     {"renderer", device.renderer},
                     {"gl_version", device.version},
                     {"gl_errors", report.gl_errors},
                     {"load_ms", report.load_ms},
                     {"bytes_resident", report.bytes_resident},
                     {"bytes_loaded", report.parts.bytes_loaded},
                     {"bytes_in_bundles", report.parts.bytes_in_bundles},
                     {"planes_resident", report.parts.planes_resident},
                     {"planes_in_bundles", report.parts.planes_in_bundles},
                     {"streaming", streamingJson(report.streaming)},
                     {"negative_pixels", report.negative_pixels},
                     {"frames", options.frames},
                     {"frame_ms", frameTimesJson(timesOf(report.frame_ms))},
                     {"frame_processor_ms", timesOf(report.processor_ms).median()},
                     {"rest_steps", report.rest_steps},
                     {"first_frame", frameJson(report.first_frame)},
                     {"last_frame", frameJson(report.last_frame)}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace lambent::demo
