// Threads for work that may wait for others, kept for the next such work: beginning a thread costs up to a
// millisecond of whoever asks for it, which is much of a frame.
#pragma once

#include <functional>
#include <memory>

namespace lambent {

class ThreadPool {
 public:
  ThreadPool();
  ~ThreadPool();  // after all work
  ThreadPool(ThreadPool&&) noexcept;
  ThreadPool& operator=(ThreadPool&&) noexcept;

  // Calls work() on a thread of its own, one that has nothing to do if there is any, at once and not after
  // other work. work must not throw. From any thread.
  void run(std::function<void()> work);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lambent
