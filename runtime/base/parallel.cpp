#include "runtime/base/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
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

}  // namespace lambent
