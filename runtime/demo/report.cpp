#include "runtime/demo/report.hpp"

#include <nlohmann/json.hpp>

namespace lambent::demo {

namespace {

using Json = nlohmann::ordered_json;

Json frameJson(const std::vector<gpu::PassTime>& passes) {
  Json list = Json::array();
  gpu::Counters total;
  double cpu_ms = 0.0, gpu_ms = 0.0;
  for (const gpu::PassTime& pass : passes) {
    list.push_back({{"name", pass.name},
                    {"cpu_ms", pass.cpu_ms},
                    {"gpu_ms", pass.gpu_ms < 0.0 ? Json() : Json(pass.gpu_ms)},
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
  return {{"passes", list},       {"cpu_ms", cpu_ms},
          {"gpu_ms", gpu_ms},     {"dispatches", total.dispatches},
          {"draws", total.draws}, {"draw_calls", total.draw_calls}};
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
                     {"rotate_light_deg", options.rotate_light_deg},
                     {"transfer", options.transfer_word},
                     {"window", options.window_word},
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
                     {"negative_pixels", report.negative_pixels},
                     {"frames", options.frames},
                     {"first_frame", frameJson(report.first_frame)},
                     {"last_frame", frameJson(report.last_frame)}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace lambent::demo
