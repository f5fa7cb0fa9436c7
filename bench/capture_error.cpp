// Measures the time and the error of cube maps of light: it makes the table of docs/design/captures.md
// through the real GPU path. Discs are bodies: a polygon of 256 corners that faces its point is drawn,
// resolved and projected like any other body; the truth is the disc's closed form. Environment maps go
// through the sky's texels, at random rotations; the truth is the picture projected texel by texel and
// rotated. The error is |c - c_exact|² / |c_exact|².
//   capture_error [--directions N] [--probes DIR]
// DIR of --probes is a folder of environment maps. Prints the table as markdown.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <glm/gtc/quaternion.hpp>

#include "runtime/gpu/context.hpp"
#include "runtime/lighting/capture.hpp"
#include "runtime/sh/rotation.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/runtime/lighting/capture_scenes.hpp"

namespace {

using namespace lambent;
using namespace lambent::lighting;
using Clock = std::chrono::steady_clock;

constexpr std::uint32_t kSizes[] = {4, 8, 16, 32, 64};
constexpr int kLeastOrder = 3, kMostOrder = 6;
constexpr double kRadiiDeg[] = {5, 10, 20, 40};

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct Row {
  std::string light;
  std::uint32_t size = 0;
  int order = 0;
  std::size_t count = 0;
  double average = 0, worst = 0, milliseconds = 0;  // milliseconds of one cube map

  void add(double error) {
    ++count;
    average += (error - average) / static_cast<double>(count);
    worst = std::max(worst, error);
  }
};

template <typename T>
T must(Result<T> result) {
  if (!result) {
    std::fprintf(stderr, "capture_error: %s\n", result.error().line().c_str());
    std::exit(1);
  }
  return std::move(*result);
}

Environment darkness() {
  return must(Environment::create({spec::ConstantLight{glm::vec3(0.0f)}}));
}

glm::vec3 randomDirection(std::mt19937& random) {
  std::normal_distribution<float> normal;
  for (;;) {
    const glm::vec3 v(normal(random), normal(random), normal(random));
    if (glm::length(v) > 0.1f) return glm::normalize(v);
  }
}

// Adds a row for each order; lower orders have the same coefficients, only fewer.
std::span<Row> addRows(const std::string& light, std::uint32_t size, std::vector<Row>& rows) {
  const std::size_t first = rows.size();
  for (int order = kLeastOrder; order <= kMostOrder; ++order)
    rows.push_back({.light = light, .size = size, .order = order});
  return std::span(rows).subspan(first);
}

void addErrors(const sh::LightVector& captured, const sh::LightVector& exact, double milliseconds,
               std::span<Row> rows) {
  for (Row& row : rows) {
    row.add(testing::squaredError(captured.truncated(row.order), exact.truncated(row.order)));
    row.milliseconds += (milliseconds - row.milliseconds) / static_cast<double>(row.count);
  }
}

// Points are so far apart that none sees another's disc; each is 1 m from its own.
void discErrors(std::uint32_t size, double radius_deg, int directions, std::vector<Row>& rows) {
  const std::span<Row> own =
      addRows("disc " + std::to_string(static_cast<int>(radius_deg)) + "°", size, rows);
  const double radius = radius_deg * std::numbers::pi / 180;
  const Environment dark = darkness();
  Capture capture = must(Capture::create({.size = size, .order = kMostOrder}, dark));
  gpu::Counters counters;
  const bundle::CaptureProxy disc = testing::discProxy();
  const bundle::CaptureProxy* const proxies[] = {&disc};
  capture.setProxies(proxies, counters);
  const std::vector<glm::vec4> shining(capture.triangleCount(), glm::vec4(1.0f));
  gpu::Buffer radiance("radiance", shining.size() * sizeof(glm::vec4));
  radiance.write(0, std::span<const glm::vec4>(shining));
  std::mt19937 random(2002);
  constexpr int kAtOnce = 8;
  for (int first = 0; first < directions; first += kAtOnce) {
    std::vector<CaptureBody> bodies;
    std::vector<CapturePoint> points;
    std::vector<glm::vec3> towards;
    for (int i = 0; i < std::min(kAtOnce, directions - first); ++i) {
      towards.push_back(randomDirection(random));
      points.push_back({.position_ws = 256.0f * glm::vec3(i & 1, i >> 1 & 1, i >> 2)});
      bodies.push_back(testing::discBody(0, points.back().position_ws, towards.back(), radius, 1.0f));
      // All discs are bright enough to be measured; those of other points, 256 m away, must not appear.
      bodies.back().brightness = size < 8 ? 8.0f : 1.0f;
    }
    const auto start = Clock::now();
    const auto run = capture.run(dark, bodies, points, radiance, counters);
    if (!run) must<int>(tl::unexpected(run.error()));
    const std::vector<CapturedLight> lights = *capture.take(true);
    const double milliseconds = millisecondsSince(start) / static_cast<double>(points.size());
    for (std::size_t i = 0; i < lights.size(); ++i)
      addErrors(lights[i].light, sh::discLight(kMostOrder, towards[i], radius, glm::vec3(1.0f)), milliseconds,
                own);
  }
}

void probeErrors(const std::filesystem::path& file, int directions, std::vector<Row>& rows) {
  const Environment environment = must(Environment::create({spec::EnvironmentMapLight{file, std::nullopt}}));
  const sh::LightVector exact = environment.light();
  for (const std::uint32_t size : kSizes) {
    Capture capture = must(Capture::create({.size = size}, environment));
    const std::span<Row> own = addRows(file.filename().string(), size, rows);
    // Larger cubes hardly depend on the rotation of the environment map, and take long.
    const int turns = std::max(20, directions * 256 / std::max(256, static_cast<int>(size * size)));
    std::mt19937 random(2002);
    std::normal_distribution<double> normal;
    for (int i = 0; i < turns; ++i) {
      const glm::dquat turn =
          glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
      const auto start = Clock::now();
      const sh::LightVector captured = capture.skyThroughTexels(environment, glm::mat3(glm::mat3_cast(turn)));
      const double milliseconds = millisecondsSince(start);
      addErrors(captured, sh::Rotation(turn, exact.order).apply(exact), milliseconds, own);
    }
  }
}

void printTable(const std::vector<Row>& rows, int order) {
  std::printf("\nOrder %d; average / worst squared error in %%, and ms for a cube map:\n\n| light |", order);
  for (const std::uint32_t size : kSizes) std::printf(" 6x%ux%u | ms |", size, size);
  std::printf("\n|---|");
  for (std::size_t i = 0; i < std::size(kSizes); ++i) std::printf("---|---|");
  std::vector<std::string> lights;
  for (const Row& row : rows)
    if (std::find(lights.begin(), lights.end(), row.light) == lights.end()) lights.push_back(row.light);
  for (const std::string& light : lights) {
    std::printf("\n| %s |", light.c_str());
    for (const std::uint32_t size : kSizes)
      for (const Row& row : rows)
        if (row.light == light && row.size == size && row.order == order)
          std::printf(" %.2g / %.2g | %.2f |", 100 * row.average, 100 * row.worst, row.milliseconds);
  }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  int directions = 500;
  std::filesystem::path environment_maps;
  CLI::App app("Measures the time and the error of cube maps of light.");
  app.add_option("--directions", directions)->check(CLI::PositiveNumber);
  app.add_option("--probes", environment_maps);
  CLI11_PARSE(app, argc, argv);
  const gpu::Context context = must(gpu::Context::createHeadless());
  std::printf("%s\n", context.info().renderer.c_str());
  std::vector<Row> rows;
  for (const double radius : kRadiiDeg)
    for (const std::uint32_t size : kSizes) discErrors(size, radius, directions, rows);
  if (!environment_maps.empty()) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(environment_maps))
      if (entry.path().extension() == ".hdr" || entry.path().extension() == ".exr")
        files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const auto& file : files) probeErrors(file, directions, rows);
  }
  for (int order = kMostOrder; order >= kLeastOrder; --order) printTable(rows, order);
  std::printf("\nSloan 2002, 6x16x16: average 0.2 %%, worst 0.5 %%.\n");
  return 0;
}
