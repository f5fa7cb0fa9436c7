#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "runtime/demo/stage.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/frame/frame_parts.hpp"
#include "runtime/gpu/context.hpp"
#include "runtime/gpu/pass_timers.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/world/frame_times.hpp"
#include "runtime/world/world.hpp"

namespace lambent::demo {

namespace {

using Json = nlohmann::ordered_json;

struct Report {
  Json first_frame, last_frame;
  std::vector<double> frame_ms;      // per frame, until the GPU was done
  std::vector<double> processor_ms;  // per frame, of all threads; where the processor draws, its cost
  std::uint32_t rest_steps = 0;      // steps after the last frame until no light changed any more
  double load_ms = 0.0;              // from opening the bundles until everything was resident
};

// Leaves out the first frame, which also waits for what is made once.
frame::FrameTimes timesOf(const std::vector<double>& of_frames) {
  frame::FrameTimes times(of_frames.size());
  for (std::size_t i = of_frames.size() > 1 ? 1 : 0; i < of_frames.size(); ++i) times.add(of_frames[i]);
  return times;
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

// Lists what the last frame cost and counted.
Json frameJson(frame::Frame& frame) {
  Json list = Json::array(), counts = Json::object();
  for (const frame::StepCounts::Count& count : frame.counts()) counts[std::string(count.name)] = count.value;
  frame.timers().finish();
  gpu::Counters total;
  double cpu_ms = 0.0, gpu_ms = 0.0;
  for (const gpu::PassTime& pass : frame.timers().latest()) {
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
          {"counts", counts},
          {"cpu_ms", cpu_ms},
          {"gpu_ms", gpu_ms},
          {"dispatches", total.dispatches},
          {"draws", total.draws},
          {"draw_calls", total.draw_calls}};
}

// Lists key lights, brightest first, with the angles of light options: azimuth 0 is +Z, 90 is +X.
Json keysJson(std::span<const spec::Disc> of_frame) {
  std::vector<spec::Disc> keys(of_frame.begin(), of_frame.end());
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

// Makes the output of --json: the arguments of the run, the passes of the first and the last frame (times in
// milliseconds, what each issued, what was captured and shaded), frame times, what was loaded, bytes
// resident, negative pixels, and the device.
std::string reportJson(const Options& options, const gpu::Context& context, Stage& stage,
                       const frame::Frame& frame, const Report& report) {
  const frame::StreamingStatus streaming = stage.world().streaming();
  Json bundles = Json::array();
  for (const std::filesystem::path& path : options.bundles) bundles.push_back(path.string());
  const Json json = {{"program", "lambent-demo"},
                     {"version", LAMBENT_VERSION},
                     {"bundles", bundles},
                     {"picture", options.headless ? Json(options.headless->string()) : Json()},
                     {"size", {options.size.width, options.size.height}},
                     {"lights", options.light_words},
                     {"key_lights", keysJson(stage.environment().keys())},
                     {"key_shadow_bytes", frame.parts().key_shadows.bytesResident()},
                     {"rotate_light_deg", options.rotate_light_deg},
                     {"fade_to", options.fade_words},
                     {"fade", options.fade},
                     {"time_s", options.time_s ? Json(*options.time_s) : Json()},
                     {"settings", settingsJson(options.settings)},
                     {"view", frame::wordOf(options.view)},
                     {"lamps", options.lamps},
                     {"exposure_ev", options.linear ? Json() : Json(frame.exposureEv())},
                     {"renderer", context.info().renderer},
                     {"gl_version", context.info().version},
                     {"gl_errors", context.errors()},
                     {"load_ms", report.load_ms},
                     {"bytes_resident", streaming.resident_bytes + frame.parts().volume.textureBytes()},
                     {"streaming", streamingJson(streaming)},
                     {"negative_pixels", frame.negativePixels()},
                     {"frames", options.frames},
                     {"frame_ms", frameTimesJson(timesOf(report.frame_ms))},
                     {"frame_processor_ms", timesOf(report.processor_ms).median()},
                     {"rest_steps", report.rest_steps},
                     {"first_frame", report.first_frame},
                     {"last_frame", report.last_frame}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

// Names the pictures of a sequence: a run of # in the file name stands for the frame's number with as many
// digits.
bool isNumbered(const std::filesystem::path& path) {
  return path.filename().string().find('#') != std::string::npos;
}

// Returns, for "frame-###.png" and 7, "frame-007.png". Only the first run counts; a path without one is
// unchanged.
std::filesystem::path numberedPath(const std::filesystem::path& path, std::uint32_t number) {
  std::string name = path.filename().string();
  const std::size_t first = name.find('#');
  if (first == std::string::npos) return path;
  const std::size_t end = std::min(name.find_first_not_of('#', first), name.size());
  name.replace(first, end - first, fmt::format("{:0{}}", number, end - first));
  return path.parent_path() / name;
}

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// Returns what all threads of this program have worked.
double processorMilliseconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

Result<void> writePicture(const frame::Frame& frame, const Options& options, std::uint32_t number) {
  const std::filesystem::path path = numberedPath(*options.headless, number);
  const auto write = [&](const auto& picture, const auto& writer) {
    const Result<void> kept = gpu::checkContext();  // what is read from a lost one is no picture
    return kept ? writer(path, picture) : kept;
  };
  const Result<void> written =
      options.linear ? write(frame.readLinear(), spec::writeExr) : write(frame.readDisplay(), spec::writePng);
  if (written && !options.json) fmt::print("{}\n", path.string());
  return written;
}

}  // namespace

Result<void> runHeadless(const Options& options) {
  Result<lighting::Environment> environment = loadEnvironment(options);
  if (!environment) return failAgain(environment.error());
  Result<gpu::Context> context = gpu::Context::createHeadless();
  if (!context) return failAgain(context.error());
  // A picture that the device cannot hold is reported before anything is loaded.
  const std::uint32_t limit = context->info().max_texture_side;
  if (options.size.width > limit || options.size.height > limit)
    return fail("--size", fmt::format("this device draws at most {} pixels a side", limit),
                "ask for a smaller picture");

  const auto start = Clock::now();
  Report report;
  Result<Stage> stage = Stage::create(options, std::move(*environment));
  if (!stage) return failAgain(stage.error());
  frame::World& world = stage->world();
  const Result<spec::View> first_view = stage->view(options.size.aspect());
  if (!first_view) return failAgain(first_view.error());
  world.look(*first_view);
  gpu::Counters loading;
  if (Result<void> loaded = world.uploadAll(loading); !loaded) return loaded;
  report.load_ms = millisecondsSince(start);

  Result<frame::Frame> frame =
      frame::Frame::create({.size = options.size,
                            .output = options.linear ? frame::Output::Linear : frame::Output::Display,
                            .settings = options.settings,
                            .wait_for_captures = true,
                            .view = options.view,
                            .overlays = options.overlays},
                           stage->environment());
  if (!frame) return failAgain(frame.error());
  const auto render = [&]() -> Result<void> {
    world.updateTransforms();  // cameras may be attached to what moves
    const Result<spec::View> view = stage->view(options.size.aspect());
    if (!view) return failAgain(view.error());
    return frame->render(world, stage->environment(), *view);
  };
  // A picture shows the light after it has come to rest.
  const auto finishPicture = [&](std::uint32_t number) -> Result<void> {
    const Result<std::uint32_t> steps = frame->rest(world, stage->environment());
    if (!steps) return failAgain(steps.error());
    report.rest_steps = *steps;
    if (*steps > 0)
      if (Result<void> rendered = render(); !rendered) return rendered;
    return writePicture(*frame, options, number);
  };
  const bool every_frame = isNumbered(*options.headless);
  for (std::uint32_t i = 0; i < options.frames; ++i) {
    // Over several frames the light turns to its place and time runs to the requested value, so that the cost
    // of movement can be measured.
    stage->environment().setTurn(options.rotate_light_deg * static_cast<float>(i + 1) /
                                 static_cast<float>(options.frames));
    if (options.time_s)
      world.setAnimationTime(
          std::max(0.0f, *options.time_s - options.step_s * static_cast<float>(options.frames - 1 - i)));
    const auto frame_start = Clock::now();
    const double processor_start = processorMilliseconds();
    if (Result<void> rendered = render(); !rendered) return rendered;
    glFinish();
    report.frame_ms.push_back(millisecondsSince(frame_start));
    report.processor_ms.push_back(processorMilliseconds() - processor_start);
    if (i == 0) report.first_frame = frameJson(*frame);
    if (i + 1 == options.frames) report.last_frame = frameJson(*frame);
    if (every_frame || i + 1 == options.frames)
      if (Result<void> finished = finishPicture(i); !finished) return finished;
  }
  if (!options.json) return {};
  fmt::print("{}\n", reportJson(options, *context, *stage, *frame, report));
  return {};
}

}  // namespace lambent::demo
