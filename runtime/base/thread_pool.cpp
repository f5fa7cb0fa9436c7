#include "runtime/base/thread_pool.hpp"

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace lambent {

struct ThreadPool::State {
  void run(std::function<void()> next) {
    const std::lock_guard lock(mutex);
    work.push_back(std::move(next));
    if (work.size() > waiting)
      threads.emplace_back([this](const std::stop_token& stop) { serve(stop); });
    else
      called.notify_one();
  }

  void serve(const std::stop_token& stop) {
    std::unique_lock lock(mutex);
    for (;;) {
      ++waiting;
      called.wait(lock, stop, [&] { return !work.empty(); });
      --waiting;
      if (work.empty()) return;
      const std::function<void()> next = std::move(work.front());
      work.pop_front();
      lock.unlock();
      next();
      lock.lock();
    }
  }

  std::mutex mutex;  // guards the members below
  std::condition_variable_any called;
  std::deque<std::function<void()>> work;  // tasks that no thread has taken yet
  std::size_t waiting = 0;                 // number of idle threads
  std::vector<std::jthread> threads;       // last member, because threads use the others
};

ThreadPool::ThreadPool() : state_(std::make_unique<State>()) {}
ThreadPool::~ThreadPool() = default;
ThreadPool::ThreadPool(ThreadPool&&) noexcept = default;
ThreadPool& ThreadPool::operator=(ThreadPool&&) noexcept = default;

void ThreadPool::run(std::function<void()> work) {
  state_->run(std::move(work));
}

}  // namespace lambent
