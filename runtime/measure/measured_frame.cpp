#include "runtime/measure/measured_frame.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <glm/geometric.hpp>

#include "runtime/frame/frame.hpp"

namespace lambent::frame {

namespace {

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Returns the passes of frames that all did the same, each with its median times.
std::vector<gpu::PassTime> medians(const std::vector<std::vector<gpu::PassTime>>& frames) {
  std::vector<gpu::PassTime> passes;
  if (frames.empty()) return passes;
  std::map<std::string, std::pair<std::vector<double>, std::vector<double>>> times;
  for (const auto& frame : frames)
    for (const gpu::PassTime& pass : frame) {
      times[pass.name].first.push_back(pass.cpu_ms);
      times[pass.name].second.push_back(pass.gpu_ms);
    }
  passes = frames.back();
  for (gpu::PassTime& pass : passes) {
    auto& [cpu_ms, gpu_ms] = times[pass.name];
    pass.cpu_ms = median(cpu_ms);
    pass.gpu_ms = median(gpu_ms);
  }
  return passes;
}

// Has all samples shaded again after a measurement, however it ends: other frames rely on them.
class Unshaded {
 public:
  explicit Unshaded(World& world) : world_(world) {}
  ~Unshaded() { world_.residency().forgetShading(); }
  Unshaded(const Unshaded&) = delete;
  Unshaded& operator=(const Unshaded&) = delete;

 private:
  World& world_;
};

struct Drawn {
  spec::RgbaImage picture;
  SettingPoint point;
};

Result<Drawn> drawOnce(const MeasuredScene& scene, const FrameSettings& settings,
                       const MeasureOptions& options) {
  const auto& [world, environment, view] = scene;
  const Unshaded unshaded(world);
  Result<Frame> frame = Frame::create({.size = options.size,
                                       .output = Output::Linear,
                                       .settings = settings,
                                       .upload_budget_bytes = 0,  // only what is already resident
                                       .wait_for_captures = true},
                                      environment);
  if (!frame) return failAgain(frame.error());
  if (const auto rested = frame->rest(world, environment); !rested) return failAgain(rested.error());
  if (Result<void> done = frame->render(world, environment, view); !done) return failAgain(done.error());
  Drawn drawn{.picture = frame->readLinear(), .point = {}};
  std::vector<std::vector<gpu::PassTime>> frames;
  for (std::uint32_t i = 0; i < options.repeats; ++i) {
    frame->forget();
    if (Result<void> done = frame->render(world, environment, view); !done) return failAgain(done.error());
    frame->timers().finish();
    frames.push_back(frame->timers().latest());
  }
  drawn.point.passes = medians(frames);
  for (const gpu::PassTime& pass : drawn.point.passes) {
    drawn.point.cpu_ms += pass.cpu_ms;
    drawn.point.gpu_ms += std::max(pass.gpu_ms, 0.0);
  }
  return drawn;
}

Result<Drawn> draw(const MeasuredScene& scene, FrameSettings settings, const SettingRow& row, double value,
                   const MeasureOptions& options) {
  if (Result<void> done = putSetting(row, settings, value); !done) return failAgain(done.error());
  // The number of key lights is a property of the environment, not of the frame.
  std::optional<lighting::Environment> parted;
  if (row.name == "keys") {
    parted = scene.environment;
    parted->setMostKeys(settings.mostKeys());
  }
  Result<Drawn> drawn =
      drawOnce({scene.world, parted ? *parted : scene.environment, scene.view}, settings, options);
  if (drawn) drawn->point.value = value;
  return drawn;
}

}  // namespace

Result<double> relativeRms(const spec::RgbaImage& picture, const spec::RgbaImage& reference) {
  if (picture.width != reference.width || picture.height != reference.height)
    return fail("picture", "is not as large as the one beside it");
  double squares = 0.0, energy = 0.0;
  for (std::size_t i = 0; i < picture.texels.size(); ++i) {
    const glm::vec4 &x = picture.texels[i], &a = reference.texels[i];
    if (!(std::min(x.w, a.w) >= spec::kLeastCoverage)) continue;
    const glm::dvec3 reference_color(a), difference = glm::dvec3(x) - reference_color;
    squares += glm::dot(difference, difference);
    energy += glm::dot(reference_color, reference_color);
  }
  if (!(energy > 0.0) || !std::isfinite(squares))
    return fail("picture", "nothing that is lit stands in it", "turn the camera or the light");
  return std::sqrt(squares / energy);
}

Result<SettingCost> measureSetting(const MeasuredScene& scene, const FrameSettings& settings,
                                   const SettingRow& row, const MeasureOptions& options) {
  if (!row.finest)
    return fail(std::string(row.name), "has no finest value to measure against", "choose a knob of accuracy");
  Result<Drawn> finest = draw(scene, settings, row, *row.finest, options);
  if (!finest) return failAgain(finest.error());
  if (row.get(settings) == *row.finest) return SettingCost{.now = finest->point, .finest = finest->point};
  Result<Drawn> now = draw(scene, settings, row, row.get(settings), options);
  if (!now) return failAgain(now.error());
  const Result<double> error = relativeRms(now->picture, finest->picture);
  if (!error) return failAgain(error.error());
  now->point.error = *error;
  return SettingCost{.now = std::move(now->point), .finest = std::move(finest->point)};
}

}  // namespace lambent::frame
