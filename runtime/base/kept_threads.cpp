#include "runtime/base/kept_threads.hpp"

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace lambent {

namespace {

class KeptThreads {
 public:
  static KeptThreads& get() {
    static KeptThreads threads;
    return threads;
  }
  void run(std::function<void()> work) {
    const std::lock_guard lock(mutex_);
    work_.push_back(std::move(work));
    if (work_.size() > waiting_)
      threads_.emplace_back([this](const std::stop_token& stop) { serve(stop); });
    else
      called_.notify_one();
  }

 private:
  void serve(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    for (;;) {
      ++waiting_;
      const bool found = called_.wait(lock, stop, [&] { return !work_.empty(); });
      --waiting_;
      if (!found) return;
      const std::function<void()> work = std::move(work_.front());
      work_.pop_front();
      lock.unlock();
      work();
      lock.lock();
    }
  }

  std::mutex mutex_;  // guards all below but the threads' own
  std::condition_variable_any called_;
  std::deque<std::function<void()>> work_;  // that no thread has taken yet
  std::size_t waiting_ = 0;                 // threads, for work
  std::vector<std::jthread> threads_;       // last: they use all above
};

}  // namespace

void onKeptThread(std::function<void()> work) {
  KeptThreads::get().run(std::move(work));
}

}  // namespace lambent
