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

}  // namespace

double FrameCost::milliseconds(std::string_view pass) const {
  for (const gpu::PassTime& time : passes)
    if (time.name == pass) return time.gpu_ms > 0.0 ? time.gpu_ms : time.cpu_ms;
  return 0.0;
}

Result<MeasuredFrame> measureFrame(const MeasuredScene& scene, const FrameSettings& settings,
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
  MeasuredFrame measured{.picture = frame->readLinear(), .cost = {}};
  std::vector<std::vector<gpu::PassTime>> frames;
  for (std::uint32_t i = 0; i < options.repeats; ++i) {
    frame->forget();
    if (Result<void> done = frame->render(world, environment, view); !done) return failAgain(done.error());
    frame->timers().finish();
    frames.push_back(frame->timers().latest());
  }
  measured.cost.passes = medians(frames);
  for (const gpu::PassTime& pass : measured.cost.passes) {
    measured.cost.cpu_ms += pass.cpu_ms;
    measured.cost.gpu_ms += std::max(pass.gpu_ms, 0.0);
  }
  return measured;
}

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

namespace {

struct Drawn {
  spec::RgbaImage picture;
  SettingPoint point;
};

Result<Drawn> draw(const MeasuredScene& scene, FrameSettings settings, const SettingRow& row, double value,
                   const MeasureOptions& options) {
  if (Result<void> done = putSetting(row, settings, value); !done) return failAgain(done.error());
  // The number of key lights is a property of the environment, not of the frame.
  std::optional<lighting::Environment> parted;
  if (row.name == "keys") {
    parted = scene.environment;
    parted->setMostKeys(settings.mostKeys());
  }
  Result<MeasuredFrame> measured =
      measureFrame({scene.world, parted ? *parted : scene.environment, scene.view}, settings, options);
  if (!measured) return failAgain(measured.error());
  return Drawn{.picture = std::move(measured->picture), .point = {std::move(measured->cost), value, 0.0}};
}

}  // namespace

Result<std::vector<SettingPoint>> sweepSetting(const MeasuredScene& scene, const FrameSettings& settings,
                                               const SettingRow& row, std::span<const double> values,
                                               const MeasureOptions& options) {
  if (!row.finest)
    return fail(std::string(row.name), "has no finest value to measure against", "choose a knob of accuracy");
  Result<Drawn> finest = draw(scene, settings, row, *row.finest, options);
  if (!finest) return failAgain(finest.error());
  std::vector<SettingPoint> points;
  for (const double value : values) {
    if (value == *row.finest) {
      points.push_back(finest->point);
      continue;
    }
    Result<Drawn> drawn = draw(scene, settings, row, value, options);
    if (!drawn) return failAgain(drawn.error());
    const Result<double> error = relativeRms(drawn->picture, finest->picture);
    if (!error) return failAgain(error.error());
    drawn->point.error = *error;
    points.push_back(std::move(drawn->point));
  }
  return points;
}

Result<SettingCost> measureSetting(const MeasuredScene& scene, const FrameSettings& settings,
                                   const SettingRow& row, const MeasureOptions& options) {
  const std::vector<double> values = {row.get(settings), row.finest.value_or(0.0)};
  Result<std::vector<SettingPoint>> points = sweepSetting(scene, settings, row, values, options);
  if (!points) return failAgain(points.error());
  return SettingCost{.now = std::move(points->front()), .finest = std::move(points->back())};
}

}  // namespace lambent::frame
