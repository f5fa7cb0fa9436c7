// Keeps threads for tasks that may block. Starting a thread costs the caller up to a millisecond, which is
// much of a frame, so threads are reused.
#pragma once

#include <functional>
#include <memory>

namespace lambent {

class ThreadPool {
 public:
  ThreadPool();
  ~ThreadPool();  // waits for all tasks
  ThreadPool(ThreadPool&&) noexcept;
  ThreadPool& operator=(ThreadPool&&) noexcept;

  // Calls work() at once on a thread of its own: an idle thread if there is one, else a new one. `work` must
  // not throw. This may be called from any thread.
  void run(std::function<void()> work);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lambent
