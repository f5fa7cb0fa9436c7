// The kernels that evaluate coded transfer, as C++, on memory that is laid out as on the GPU.
#pragma once

#include "runtime/transfer/codebook.hpp"
#include "runtime/transfer/seen_sky_shared.h"
#include "runtime/transfer/transfer_shared.h"
#include "tests/support/glsl/glsl.hpp"

namespace lambent::transfer::glsl {

using namespace lambent::glsl;

struct ProjectVectors : Invocation {
#include "as_cpp/project_clusters.comp"
};

struct ProjectVisibility : Invocation {
#define LAMBENT_VISIBILITY
#include "as_cpp/project_clusters.comp"
#undef LAMBENT_VISIBILITY
};

template <uint LAMBENT_OUTPUTS>
struct ShadeVectors : Invocation {
#include "as_cpp/shade_samples.comp"
};

template <uint LAMBENT_OUTPUTS>
struct BlendVectors : Invocation {
#define LAMBENT_MANY_LIGHTS
#include "as_cpp/shade_samples.comp"
#undef LAMBENT_MANY_LIGHTS
};

template <uint LAMBENT_BANDS>
struct ShadeMatrices : Invocation {
#define LAMBENT_MATRICES
#include "as_cpp/shade_samples.comp"
#undef LAMBENT_MATRICES
};

struct FillSamples : Invocation {
#include "as_cpp/fill_samples.comp"
};

struct DiffuseLight {
#include "as_cpp/diffuse_light.glsl"
};

struct SeenSky {
#include "as_cpp/seen_sky.glsl"
};

struct Memory {
  std::span<const vec4> lights;
  std::span<const uint> page, places, gaunt;
  std::span<vec4> products, samples;
};

template <typename Kernel>
void run(Kernel kernel, const Memory& memory, const TransferRecord& record, uint elements,
         uint per_group = Kernel::kInvocations) {
  kernel.transfers = std::span(&record, 1);
  kernel.page = memory.page;
  kernel.places = memory.places;
  kernel.products = memory.products;
  if constexpr (requires { kernel.lights; }) kernel.lights = memory.lights;
  if constexpr (requires { kernel.gaunt; }) kernel.gaunt = memory.gaunt;
  if constexpr (requires { kernel.samples; }) kernel.samples = memory.samples;
  lambent::glsl::run(kernel, elements, per_group);
}

// Stage a.
inline void project(const Memory& memory, const TransferRecord& record) {
  const uint units = record.light_count * record.clusters * record.outputs;
  if (record.visibility != 0)
    run(ProjectVisibility{}, memory, record, units, kUnitsPerGroup);
  else
    run(ProjectVectors{}, memory, record, units, kUnitsPerGroup);
}

// Both stages, as the diffuse effect runs them.
template <uint Outputs>
void shadeVectorsOf(const Memory& memory, const TransferRecord& record) {
  if (record.light_count > 1)
    run(BlendVectors<Outputs>{}, memory, record, record.sample_count);
  else
    run(ShadeVectors<Outputs>{}, memory, record, record.sample_count);
}
inline void shadeVectors(const Memory& memory, const TransferRecord& record) {
  project(memory, record);
  if (record.outputs == 1)
    shadeVectorsOf<1>(memory, record);
  else
    shadeVectorsOf<kMappedOutputs>(memory, record);
}

// Both stages, as the glossy effect runs them.
template <uint Bands = 6>
void shadeMatricesOf(const Memory& memory, const TransferRecord& record) {
  if (Bands * Bands == record.outputs)
    run(ShadeMatrices<Bands>{}, memory, record, Bands * record.sample_count);
  else if constexpr (Bands > 1)
    shadeMatricesOf<Bands - 1>(memory, record);
}
inline void shadeMatrices(const Memory& memory, const TransferRecord& record) {
  project(memory, record);
  shadeMatricesOf(memory, record);
}

}  // namespace lambent::transfer::glsl
