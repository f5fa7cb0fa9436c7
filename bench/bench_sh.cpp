// Measures spherical harmonics on one thread at orders 5 and 6: times in nanoseconds, medians with
// --benchmark_repetitions. Rivals (docs/design/streaming.md says where each was measured): DirectXMath's
// SHMath evaluates one direction and rotates, drjit evaluates in batches. Limits are measured in the same
// run: *_limit rows do the same arithmetic or move the same bytes and nothing else.
#include <array>
#include <cstring>
#include <vector>

#include <benchmark/benchmark.h>
#include <glm/gtc/quaternion.hpp>

#include "runtime/sh/projection.hpp"
#include "runtime/sh/rotation.hpp"
#include "runtime/sh/window.hpp"
#include "runtime/sh/zonal.hpp"

namespace {

using namespace lambent::sh;

constexpr std::size_t kDirections = 1024;
constexpr int kCubeSize = 16;

struct Directions {
  std::vector<float> x, y, z;
};

Directions someDirections() {
  Directions dirs;
  for (std::size_t k = 0; k < kDirections; ++k) {
    const float z = 1 - (2 * static_cast<float>(k) + 1) / kDirections, r = std::sqrt(1 - z * z);
    dirs.x.push_back(r * std::cos(2.39996f * static_cast<float>(k)));
    dirs.y.push_back(r * std::sin(2.39996f * static_cast<float>(k)));
    dirs.z.push_back(z);
  }
  return dirs;
}

// Reports the time of one item, if an iteration does several.
void perItem(benchmark::State& state, double items) {
  state.counters["each"] =
      benchmark::Counter(items, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void evaluateOne(benchmark::State& state) {
  const int order = static_cast<int>(state.range(0));
  const Directions dirs = someDirections();
  std::array<float, kMaxCoefficients> y;
  for (auto _ : state)
    for (std::size_t k = 0; k < kDirections; ++k) {
      evaluate<float>(order, dirs.x[k], dirs.y[k], dirs.z[k], y);
      benchmark::DoNotOptimize(y);
    }
  perItem(state, kDirections);
}
BENCHMARK(evaluateOne)->Arg(5)->Arg(6);

// With 64 directions per call, the output stays in the first-level cache.
void evaluateBatched(benchmark::State& state) {
  const int order = static_cast<int>(state.range(0));
  constexpr std::size_t kBatch = 64;
  const Directions dirs = someDirections();
  std::vector<float> out(kMaxCoefficients * kBatch);
  for (auto _ : state)
    for (std::size_t k = 0; k < kDirections; k += kBatch) {
      evaluateBatch(order, &dirs.x[k], &dirs.y[k], &dirs.z[k], kBatch, out.data());
      benchmark::DoNotOptimize(out.data());
      benchmark::ClobberMemory();
    }
  perItem(state, kDirections);
}
BENCHMARK(evaluateBatched)->Arg(5)->Arg(6);

// The limit of evaluateBatched is writing its output.
void evaluateBatched_limit(benchmark::State& state) {
  constexpr std::size_t kBatch = 64;
  std::vector<float> out(kMaxCoefficients * kBatch);
  const auto bytes =
      static_cast<std::size_t>(coefficientCount(static_cast<int>(state.range(0)))) * kBatch * sizeof(float);
  for (auto _ : state)
    for (std::size_t k = 0; k < kDirections; k += kBatch) {
      std::memset(out.data(), static_cast<int>(k), bytes);
      benchmark::DoNotOptimize(out.data());
      benchmark::ClobberMemory();
    }
  perItem(state, kDirections);
}
BENCHMARK(evaluateBatched_limit)->Arg(5)->Arg(6);

std::vector<glm::dmat3> someRotations() {
  std::vector<glm::dmat3> rotations;
  for (int k = 0; k < 256; ++k)
    rotations.push_back(
        glm::mat3_cast(glm::normalize(glm::dquat(std::cos(k), std::sin(2 * k), std::cos(3 * k), 0.5))));
  return rotations;
}

void rotationBuild(benchmark::State& state) {
  const auto rotations = someRotations();
  Rotation rotation(rotations[0], static_cast<int>(state.range(0)));
  for (auto _ : state)
    for (const glm::dmat3& matrix : rotations) {
      rotation.set(matrix);
      benchmark::DoNotOptimize(rotation);
    }
  perItem(state, static_cast<double>(rotations.size()));
}
BENCHMARK(rotationBuild)->Arg(5)->Arg(6);

void rotationApplyOneChannel(benchmark::State& state) {
  const Rotation rotation(someRotations()[1], static_cast<int>(state.range(0)));
  std::array<float, kMaxCoefficients> in{}, out{};
  in.fill(0.5f);
  for (auto _ : state) {
    benchmark::DoNotOptimize(in);
    rotation.apply(in, std::span<float>(out));
    benchmark::DoNotOptimize(out);
  }
  perItem(state, 1);
}
BENCHMARK(rotationApplyOneChannel)->Arg(5)->Arg(6);

void rotationApplyRgb(benchmark::State& state) {
  const int order = static_cast<int>(state.range(0));
  const Rotation rotation(someRotations()[1], order);
  LightVector light = discLight(order, {0, 1, 0}, 0.3, {1, 2, 3});
  for (auto _ : state) {
    benchmark::DoNotOptimize(light);
    LightVector turned = rotation.apply(light);
    benchmark::DoNotOptimize(turned);
  }
  perItem(state, 1);
}
BENCHMARK(rotationApplyRgb)->Arg(5)->Arg(6);

std::vector<glm::vec3> someCube() {
  std::vector<glm::vec3> texels;
  for (int k = 0; k < 6 * kCubeSize * kCubeSize; ++k)
    texels.emplace_back(static_cast<float>(k % 7), static_cast<float>(k % 11), static_cast<float>(k % 13));
  return texels;
}

void projectCube(benchmark::State& state) {
  const CubeProjector projector(static_cast<int>(state.range(0)), kCubeSize);
  const auto texels = someCube();
  for (auto _ : state) {
    LightVector light = projector.project(texels);
    benchmark::DoNotOptimize(light);
  }
  perItem(state, 1);
}
BENCHMARK(projectCube)->Arg(5)->Arg(6);

// The limit of a projection without mirror symmetry is the plain table's multiply-adds at the full vector
// rate, from registers, without loading anything. 12 sums in flight cover the units' latency.
void projectCube_plainTableLimit(benchmark::State& state) {
#ifdef __AVX__
  constexpr int kLanes = 8;
#else
  constexpr int kLanes = 4;
#endif
  using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));
  const int steps =
      coefficientCount(static_cast<int>(state.range(0))) * 3 * 6 * kCubeSize * kCubeSize / kLanes / 12;
  Lanes a = Lanes{} + 1.5f, b = a;
  for (auto _ : state) {
    benchmark::DoNotOptimize(a);
    benchmark::DoNotOptimize(b);
    Lanes s0 = a, s1 = a, s2 = a, s3 = a, s4 = a, s5 = a, s6 = a, s7 = a, s8 = a, s9 = a, s10 = a, s11 = a;
    for (int k = 0; k < steps; ++k) {
      s0 += a * b, s1 += a * b, s2 += a * b, s3 += a * b, s4 += a * b, s5 += a * b;
      s6 += a * b, s7 += a * b, s8 += a * b, s9 += a * b, s10 += a * b, s11 += a * b;
      asm volatile("" : "+x"(a), "+x"(b));  // keeps the products from being hoisted
    }
    Lanes sum = s0 + s1 + s2 + s3 + s4 + s5 + s6 + s7 + s8 + s9 + s10 + s11;
    benchmark::DoNotOptimize(sum);
  }
  perItem(state, 1);
}
BENCHMARK(projectCube_plainTableLimit)->Arg(5)->Arg(6);

// The limit of any projection is reading the picture once.
void projectCube_readLimit(benchmark::State& state) {
  auto texels = someCube();
  auto copy = texels;
  for (auto _ : state) {
    std::memcpy(copy.data(), texels.data(), texels.size() * sizeof(glm::vec3));
    benchmark::DoNotOptimize(copy.data());
    benchmark::ClobberMemory();
  }
  perItem(state, 1);
}
BENCHMARK(projectCube_readLimit);

// Every light change pays for this once; the goal is 1 ms.
void autoWindow(benchmark::State& state) {
  const int order = static_cast<int>(state.range(0));
  const LightVector light = discLight(order, {0.48f, 0.6f, 0.64f}, 0.1, {3, 2, 1}) +
                            discLight(order, {-0.6f, 0.8f, 0}, 0.3, {0.1f, 0.2f, 0.3f}) +
                            constantLight(order, {0.01f, 0.01f, 0.02f});
  for (auto _ : state) {
    LightVector windowed = applyWindow(light, Window::Auto);
    benchmark::DoNotOptimize(windowed);
  }
  perItem(state, 1);
}
BENCHMARK(autoWindow)->Arg(5)->Arg(6);

}  // namespace
