#include "baker/jobs/progress.hpp"

#include <utility>

namespace lambent::baker {

Progress::Stage Progress::current() const {
  Stage stage = running_;
  stage.done = done_.load(std::memory_order_relaxed);
  stage.seconds = std::chrono::duration<double>(Clock::now() - began_).count();
  return stage;
}

void Progress::begin(std::string name, std::uint64_t total, std::string unit) {
  end();
  const std::lock_guard hold(lock_);
  running_ = {std::move(name), std::move(unit), total, 0, 0.0};
  done_ = 0;
  began_ = Clock::now();
}

void Progress::end() {
  const std::lock_guard hold(lock_);
  if (running_.name.empty()) return;
  finished_.push_back(current());
  running_ = {};
}

Progress::Stage Progress::now() const {
  const std::lock_guard hold(lock_);
  return running_.name.empty() ? Stage{} : current();
}

std::vector<Progress::Stage> Progress::finished() const {
  const std::lock_guard hold(lock_);
  return finished_;
}

}  // namespace lambent::baker
