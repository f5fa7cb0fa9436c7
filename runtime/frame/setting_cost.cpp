#include "runtime/frame/setting_cost.hpp"

#include <optional>
#include <string>
#include <utility>

namespace lambent::frame {

namespace {

// Draws values of one row.
class Meter {
 public:
  Meter(World& world, const lighting::Environment& environment, const spec::View& view, const SettingRow& row,
        const SettingOptions& options)
      : world_(world), environment_(environment), view_(view), row_(row), options_(options) {}

  struct Drawn {
    spec::RgbaImage picture;
    SettingPoint point;
  };
  Result<Drawn> draw(FrameSettings settings, double value) const {
    if (Result<void> done = putSetting(row_, settings, value); !done) return failAgain(done.error());
    // This one is the environment's to follow.
    std::optional<lighting::Environment> parted;
    if (row_.name == "keys") {
      parted = environment_;
      parted->setMostKeys(settings.mostKeys());
    }
    Result<MeasuredFrame> measured =
        measureFrame(world_, parted ? *parted : environment_, view_, settings, options_);
    if (!measured) return failAgain(measured.error());
    return Drawn{.picture = std::move(measured->picture),
                 .point = {.value = value,
                           .error = 0.0,
                           .cpu_ms = measured->cost.cpu_ms,
                           .gpu_ms = measured->cost.gpu_ms,
                           .passes = std::move(measured->cost.passes)}};
  }

 private:
  World& world_;
  const lighting::Environment& environment_;
  const spec::View& view_;
  const SettingRow& row_;
  SettingOptions options_;
};

}  // namespace

Result<std::vector<SettingPoint>> sweepSetting(World& world, const lighting::Environment& environment,
                                               const spec::View& view, const FrameSettings& settings,
                                               const SettingRow& row, std::span<const double> values,
                                               const SettingOptions& options) {
  if (!row.finest)
    return fail(std::string(row.name), "has no finest value to measure against", "choose a knob of accuracy");
  const Meter meter(world, environment, view, row, options);
  Result<Meter::Drawn> finest = meter.draw(settings, *row.finest);
  if (!finest) return failAgain(finest.error());
  std::vector<SettingPoint> points;
  for (const double value : values) {
    if (value == *row.finest) {
      points.push_back(finest->point);
      continue;
    }
    Result<Meter::Drawn> drawn = meter.draw(settings, value);
    if (!drawn) return failAgain(drawn.error());
    const Result<double> error = relativeRms(drawn->picture, finest->picture);
    if (!error) return failAgain(error.error());
    drawn->point.error = *error;
    points.push_back(std::move(drawn->point));
  }
  return points;
}

Result<SettingCost> measureSetting(World& world, const lighting::Environment& environment,
                                   const spec::View& view, const FrameSettings& settings,
                                   const SettingRow& row, const SettingOptions& options) {
  const std::vector<double> values = {row.get(settings), row.finest.value_or(0.0)};
  Result<std::vector<SettingPoint>> points =
      sweepSetting(world, environment, view, settings, row, values, options);
  if (!points) return failAgain(points.error());
  return SettingCost{.now = std::move(points->front()), .finest = std::move(points->back())};
}

}  // namespace lambent::frame
