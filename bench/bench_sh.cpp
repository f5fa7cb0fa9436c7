// Measures spherical harmonics on one thread at orders 5 and 6: times in nanoseconds, medians with
// --benchmark_repetitions. Rivals (docs/design/streaming.md says where each was measured): DirectXMath's
// SHMath evaluates one direction and rotates, drjit evaluates in batches. Limits are measured in the same
// run: *_limit rows do the same arithmetic or move the same bytes and nothing else.
#include <array>
#include <cstring>
#include <vector>

#include <benchmark/benchmark.h>
#include <glm/gtc/quaternion.hpp>

#include "runtime/sh/image_layout.hpp"
#include "runtime/sh/rotation.hpp"
#include "runtime/sh/window.hpp"
#include "runtime/sh/zonal.hpp"

namespace {

using namespace lambent::sh;

constexpr std::size_t kDirections = 1024;

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
