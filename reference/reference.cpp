#include "reference/reference.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "baker/cache/key.hpp"
#include "baker/import/scene_digest.hpp"
#include "baker/jobs/parallel.hpp"
#include "reference/camera.hpp"
#include "reference/film.hpp"
#include "reference/lights.hpp"
#include "runtime/base/atomic_file.hpp"
#include "runtime/base/process.hpp"
#include "runtime/base/result.hpp"
#include "runtime/bundle/gltf_types.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::baker::reference {

namespace {

// Says beforehand how much memory a picture needs, so that one that is too large is refused before hours of
// tracing, and not ended by the system in the middle. Bytes are those of the whole program.

// A checkpoint is put together beside the samples' sums before it is written; the picture and its coded bytes
// take less, 20 + 20.
constexpr std::uint64_t kBytesOfPixel = 2 * Film::kBytesOfPixel;
// A triangle takes so much with its vertices and Embree's hierarchy, which was measured as 130 on scans of 90
// and 270 thousand triangles.
constexpr std::uint64_t kBytesOfTriangle = 190;
constexpr std::uint64_t kBytesOfAnyScene = 6'000'000;  // Embree itself, threads and constant light

std::string megabytes(std::uint64_t bytes) {
  return fmt::format("{:.0f} MB", 1e-6 * static_cast<double>(bytes));
}

// Returns about the bytes of the scene as it is traced: surfaces and the ray hierarchy, without textures.
std::uint64_t bytesOfTracing(const Scene& scene) {
  std::uint64_t bytes = kBytesOfAnyScene;
  for (const gltf::Node& node : scene.nodes) {
    if (node.mesh < 0) continue;
    for (const ScenePrimitive& primitive : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives)
      bytes += kBytesOfTriangle * (primitive.mesh.indices.size() / 3);
  }
  return bytes;
}

// Fails if `more` bytes beside what the program has now come to more than the options allow. `what` needs
// them, as "a picture of 64 x 64".
Result<void> checkMemory(const Options& options, std::uint64_t more, const std::string& what) {
  const std::uint64_t allowed = options.memory_bytes != 0 ? options.memory_bytes : machineBytes();
  const std::uint64_t needed = residentBytes() + more;
  if (allowed == 0 || needed <= allowed) return {};
  return fail("--max-memory",
              fmt::format("{} takes about {}, and {} {}", what, megabytes(needed), megabytes(allowed),
                          options.memory_bytes != 0 ? "are allowed" : "are in this machine"),
              "ask for a smaller picture, or allow more");
}

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr auto kCheckpointEvery = std::chrono::seconds(10);

double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// Renders the picture pass by pass, and writes a checkpoint every few seconds and when stopped.
Result<void> renderAll(const World& world, Film& film, const fs::path& checkpoint, Progress& progress,
                       const std::stop_token& stop) {
  const std::uint32_t samples = world.options.spp, in_pass = samplesInPass(world);
  const double seconds_before = film.seconds;
  const Clock::time_point begin = Clock::now();
  Clock::time_point saved = begin;
  const auto save = [&]() -> Result<void> {
    film.seconds = seconds_before + secondsSince(begin);
    saved = Clock::now();
    if (checkpoint.empty()) return {};
    return film.save(checkpoint);
  };
  for (std::uint32_t pass = 0; pass < samples; pass += in_pass)
    for (std::uint32_t row = 0; row < film.size().height; row += kRowsAtOnce) {
      const Rows rows{row, std::min(row + kRowsAtOnce, film.size().height)};
      const bool whole = addSamples(world, film, rows, std::min(samples, pass + in_pass), progress, stop);
      if (!whole || Clock::now() - saved > kCheckpointEvery)
        if (auto done = save(); !done) return done;
      if (!whole)
        return checkpoint.empty() ? fail("reference", "stopped")
                                  : fail(checkpoint.string(), "stopped; keeps the samples so far",
                                         "run the same words again to go on");
    }
  film.seconds = seconds_before + secondsSince(begin);
  return {};
}

Result<void> checkOutput(const fs::path& output) {
  if (output.empty()) return {};
  if (output.extension() != ".exr")
    return fail(output.string(), "is not an .exr", "name the picture OUT.exr");
  if (auto file = AtomicFile::open(output); !file) return failAgain(std::move(file.error()));
  return {};
}

void takeUp(Film& film, const fs::path& checkpoint, bool force, Report& report) {
  std::error_code ignored;
  if (checkpoint.empty() || force || !fs::exists(checkpoint, ignored)) return;
  if (film.restore(checkpoint)) {
    report.resumed_samples = film.done(0);
    for (std::uint32_t y = 1; y < film.size().height; ++y)
      report.resumed_samples = std::min(report.resumed_samples, film.done(y));
    return;
  }
  report.notices.push_back(
      checkpoint.string() +
      ": is damaged, or of another version, scene or other words; the picture is begun anew");
}

Result<Report> renderHere(const Scene& scene, const Request& request, const fs::path& output, bool force,
                          Progress& progress, const std::stop_token& stop) {
  const Options& options = request.options;
  if (auto checked = checkOptions(options); !checked) return failAgain(std::move(checked.error()));
  if (auto checked = checkOutput(output); !checked) return failAgain(std::move(checked.error()));
  Report report;
  const std::uint64_t of_picture = std::uint64_t{options.size.width} * options.size.height * kBytesOfPixel;
  const std::string picture = fmt::format("a picture of {} x {}", options.size.width, options.size.height);
  if (auto fits = checkMemory(options, of_picture + bytesOfTracing(scene), picture); !fits)
    return failAgain(std::move(fits.error()));
  // Load the light, and build the scene in world space.
  progress.begin("scene");
  LightCache lights;
  const auto environment =
      lights.environment(request.lights, request.light_factors, options, request.more_light);
  if (!environment) return failAgain(environment.error());
  report.notices = lights.notices();
  const std::vector<spec::LocalLight> shapes = spec::localLights(request.lights, scene.origin);
  const auto traced = TracedScene::build(scene);
  if (!traced) return failAgain(traced.error());
  report.notices.insert(report.notices.end(), (*traced)->notices.begin(), (*traced)->notices.end());
  if (auto fits = checkMemory(options, of_picture, picture); !fits)  // textures and light are there now
    return failAgain(std::move(fits.error()));
  const auto view = viewOf(scene, (*traced)->surfaces, request);
  if (!view) return failAgain(view.error());
  Film film(options.size, digestOf(scene, (*environment)->lights(), shapes, *view, options));
  // Resume an earlier run.
  const fs::path checkpoint = checkpointOf(output);
  takeUp(film, checkpoint, force, report);
  std::uint64_t left = 0;
  for (std::uint32_t y = 0; y < options.size.height; ++y)
    left += std::uint64_t{options.size.width} * (options.spp - film.done(y));
  // Trace the paths.
  progress.begin("paths", left, "samples");
  const World world{**traced, **environment, shapes, EyeRays(*view, options.size), options};
  auto done = renderAll(world, film, checkpoint, progress, stop);
  if (!done) return failAgain(std::move(done.error()));
  report.image = film.image();
  report.rays = film.rays();
  report.seconds = film.seconds;
  report.standard_error = film.standardError();
  if (output.empty()) return report;
  if (auto written = spec::writeExr(output, report.image); !written)
    return failAgain(std::move(written.error()));
  std::error_code ignored;
  fs::remove(checkpoint, ignored);
  return report;
}

}  // namespace

