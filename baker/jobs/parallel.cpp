#include "baker/jobs/parallel.hpp"

#include <algorithm>

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace lambent::baker {

bool parallelRanges(std::size_t count, std::size_t grain, const std::stop_token& stop,
                    const std::function<void(std::size_t begin, std::size_t end)>& body) {
  const std::size_t ranges = (count + grain - 1) / grain;
  tbb::parallel_for(std::size_t{0}, ranges, [&](std::size_t range) {
    if (!stop.stop_requested()) body(range * grain, std::min(count, (range + 1) * grain));
  });
  return !stop.stop_requested();
}

void withThreads(unsigned threads, const std::function<void()>& job) {
  // More threads than cores gain nothing, and TBB allocates memory for each.
  if (threads == 0 || threads >= static_cast<unsigned>(tbb::info::default_concurrency())) return job();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  tbb::task_arena arena(static_cast<int>(threads));
  arena.execute(job);
}

void inBackground(unsigned threads, const std::function<void()>& job) {
  const int most = tbb::info::default_concurrency();
  const int limit =
      threads == 0 ? std::max(most - 1, 1) : static_cast<int>(std::min(threads, static_cast<unsigned>(most)));
  // One slot is reserved for this thread, so that the job goes on even if all other threads are busy.
  tbb::task_arena arena(limit, 1, tbb::task_arena::priority::low);
  arena.execute(job);
}

}  // namespace lambent::baker
