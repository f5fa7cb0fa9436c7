// Measures the time and the error of a frame's settings in a scene: each setting of accuracy runs over its
// values, in the scene's own view.
//   setting_sweep BUNDLE SETTING [LIGHT...]
// SETTING is a name in lambent-demo's --help, or all. Prints a row per value: relative RMS error against the
// finest, then CPU and GPU milliseconds of a frame in which every pass has to run.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "runtime/gpu/context.hpp"
#include "runtime/measure/setting_cost.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/scene/lights.hpp"
#include "runtime/spec/light.hpp"

namespace {

using namespace lambent;

constexpr spec::Size kSize{320, 180};

// Returns all values of switches, choices and small whole numbers, and otherwise values a factor of two
// apart.
std::vector<double> valuesOf(const frame::SettingRow& row) {
  using Kind = frame::SettingRow::Kind;
  std::vector<double> values;
  if (row.kind == Kind::Switch) return {0.0, 1.0};
  const bool by_one = row.kind == Kind::Choice || row.greatest <= 8.0;
  if (by_one && row.kind != Kind::Real) {
    for (double value = row.least; value <= row.greatest; value += 1.0) values.push_back(value);
  } else {
    for (double value = row.least; value <= row.greatest; value *= 2.0) values.push_back(value);
  }
  return values;
}

int failed(const Error& error) {
  std::fprintf(stderr, "knobs: %s\n", error.line().c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3)
    return failed({.subject = "usage", .problem = "too few words", .hint = "knobs BUNDLE KNOB [LIGHT...]"});
  const std::string wanted = argv[2];
  std::vector<std::string> words(argv + 3, argv + argc);
  if (words.empty()) words.assign(spec::kDefaultLights.begin(), spec::kDefaultLights.end());
  const Result<std::vector<spec::Light>> lights = spec::parseLights(words);
  if (!lights) return failed(lights.error());
  Result<lighting::Environment> environment = lighting::Environment::create(*lights);
  if (!environment) return failed(environment.error());
  const Result<gpu::Context> context = gpu::Context::createHeadless();
  if (!context) return failed(context.error());
  frame::World world;
  if (const Result<std::uint32_t> opened = world.open(argv[1]); !opened) return failed(opened.error());
  gpu::Counters counters;
  if (const Result<void> loaded = world.uploadAll(counters); !loaded) return failed(loaded.error());
  scene::addLights(world.registry(), *lights);
  world.updateTransforms();
  const scene::Box bounds = scene::worldBounds(world.registry());
  const spec::View view = spec::orbitView({}, bounds.min, bounds.max, kSize.aspect());

  std::printf("%s, %s\n%-20s %8s %10s %10s %10s\n", argv[1], context->info().renderer.c_str(), "knob",
              "value", "error %", "CPU ms", "GPU ms");
  for (const frame::SettingRow& row : frame::settingRows()) {
    if (!row.finest || (wanted != "all" && wanted != row.name)) continue;
    const auto points = frame::sweepSetting({world, *environment, view}, {}, row, valuesOf(row),
                                            {.size = kSize, .repeats = 3});
    if (!points) return failed(points.error());
    for (const frame::SettingPoint& point : *points)
      std::printf("%-20s %8g %10.3f %10.2f %10.2f\n", std::string(row.name).c_str(), point.value,
                  100.0 * point.error, point.cpu_ms, point.gpu_ms);
    std::fflush(stdout);
  }
  return 0;
}
