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

std::size_t processors() {
  static const std::size_t count = std::max(1u, std::thread::hardware_concurrency());
  return count;
}

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

// Threads that wait for jobs. A thread that starts late finds nothing left to do, and the caller has not
// waited.
class Helpers {
 public:
  static Helpers& get() {
    static Helpers helpers(std::min(processors() - 1, kMost));
    return helpers;
  }
  void call(const std::shared_ptr<Job>& job, std::size_t times) {
    {
      const std::lock_guard lock(mutex_);
      jobs_.insert(jobs_.end(), std::min(times, threads_.size()), job);
    }
    called_.notify_all();
  }

 private:
  static constexpr std::size_t kMost = 15;

  explicit Helpers(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      threads_.emplace_back([this](const std::stop_token& stop) { run(stop); });
  }
  void run(const std::stop_token& stop) {
    for (;;) {
      std::shared_ptr<Job> job;
      {
        std::unique_lock lock(mutex_);
        if (!called_.wait(lock, stop, [&] { return !jobs_.empty(); })) return;
        job = std::move(jobs_.front());
        jobs_.pop_front();
      }
      job->work();
    }
  }

  std::mutex mutex_;  // guards jobs_
  std::condition_variable_any called_;
  std::deque<std::shared_ptr<Job>> jobs_;
  std::vector<std::jthread> threads_;  // last member, because threads use the others
};

}  // namespace

void inParallel(std::size_t count, std::size_t worth, const std::function<void(std::size_t)>& part) {
  const std::size_t threads = std::min(count / std::max<std::size_t>(worth, 1), processors());
  if (threads < 2) {
    for (std::size_t i = 0; i < count; ++i) part(i);
    return;
  }
  const auto job = std::make_shared<Job>(count, &part);
  Helpers::get().call(job, threads - 1);
  job->work();
  for (std::size_t done = job->done; done < count; done = job->done) job->done.wait(done);
}

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
