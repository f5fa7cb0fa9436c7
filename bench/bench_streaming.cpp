// Measures frames of a flight along many bundles that need more memory than there is: bench_streaming
// FOLDER|BUNDLE... [--share S] [--copies N] [--frames N] [--size WxH] [--light LIGHT]. It opens
// every bundle N times, side by side along X, and flies past them twice: with enough memory and everything
// loaded, then streaming with a share S of that memory. For both flights it prints how long frames took
// (median, worst, how many took over twice the median, and a histogram), what was resident, and how bundles
// were shown. Frame times are wall time until the GPU is done, and the CPU time of all threads, which shows
// the cost of a frame if others use the machine too.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>

#include "runtime/frame/frame.hpp"
#include "runtime/gpu/context.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/spec/light.hpp"
#include "runtime/world/frame_times.hpp"

namespace {

using namespace lambent;

struct Words {
  std::vector<std::filesystem::path> bundles;
  double share = 1.0 / 3.0;
  int copies = 1, frames = 300;
  spec::Size size;
  std::string light = "constant:1,1,1";
};

void stop(const Error& error) {
  fmt::print(stderr, "bench_streaming: {}\n", error.line());
  std::exit(1);
}

// Folders stand for the bundles in them.
std::vector<std::filesystem::path> bundlesOf(const std::vector<std::filesystem::path>& places) {
  std::vector<std::filesystem::path> bundles;
  for (const std::filesystem::path& place : places) {
    if (!std::filesystem::is_directory(place)) {
      bundles.push_back(place);
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(place))
      if (entry.path().string().ends_with(".lmb.glb")) bundles.push_back(entry.path());
  }
  std::ranges::sort(bundles);
  if (bundles.empty()) stop({"FOLDER", "names no bundle", "give .lmb.glb files or a folder of them"});
  return bundles;
}

struct Row {
  frame::World world;
  float apart = 0.0f, length = 0.0f, height = 0.0f;

