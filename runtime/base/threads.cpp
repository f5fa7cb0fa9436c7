#include "runtime/base/threads.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace lambent {

namespace {

constexpr std::size_t kMostHelpers = 15;

struct Job {
  Job(std::size_t part_count, const std::function<void(std::size_t)>* each) : count(part_count), part(each) {}

  std::size_t count;
  const std::function<void(std::size_t)>* part;  // lives until all parts are done
  std::atomic<std::size_t> next = 0, done = 0;

  void work() {
    for (std::size_t i = next++; i < count; i = next++) {
      (*part)(i);
      if (++done == count) done.notify_all();
    }
  }
};

}  // namespace

void inParallel(std::size_t count, std::size_t worth, const std::function<void(std::size_t)>& part) {
  static const std::size_t processors = std::max(1u, std::thread::hardware_concurrency());
  const std::size_t threads =
      std::min({count / std::max<std::size_t>(worth, 1), processors, kMostHelpers + 1});
  if (threads < 2) {
    for (std::size_t i = 0; i < count; ++i) part(i);
    return;
  }
  // A thread that starts late finds nothing left to do, and the caller has not waited.
  static ThreadPool helpers(kMostHelpers);
  const auto job = std::make_shared<Job>(count, &part);
  for (std::size_t i = 1; i < threads; ++i) helpers.run([job] { job->work(); });
  job->work();
  for (std::size_t done = job->done; done < count; done = job->done) job->done.wait(done);
}

struct ThreadPool::State {
  explicit State(std::size_t most_threads) : most(most_threads) {}

  void run(std::function<void()> next) {
    const std::lock_guard lock(mutex);
    work.push_back(std::move(next));
    if (work.size() > waiting && threads.size() < most)
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

  const std::size_t most;
  std::mutex mutex;  // guards the members below
  std::condition_variable_any called;
  std::deque<std::function<void()>> work;  // tasks that no thread has taken yet
  std::size_t waiting = 0;                 // number of idle threads
  std::vector<std::jthread> threads;       // last member, because threads use the others
};

ThreadPool::ThreadPool(std::size_t most_threads) : state_(std::make_unique<State>(most_threads)) {}
ThreadPool::~ThreadPool() = default;
ThreadPool::ThreadPool(ThreadPool&&) noexcept = default;
ThreadPool& ThreadPool::operator=(ThreadPool&&) noexcept = default;

void ThreadPool::run(std::function<void()> work) {
  state_->run(std::move(work));
}

}  // namespace lambent