void poseAt(Scene& scene, float time_s) {
  if (scene.animations.empty())
    scene.warnings.emplace_back("It has no animations: it looks the same at all times.");
  gltf::applyAnimations(scene.animations, time_s, scene.nodes);
}

Result<spec::View> viewOf(const Scene& scene, const Surfaces& surfaces, const Request& request) {
  if (request.view) return *request.view;
  return viewOf(scene, surfaces, request.nodes_at_rest.empty() ? scene.nodes : request.nodes_at_rest,
                request.camera, request.options.size.aspect());
}

fs::path checkpointOf(const fs::path& output) {
  if (output.empty()) return {};
  fs::path checkpoint = output;
  checkpoint += ".partial";
  return checkpoint;
}

Result<Report> render(const Scene& scene, const Request& request, const fs::path& output, bool force,
                      Progress& progress, const std::stop_token& stop) {
  Result<Report> report;
  withThreads(request.options.threads,
              [&] { report = renderHere(scene, request, output, force, progress, stop); });
  progress.end();
  return report;
}

std::uint64_t digestOf(const Scene& scene, const spec::DistantLights& lights,
                       const std::vector<spec::LocalLight>& shapes, const spec::View& view,
                       const Options& options) {
  KeyMaker key;
  key.addText(LAMBENT_VERSION " " LAMBENT_ISA).add(sceneDigest(scene));
  key.add(lights.constant).add(std::uint64_t{lights.discs.size()});
  for (const spec::Disc& disc : lights.discs) key.add(disc.direction).add(disc.radius_rad).add(disc.radiance);
  for (const spec::EnvironmentMap& map : lights.environment_maps)
    key.add(map.layout).add(map.image.width).add(map.image.height).addList(map.image.texels);
  for (const spec::LocalLight& shape : shapes) {
    key.add(std::uint64_t{shape.index()});
    if (const auto* sphere = std::get_if<spec::SphereLight>(&shape))
      key.add(sphere->position_ws).add(sphere->radius_m).add(sphere->radiance);
    else if (const auto* disc = std::get_if<spec::DiscLight>(&shape))
      key.add(disc->position_ws).add(disc->normal_ws).add(disc->radius_m).add(disc->radiance);
  }
  key.add(view.view_from_world).add(view.clip_from_view);
  const BandLimit limit = options.band_limit.value_or(BandLimit{.in = 0, .out = {}});
  key.add(options.size.width).add(options.size.height).add(options.spp).add(options.seed);
  key.add(limit.in).add(limit.out.value_or(0)).add(options.rotate_light_deg);
  key.add(options.bounces.has_value()).add(options.bounces.value_or(0));
  return key.key().low;
}

