#include "baker/jobs/progress.hpp"

#include <algorithm>
#include <utility>

namespace lambent::baker {

Progress::Stage Progress::current() const {
  Stage stage = running_;
  stage.done = done_.load(std::memory_order_relaxed);
  stage.seconds = std::chrono::duration<double>(Clock::now() - began_).count();
  return stage;
}

void Progress::beginPart() {
  end();
  const std::lock_guard hold(lock_);
  running_.part = ++part_;
}

void Progress::begin(std::string name, std::uint64_t total, std::string unit) {
  end();
  const std::lock_guard hold(lock_);
  running_ = {.name = std::move(name), .unit = std::move(unit), .total = total, .part = part_};
  done_ = 0;
  began_ = Clock::now();
}

void Progress::expect(std::uint64_t total) {
  const std::lock_guard hold(lock_);
  running_.total = std::max(total, done_.load(std::memory_order_relaxed));
}

void Progress::found(std::uint64_t units) {
  const std::lock_guard hold(lock_);
  add(units);
  running_.found = true;
  running_.found_units += units;
}

void Progress::end() {
  const std::lock_guard hold(lock_);
  if (running_.name.empty()) return;
  finished_.push_back(current());
  running_ = {.part = part_};
}

Progress::Stage Progress::now() const {
  const std::lock_guard hold(lock_);
  return running_.name.empty() ? running_ : current();
}

std::vector<Progress::Stage> Progress::finished() const {
  const std::lock_guard hold(lock_);
  return finished_;
}

}  // namespace lambent::baker
