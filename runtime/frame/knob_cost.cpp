#include "runtime/frame/knob_cost.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include <glm/geometric.hpp>

#include "runtime/frame/frame.hpp"

namespace lambent::frame {

namespace {

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Passes of some frames that all did the same, each with its median times.
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

struct Drawn {
  spec::RgbaImage picture;
  KnobPoint point;
};

class Meter {
 public:
  Meter(World& world, const lighting::Environment& environment, const spec::View& view, const SettingRow& row,
        const KnobOptions& options)
      : world_(world), environment_(environment), view_(view), row_(row), options_(options) {}
  // Whatever came of it, the samples are no other frame's any more.
  ~Meter() { world_.residency().forgetShading(); }
  Meter(const Meter&) = delete;
  Meter& operator=(const Meter&) = delete;

  Result<Drawn> draw(FrameSettings settings, double value) const {
    if (Result<void> done = putSetting(row_, settings, value); !done) return failAgain(done.error());
    Result<Frame> frame = Frame::create({.size = options_.size,
                                         .output = Output::Linear,
                                         .settings = settings,
                                         .upload_budget_bytes = 0,  // what is resident, no more
                                         .wait_for_captures = true},
                                        environment_);
    if (!frame) return failAgain(frame.error());
    if (const auto rested = frame->rest(world_, environment_); !rested) return failAgain(rested.error());
    if (Result<void> done = frame->render(world_, environment_, view_); !done) return failAgain(done.error());
    Drawn drawn{.picture = frame->readLinear(), .point = {.value = value}};
    std::vector<std::vector<gpu::PassTime>> frames;
    for (std::uint32_t i = 0; i < options_.repeats; ++i) {
      frame->forget();
      if (Result<void> done = frame->render(world_, environment_, view_); !done)
        return failAgain(done.error());
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

 private:
  World& world_;
  const lighting::Environment& environment_;
  const spec::View& view_;
  const SettingRow& row_;
  KnobOptions options_;
};

}  // namespace

Result<double> relativeRms(const spec::RgbaImage& picture, const spec::RgbaImage& reference) {
  if (picture.width != reference.width || picture.height != reference.height)
    return fail("knob", "its pictures differ in size");
  double squares = 0.0, energy = 0.0;
  for (std::size_t i = 0; i < picture.texels.size(); ++i) {
    const glm::vec4 &x = picture.texels[i], &a = reference.texels[i];
    if (!(std::min(x.w, a.w) >= spec::kLeastCoverage)) continue;
    const glm::dvec3 reference_color(a), difference = glm::dvec3(x) - reference_color;
    squares += glm::dot(difference, difference);
    energy += glm::dot(reference_color, reference_color);
  }
  if (!(energy > 0.0) || !std::isfinite(squares))
    return fail("knob", "nothing that is lit stands in the picture", "turn the camera or the light");
  return std::sqrt(squares / energy);
}

Result<std::vector<KnobPoint>> sweepKnob(World& world, const lighting::Environment& environment,
                                         const spec::View& view, const FrameSettings& settings,
                                         const SettingRow& row, std::span<const double> values,
                                         const KnobOptions& options) {
  if (!row.finest)
    return fail(std::string(row.name), "has no finest value to measure against", "choose a knob of accuracy");
  const Meter meter(world, environment, view, row, options);
  Result<Drawn> finest = meter.draw(settings, *row.finest);
  if (!finest) return failAgain(finest.error());
  std::vector<KnobPoint> points;
  for (const double value : values) {
    if (value == *row.finest) {
      points.push_back(finest->point);
      continue;
    }
    Result<Drawn> drawn = meter.draw(settings, value);
    if (!drawn) return failAgain(drawn.error());
    const Result<double> error = relativeRms(drawn->picture, finest->picture);
    if (!error) return failAgain(error.error());
    drawn->point.error = *error;
    points.push_back(std::move(drawn->point));
  }
  return points;
}

Result<KnobCost> measureKnob(World& world, const lighting::Environment& environment, const spec::View& view,
                             const FrameSettings& settings, const SettingRow& row,
                             const KnobOptions& options) {
  const std::vector<double> values = {row.get(settings), row.finest.value_or(0.0)};
  Result<std::vector<KnobPoint>> points = sweepKnob(world, environment, view, settings, row, values, options);
  if (!points) return failAgain(points.error());
  return KnobCost{.now = std::move(points->front()), .finest = std::move(points->back())};
}

}  // namespace lambent::frame