Result<BandLimit> parseBandLimit(std::string_view word) {
  const auto wrong = [&] {
    return fail("--band-limit", fmt::format("\"{}\" is not IN or IN,OUT", word),
                fmt::format("give orders 1 to {}, as 5 or 5,5", sh::kMaxOrder));
  };
  const auto numbers = spec::parseNumbers(word);
  if (!numbers || numbers->size() > 2) return wrong();
  for (const float number : *numbers)
    if (number != static_cast<float>(static_cast<int>(number)) || number < 1.0f ||
        number > static_cast<float>(sh::kMaxOrder))
      return wrong();
  BandLimit limit{.in = static_cast<int>((*numbers)[0]), .out = {}};
  if (numbers->size() == 2) limit.out = static_cast<int>((*numbers)[1]);
  return limit;
}

Result<void> checkOptions(const Options& options) {
  if (options.spp < 1 || options.spp > kMaxSpp)
    return fail("--spp", fmt::format("{} samples a pixel are outside 1..{}", options.spp, kMaxSpp),
                "give 64 for a look, 1024 and more for a reference");
  if (options.size.width < 1 || options.size.height < 1 || options.size.width > spec::kMaxPictureSide ||
      options.size.height > spec::kMaxPictureSide)
    return fail("--size", fmt::format("is outside 1..{}", spec::kMaxPictureSide),
                "give WIDTHxHEIGHT in pixels");
  if (options.band_limit) {
    const auto good = [](int order) { return order >= 1 && order <= sh::kMaxOrder; };
    if (!good(options.band_limit->in) || !good(options.band_limit->out.value_or(1)))
      return fail("--band-limit", fmt::format("is outside 1..{}", sh::kMaxOrder),
                  "give IN or IN,OUT, as 5 or 5,5");
  }
  return {};
}

}  // namespace lambent::baker::reference