  Row(const Words& words, const frame::WorldOptions& options) : world(options) {
    float at = 0.0f;
    for (int copy = 0; copy < words.copies; ++copy)
      for (const std::filesystem::path& path : words.bundles) {
        const Result<std::uint32_t> slot = world.open(path);
        if (!slot) stop(slot.error());
        scene::Box box;
        for (const ecs::Entity group : world.instance(*slot).groups)
          box.add(scene::groupBounds(world.registry(), group));
        const float radius = box.empty() ? 1.0f : box.radius();
        // Bundles stand side by side, with their centres on the X axis.
        at += radius;
        auto& root = world.registry().edit<scene::Transform>(world.instance(*slot).root);
        root.translation = glm::vec3(at, 0.0f, 0.0f) - (box.empty() ? glm::vec3(0.0f) : box.center());
        at += radius;
        apart = std::max(apart, radius);
      }
    length = at;
    world.updateTransforms();
  }
  spec::View view(float share, float aspect) const {
    const glm::vec3 eye(share * length, 0.4f * apart, 1.6f * apart);
    const glm::vec3 ahead = eye + glm::vec3(1.0f, -0.3f, -0.9f);
    return {.view_from_world = glm::lookAt(eye, ahead, glm::vec3(0, 1, 0)),
            .clip_from_view = glm::perspective(0.9f, aspect, 0.02f * apart, 100.0f * apart),
            .eye_ws = eye};
  }
};

struct Flight {
  frame::FrameTimes times, cpu_times;
  std::array<std::size_t, 4> shown{};  // number of bundles, summed over frames, by frame::Shown
  std::uint64_t most_bytes = 0, least_bytes = ~std::uint64_t{0}, uploaded = 0;
  std::size_t brought = 0;  // number of frames that uploaded something
  // One entry per pass: milliseconds of the CPU in each frame that had it.
  std::map<std::string, frame::FrameTimes> passes{};
};

Flight fly(const Words& words, Row& row, lighting::Environment& environment, bool load_first) {
  frame::FrameOptions options;
  options.size = words.size;
  Result<frame::Frame> frame = frame::Frame::create(options, environment);
  if (!frame) stop(frame.error());
  const float aspect = words.size.aspect();
  const auto render = [&](float share) {
    const Result<void> done = frame->render(row.world, environment, row.view(share, aspect));
    if (!done) stop(done.error());
    glFinish();
  };
  if (load_first) {
    gpu::Counters counters;
    if (const Result<void> done = row.world.uploadAll(counters); !done) stop(done.error());
  }
  // These frames compile programs and load what is visible at the start.
  for (int i = 0; i < 2000 && (i < 30 || !row.world.loaded()); ++i) render(0.0f);
  const frame::FrameTimes empty(static_cast<std::size_t>(words.frames));
  Flight flight{.times = empty, .cpu_times = empty};
  for (int i = 0; i < words.frames; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpu_start = std::clock();
    render(static_cast<float>(i) / static_cast<float>(words.frames - 1));
    const auto end = std::chrono::steady_clock::now();
    const double wall_ms = std::chrono::duration<double, std::milli>(end - start).count();
    flight.times.add(wall_ms);
    flight.cpu_times.add(1e3 * static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC);
    const frame::StreamingStatus status = row.world.streaming();
    const std::uint64_t bytes = status.resident_bytes;
    for (const frame::BundleStreaming& bundle : status.bundles)
      ++flight.shown[static_cast<std::size_t>(bundle.shown)];
    flight.most_bytes = std::max(flight.most_bytes, bytes);
    flight.least_bytes = std::min(flight.least_bytes, bytes);
    frame->timers().finish();
    for (const gpu::PassTime& pass : frame->timers().latest()) {
      flight.passes.try_emplace(pass.name, empty).first->second.add(pass.cpu_ms);
      if (pass.name == "upload") {
        flight.uploaded += pass.counters.uploaded_bytes;
        flight.brought += pass.counters.uploaded_bytes > 0 ? 1u : 0u;
      }
    }
  }
  for (const frame::BundleError& wrong : row.world.errors()) stop(wrong.error);
  return flight;
}

void print(const char* kind, const frame::FrameTimes& times) {
  fmt::print(
      "  {}: median {:.1f} ms, 95 % under {:.1f} ms, worst {:.1f} ms ({:.2f} x), over twice the median: {} "
      "of {}\n",
      kind, times.median(), times.quantile(0.95), times.worst(), times.worst() / times.median(),
      times.overTwiceMedian(), times.count());
  const std::vector<std::size_t> bins = times.histogram(12);
  for (std::size_t i = 0; i < bins.size(); ++i)
    fmt::print("    {:.2f}{} x {:5} {}\n", 0.25 * static_cast<double>(i), i + 1 == bins.size() ? "+" : " ",
               bins[i], std::string((bins[i] * 60 + times.count() - 1) / times.count(), '#'));
}

void print(const std::string& name, const Flight& flight) {
  constexpr double kMegabyte = 1e6;
  fmt::print("{}: resident {:.1f} to {:.1f} MB, brought {:.1f} MB in {} frames\n", name,
             static_cast<double>(flight.least_bytes) / kMegabyte,
             static_cast<double>(flight.most_bytes) / kMegabyte,
             static_cast<double>(flight.uploaded) / kMegabyte, flight.brought);
  double all = 0.0;
  for (const std::size_t shown : flight.shown) all += static_cast<double>(shown);
  const auto percent = [&](frame::Shown shown) {
    return 100.0 * static_cast<double>(flight.shown[static_cast<std::size_t>(shown)]) / all;
  };
  fmt::print(
      "  bundles shown in full {:.1f} %, partly {:.1f} %, by proxy levels of detail {:.1f} %, not {:.1f} %\n",
      percent(frame::Shown::Full), percent(frame::Shown::Partly), percent(frame::Shown::ProxyLod),
      percent(frame::Shown::Nothing));
  print("wall", flight.times);
  print("CPU of all threads", flight.cpu_times);
  for (const auto& [pass, times] : flight.passes)
    fmt::print("  CPU of {}: median {:.2f} ms, 95 % under {:.2f} ms, worst {:.2f} ms\n", pass, times.median(),
               times.quantile(0.95), times.worst());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  Words words;
  std::string size = "640x360";
  CLI::App app("Measures frames of a flight along bundles that need more memory than there is.");
  app.add_option("BUNDLE", words.bundles)->required();
  app.add_option("--share", words.share);
  app.add_option("--copies", words.copies)->check(CLI::PositiveNumber);
  app.add_option("--frames", words.frames)->check(CLI::Range(2, 1'000'000));
  app.add_option("--size", size);
  app.add_option("--light", words.light);
  CLI11_PARSE(app, argc, argv);
  words.bundles = bundlesOf(words.bundles);
  const Result<spec::Size> parsed = spec::parseSize(size);
  if (!parsed) stop(parsed.error());
  words.size = *parsed;
  Result<gpu::Context> context = gpu::Context::createHeadless();
  if (!context) stop(context.error());
  const Result<spec::Light> light = spec::parseLight(words.light);
  if (!light) stop(light.error());
  Result<lighting::Environment> environment = lighting::Environment::create({*light});
  if (!environment) stop(environment.error());
  fmt::print("{}, {} x {}, {} bundles\n", context->info().renderer, words.size.width, words.size.height,
             words.bundles.size() * static_cast<std::size_t>(words.copies));
  std::uint64_t whole_bytes = 0;
  {
    Row row(words, {});
    const Flight flight = fly(words, row, *environment, /*load_first=*/true);
    whole_bytes = flight.most_bytes;
    print("all resident", flight);
  }
  const auto budget = static_cast<std::uint64_t>(words.share * static_cast<double>(whole_bytes));
  Row row(words, {.max_resident_bytes = budget});
  const Flight flight = fly(words, row, *environment, /*load_first=*/false);
  print(fmt::format("streaming into {:.1f} MB", static_cast<double>(budget) / 1e6), flight);
  return 0;
}
