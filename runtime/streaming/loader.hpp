// Loads a bundle into memory on worker threads. They read byte ranges, check them, and decode Draco, images
// and entropy coding, without GL. The render thread takes loaded items and uploads them within its budget
// (residency.hpp). Items are delivered in the order of their priority, whatever the number of threads.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/base/threads.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/streaming/load_request.hpp"

namespace lambent::streaming {

class Loader {
 public:
  // Starts `workers` (at least 1) that load the whole bundle in the order of requestsOf(). The loader must be
  // destroyed before `threads`.
  Loader(std::shared_ptr<const bundle::Reader> reader, ThreadPool& threads, unsigned workers);
  // Loads only these items, in this order.
  Loader(std::shared_ptr<const bundle::Reader> reader, std::vector<Work> work, ThreadPool& threads,
         unsigned workers);
  ~Loader();  // waits until the workers have finished their current items
  Loader(Loader&&) noexcept;
  Loader& operator=(Loader&&) noexcept;

  // Returns loaded items in order, up to about max_bytes, but at least one if any is ready. Never waits.
  std::vector<Ready> take(std::size_t max_bytes);
  // Waits until an item is ready or no more will come.
  void waitForMore();
  void waitForMore(std::chrono::milliseconds most);
  // Returns true once every item has been taken, or loading has stopped at an error.
  bool finished() const;
  // Returns the first error, at which loading stops.
  std::optional<Error> error() const;

  std::uint64_t bytesRead() const;

  // Stops loading. Workers end after their current items.
  void stop();
  // Returns whether all workers have ended, so that the destructor does not wait.
  bool idle() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lambent::streaming
