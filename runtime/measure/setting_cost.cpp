#include "runtime/measure/setting_cost.hpp"

#include <optional>
#include <string>
#include <utility>

namespace lambent::frame {

namespace {

struct Drawn {
  spec::RgbaImage picture;
  SettingPoint point;
};

Result<Drawn> draw(const MeasuredScene& scene, FrameSettings settings, const SettingRow& row, double value,
                   const SettingOptions& options) {
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
  return Drawn{.picture = std::move(measured->picture),
               .point = {.value = value,
                         .error = 0.0,
                         .cpu_ms = measured->cost.cpu_ms,
                         .gpu_ms = measured->cost.gpu_ms,
                         .passes = std::move(measured->cost.passes)}};
}

}  // namespace

Result<std::vector<SettingPoint>> sweepSetting(const MeasuredScene& scene, const FrameSettings& settings,
                                               const SettingRow& row, std::span<const double> values,
                                               const SettingOptions& options) {
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
                                   const SettingRow& row, const SettingOptions& options) {
  const std::vector<double> values = {row.get(settings), row.finest.value_or(0.0)};
  Result<std::vector<SettingPoint>> points = sweepSetting(scene, settings, row, values, options);
  if (!points) return failAgain(points.error());
  return SettingCost{.now = std::move(points->front()), .finest = std::move(points->back())};
}

}  // namespace lambent::frame
