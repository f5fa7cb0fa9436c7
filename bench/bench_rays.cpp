// Measures pass 0 against its limit: rays per second of the baker's direct pass beside bare Embree loops over
// the same rays, in one run, on one thread. The bare loops time only the calls: their packets are filled
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
#include "baker/transport/direction_table.hpp"
#include "baker/transport/ray_scene.hpp"
#include "bench/group_workload.hpp"
#include "bench/scene_argument.hpp"

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
  RTCGeometry geometry = rtcNewGeometry(work.device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const auto& g = work.group->geometry;
  std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                      sizeof(glm::vec3), g.positions.size()),
              g.positions.data(), g.positions.size() * sizeof(glm::vec3));
  std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                      sizeof(glm::uvec3), g.triangles.size()),
              g.triangles.data(), g.triangles.size() * sizeof(glm::uvec3));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(work.scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(work.scene);
}

struct FilledPacket {
  alignas(64) RTCRay16 ray;
  PacketLanes lanes;
};

enum class Call { Incoherent16, Coherent16, Incoherent8, Single };

std::uint64_t traceBare(const Workload& work, std::vector<FilledPacket>& packets, Call call) {
  RayQuery query(call == Call::Coherent16 ? RayOrder::Coherent : RayOrder::Incoherent);
  std::uint64_t rays = 0;
  for (FilledPacket& packet : packets) {
    if (call == Call::Incoherent16 || call == Call::Coherent16) {
      query.occluded(work.scene, packet.lanes.valid.data(), packet.ray);
    } else {
      if (call == Call::Single) {
        for (unsigned k = 0; k < kPacketWidth; ++k) {
          if (!packet.lanes.valid[k]) continue;
          RTCRay ray = rtcGetRayFromRayN(reinterpret_cast<RTCRayN*>(&packet.ray), kPacketWidth, k);
          query.occluded(work.scene, ray);
          benchmark::DoNotOptimize(ray.tfar);
        }
      } else {
        for (unsigned half = 0; half < 2; ++half) {
          alignas(32) RTCRay8 ray;
          alignas(32) int valid[8];
          for (unsigned k = 0; k < 8; ++k) {
            const unsigned from = half * 8 + k;
            valid[k] = packet.lanes.valid[from];
            ray.org_x[k] = packet.ray.org_x[from], ray.org_y[k] = packet.ray.org_y[from],
            ray.org_z[k] = packet.ray.org_z[from];
            ray.dir_x[k] = packet.ray.dir_x[from], ray.dir_y[k] = packet.ray.dir_y[from],
            ray.dir_z[k] = packet.ray.dir_z[from];
            ray.tnear[k] = 0.0f, ray.tfar[k] = packet.ray.tfar[from], ray.time[k] = 0.0f, ray.mask[k] = ~0u,
            ray.flags[k] = 0;
          }
          query.occluded(work.scene, valid, ray);
          benchmark::DoNotOptimize(ray.tfar[0]);
        }
      }
    }
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
Timed runBare(const Workload& work, const DirectionTable& table, Call call) {
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
    timed.rays += traceBare(work, packets, call);
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

}  // namespace

int main(int argc, char** argv) {
  const std::string file = takeSceneArgument(argc, argv);
  benchmark::Initialize(&argc, argv);
  static Workload work{loadGroup(file)};
  buildBareScene(work);
  static const DirectionTable table = cosineTable(kRays);
  const auto bare = [](const char* name, Call call) {
    benchmark::RegisterBenchmark(name,
                                 [call](benchmark::State& state) {
                                   for (auto _ : state) report(state, runBare(work, table, call));
                                 })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  };
  bare("bare/occluded16_incoherent", Call::Incoherent16);
  bare("bare/occluded16_coherent", Call::Coherent16);
  bare("bare/occluded8_incoherent", Call::Incoherent8);
  bare("bare/occluded1", Call::Single);
  // The ratio is taken pass by pass in turn, so that a machine whose speed drifts does not spoil it.
  benchmark::RegisterBenchmark("pass0/against_occluded16_incoherent",
                               [](benchmark::State& state) {
                                 double ratios = 0.0;
                                 for (auto _ : state) {
                                   withThreads(1, [&] {
                                     const double limit =
                                         runBare(work, table, Call::Incoherent16).perSecond();
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
