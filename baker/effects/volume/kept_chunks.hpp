// Keeps the traced results of chunks of samples in memory up to a limit, whichever come first; other chunks
// are traced again each time they are needed. In the output of the stage that traces, a chunk without room is
// written as an empty one. A chunk type has bytes(), shrink(), write() and read() (baker/jobs/stage.hpp), and
// is empty by default.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "baker/jobs/stage.hpp"

namespace lambent::baker {

template <typename Chunk>
class KeptChunks {
 public:
  KeptChunks(std::size_t chunks, std::uint64_t most_bytes) : chunks_(chunks), most_bytes_(most_bytes) {}
  KeptChunks(KeptChunks&& other) noexcept
      : chunks_(std::move(other.chunks_)), most_bytes_(other.most_bytes_), bytes_(other.bytes_.load()) {}

  // Keeps the chunk if there is room. May be called from any thread, once for each chunk.
  void offer(std::size_t index, Chunk&& chunk) {
    const std::uint64_t size = chunk.bytes();
    if (bytes_.fetch_add(size) + size > most_bytes_) {
      bytes_.fetch_sub(size);
      return;
    }
    chunk.shrink();
    chunks_[index] = std::move(chunk);
  }
  const Chunk& operator[](std::size_t index) const { return chunks_[index]; }
  std::uint64_t bytes() const { return bytes_; }

  // Returns the output of a stage whose ranges are the chunks, of `grain` items each. `fits` says whether a
  // chunk that was read is valid for that many items.
  Output output(std::size_t grain, std::function<bool(const Chunk&, std::size_t items)> fits) {
    return {[this, grain](std::size_t begin, std::size_t, ByteWriter& out) {
              write(chunks_[begin / grain], out);
            },
            [this, grain, fits = std::move(fits)](std::size_t begin, std::size_t end, ByteReader& in) {
              Chunk chunk;
              if (!read(in, chunk) || !fits(chunk, end - begin)) return false;
              offer(begin / grain, std::move(chunk));
              return true;
            }};
  }

 private:
  std::vector<Chunk> chunks_;
  std::uint64_t most_bytes_;
  std::atomic<std::uint64_t> bytes_ = 0;
};

}  // namespace lambent::baker
