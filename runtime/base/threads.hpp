// Runs independent parts of a task on several threads. The result must not depend on which thread runs which
// part, nor on the number of threads.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>

namespace lambent {

// Calls part(i) for all i below `count` and returns when all are done. The calling thread works, too. Each
// further `worth` parts get a helper thread, up to the number of processors and at most 16 threads. The call
// does not wait for helpers that have not started yet. It may be made from any thread. Parts must not throw.
void inParallel(std::size_t count, std::size_t worth, const std::function<void(std::size_t)>& part);

// Keeps threads for tasks that may block. Starting a thread costs the caller up to a millisecond, which is
// much of a frame, so threads are reused.
class ThreadPool {
 public:
  explicit ThreadPool(std::size_t most_threads = std::numeric_limits<std::size_t>::max());
  ~ThreadPool();  // waits for all tasks
  ThreadPool(ThreadPool&&) noexcept;
  ThreadPool& operator=(ThreadPool&&) noexcept;

  // Calls work() at once on a thread of its own: an idle thread if there is one, else a new one, or the next
  // that becomes idle if there are as many as may be. `work` must not throw. This may be called from any
  // thread.
  void run(std::function<void()> work);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lambent
