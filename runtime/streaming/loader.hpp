// Brings a bundle into memory in the order in which it is wanted, on worker threads: reads ranges, checks
// them, decodes Draco, images and entropy coding. No GL: the render thread takes what is ready and uploads it
// within its budget (residency.hpp). Order of delivery is the order of priority, whatever the number of
// threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/base/thread_pool.hpp"
#include "runtime/bundle/reader.hpp"
#include "runtime/streaming/load_request.hpp"
#include "runtime/streaming/loaded_chunk.hpp"

namespace lambent::streaming {

class Loader {
 public:
  // Starts `workers` (at least 1) on everything in the bundle: meshes and rows first, then tables of BRDFs,
  // grids of volumes, images, then codebooks and planes by priority. They end before `threads` do.
  Loader(std::shared_ptr<const bundle::Reader> reader, ThreadPool& threads, unsigned workers);
  // Brings these parts alone, in this order.
  Loader(std::shared_ptr<const bundle::Reader> reader, std::vector<Work> work, ThreadPool& threads,
         unsigned workers);
  ~Loader();  // stops the workers after the item in hand
  Loader(Loader&&) noexcept;
  Loader& operator=(Loader&&) noexcept;

  // What is ready, in order, up to about max_bytes (at least one item if any is ready). Never waits.
  std::vector<Ready> take(std::size_t max_bytes);
  // Waits until something is ready or nothing more will come.
  void waitForMore();
  // True once every item has been taken, or loading stopped at an error.
  bool finished() const;
  // The first error; loading stops there.
  std::optional<Error> error() const;

  std::uint64_t bytesRead() const;

  // Nothing more is wanted: workers end after the item in hand.
  void stop();
  // Whether all workers have ended: destroying the loader does not wait then.
  bool idle() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lambent::streaming
