// Compute kernels over lists of work, as all effects run them. Render thread only.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/transfer/transfer_shared.h"

namespace lambent::evaluate {

// The tables of GLSL text that kernels of this room include files from.
extern const gpu::FindText kEvaluateShaders[2];

// Returns the order that is compiled into kernels; 0 selects a kernel that loops over any order.
constexpr std::uint32_t compiledOrder(std::uint32_t order) {
  return order >= 2 && order <= 6 ? order : 0;
}

// Compiles kernels when they are first needed, and keeps them.
class Kernels {
 public:
  explicit Kernels(std::span<const gpu::FindText> texts) : texts_(texts) {}

  // Makes the kernel of this entry file the current program. Fails if it does not compile on this device.
  Result<void> use(std::string_view file, std::vector<gpu::Define> defines = {});

 private:
  std::span<const gpu::FindText> texts_;
  std::map<std::string, gpu::Program, std::less<>> programs_;  // keyed by file and defines
};

// Runs all batches of the list, and makes what they wrote visible to what `barriers` names. For each batch
// `prepare` gets its key, and binds its program and its buffers but for the work itself.
template <class Prepare>
Result<void> run(gpu::WorkList& work, gpu::Counters& counters, const Prepare& prepare,
                 GLbitfield barriers = GL_SHADER_STORAGE_BARRIER_BIT) {
  if (work.empty()) return {};
  work.upload(counters);
  std::size_t index = 0;
  for (const auto& [key, items] : work.batches()) {
    if (Result<void> done = prepare(key); !done) return done;
    work.dispatch(index++, transfer::kBindWork, counters);
  }
  glMemoryBarrier(barriers);
  return {};
}

}  // namespace lambent::evaluate
