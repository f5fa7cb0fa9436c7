#include "runtime/base/parallel.hpp"

#include <algorithm>
#include <thread>
#include <vector>

namespace lambent {

void inParallel(std::size_t count, std::size_t worth, const std::function<void(std::size_t)>& part) {
  static const std::size_t processors = std::max(1u, std::thread::hardware_concurrency());
  const std::size_t threads = std::clamp<std::size_t>(count / std::max<std::size_t>(worth, 1), 1, processors);
  const auto run = [&](std::size_t thread) {
    for (std::size_t i = thread * count / threads; i < (thread + 1) * count / threads; ++i) part(i);
  };
  std::vector<std::jthread> others;
  for (std::size_t thread = 1; thread < threads; ++thread) others.emplace_back(run, thread);
  run(0);
}

}  // namespace lambent
