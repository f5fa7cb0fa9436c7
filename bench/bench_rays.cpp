// Measures pass 0 against its limit: rays per second of the baker's direct pass beside a bare Embree loop
// over the same rays, in one run, on one thread. The bare loop times only the calls: its packets are filled
// beforehand, a few samples at a time so that they stay in cache.
//   bench_rays [--scene=FILE.glb] [--benchmark_...]; the default scene is the shipped gallery.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <glm/geometric.hpp>

#include "baker/embree/embree.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/samples.hpp"
#include "bench/group_workload.hpp"

namespace {

using namespace lambent;
using namespace lambent::baker;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kRays = 512;  // 1024 directions over the whole sphere
// 8 x 32 packets x 832 bytes take half of a 512 KiB second-level cache.
constexpr std::size_t kSamplesAtATime = 8;

struct Workload {
  std::unique_ptr<GroupWorkload> group;
  RTCDevice device = nullptr;  // of the bare scene; lives as long as the program
  RTCScene scene = nullptr;
};

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Builds a scene of one triangle geometry with the flags that were found fastest (quality HIGH).
void buildBareScene(Workload& work) {
  work.device = rtcNewDevice(nullptr);
  work.scene = rtcNewScene(work.device);
  rtcSetSceneBuildQuality(work.scene, RTC_BUILD_QUALITY_HIGH);
  const auto& g = work.group->geometry;
  RTCGeometry geometry =
      newTriangles(work.device, g.positions, static_cast<std::uint32_t>(g.triangles.size()),
                   [&](std::uint32_t t) { return g.triangles[t]; });
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(work.scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(work.scene);
}

struct FilledPacket {
  alignas(64) RTCRay16 ray;
  PacketLanes lanes;
};

std::uint64_t traceBare(const Workload& work, std::vector<FilledPacket>& packets) {
  RayQuery query(RayOrder::Incoherent);
  std::uint64_t rays = 0;
  for (FilledPacket& packet : packets) {
    query.occluded(work.scene, packet.lanes.valid.data(), packet.ray);
    for (const int valid : packet.lanes.valid) rays += valid != 0;
  }
  return rays;
}

struct Timed {
  std::uint64_t rays = 0;
  double seconds = 0.0;
  double perSecond() const { return static_cast<double>(rays) / seconds; }
};

// Times every eighth run of samples over the whole scene, which is enough rays to be representative.
Timed runBare(const Workload& work, const DirectionTable& table) {
  Timed timed;
  std::vector<FilledPacket> packets;
  const SampleSet& samples = work.group->samples;
  for (std::size_t first = 0; first < samples.size(); first += kSamplesAtATime * 8) {
    packets.clear();
    for (std::size_t s = first; s < std::min(first + kSamplesAtATime, samples.size()); ++s) {
      const auto origins = samples.originsOf(s);
      if (origins.empty()) continue;
      const glm::mat3 frame(localFrame(glm::normalize(glm::dvec3(samples.normals[s]))));
      const OriginDealer dealer(origins);
      for (std::size_t p = 0; p < table.packets(); ++p) {
        packets.emplace_back();
        fillPacket(p, {origins, frame, table}, dealer, packets.back().ray, packets.back().lanes);
      }
    }
    const auto start = Clock::now();
    timed.rays += traceBare(work, packets);
    timed.seconds += secondsSince(start);
  }
  return timed;
}

Timed runPass(const Workload& work) {
  Progress progress;
  const auto start = Clock::now();
  const auto direct = bakeDirect(DirectPass(work.group->view(), {.order = 5, .rays = kRays}), {progress});
  return {direct->of(SurfacePart::Matte).rays, secondsSince(start)};
}

void report(benchmark::State& state, const Timed& timed) {
  state.SetIterationTime(timed.seconds);
  state.counters["Mrays/s"] = 1e-6 * timed.perSecond();
}

// Returns the seconds of the first gather pass over those of the direct pass with hits kept, in one run.
double bounceRatio(const Workload& work) {
  const DirectPass pass(work.group->view(),
                        {.order = 5, .rays = kRays, .keep_hits = true, .hit_memory = std::size_t{4} << 30});
  Progress progress;
  const auto start = Clock::now();
  auto direct = bakeDirect(pass, {progress});
  const double direct_seconds = secondsSince(start);
  const auto bounce_start = Clock::now();
  bakeBounces({pass, *direct}, {.bounces = 1}, {progress});
  return secondsSince(bounce_start) / direct_seconds;
}

// Takes `--scene=FILE` out of the arguments before Google Benchmark sees them.
std::string takeSceneArgument(int& argc, char** argv) {
  std::string file = LAMBENT_BINARY_DIR "/assets/gallery.glb";
  for (int i = 1; i < argc; ++i)
    if (std::strncmp(argv[i], "--scene=", 8) == 0) {
      file = argv[i] + 8;
      std::rotate(argv + i, argv + i + 1, argv + argc);
      --argc;
    }
  return file;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string file = takeSceneArgument(argc, argv);
  benchmark::Initialize(&argc, argv);
  static Workload work{loadGroup(file)};
  buildBareScene(work);
  static const DirectionTable table = cosineTable(kRays);
  benchmark::RegisterBenchmark("bare/occluded16_incoherent",
                               [](benchmark::State& state) {
                                 for (auto _ : state) report(state, runBare(work, table));
                               })
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
  // The ratio is taken pass by pass in turn, so that a machine whose speed drifts does not spoil it.
  benchmark::RegisterBenchmark("pass0/against_occluded16_incoherent",
                               [](benchmark::State& state) {
                                 double ratios = 0.0;
                                 for (auto _ : state) {
                                   withThreads(1, [&] {
                                     const double limit = runBare(work, table).perSecond();
                                     const Timed pass = runPass(work);
                                     report(state, pass);
                                     ratios += pass.perSecond() / limit;
                                   });
                                 }
                                 state.counters["ratio"] = ratios / static_cast<double>(state.iterations());
                               })
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond)
      ->Iterations(5);
  benchmark::RegisterBenchmark("bounce/against_pass0_with_hits",
                               [](benchmark::State& state) {
                                 double ratios = 0.0;
                                 for (auto _ : state) withThreads(1, [&] { ratios += bounceRatio(work); });
                                 state.counters["ratio"] = ratios / static_cast<double>(state.iterations());
                               })
      ->Unit(benchmark::kMillisecond)
      ->Iterations(3);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
