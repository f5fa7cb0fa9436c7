#include "runtime/streaming/loader.hpp"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <limits>
#include <mutex>
#include <new>
#include <utility>

namespace lambent::streaming {
namespace {

// Limit of the memory of items that are decoded, or being decoded, but not taken. The item that will be taken
// next never waits for memory, so the actual limit is one item more, and workers cannot block each other.
constexpr std::size_t kMaxHeldBytes = std::size_t{64} << 20;
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

}  // namespace

// Workers claim items in order and put the loaded item into its slot; take() empties slots from the front. So
// items keep the order of the list, however many workers there are and however long each item takes.
struct Loader::State {
  struct Slot {
    std::optional<Ready> ready;
    std::size_t held = 0;  // bytes that are reserved, and later those of `ready`
  };

  State(std::shared_ptr<const bundle::Reader> bundle, std::vector<Work> wanted, ThreadPool& threads,
        unsigned workers)
      : reader(std::move(bundle)), work(std::move(wanted)), slots(work.size()) {
    working = std::min<std::size_t>(std::max(workers, 1u), work.size());
    for (std::size_t i = 0, count = working; i < count; ++i)
      threads.run([this] {
        runWorker();
        const std::lock_guard lock(mutex);
        --working;
        ended.notify_all();  // needs the lock, because the waiting thread destroys this object
      });
  }

  ~State() {
    stop();
    std::unique_lock lock(mutex);
    ended.wait(lock, [&] { return working == 0; });
  }

  void stop() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    room.notify_all();
  }

  // --- workers ---

  void runWorker() {
    for (;;) {
      std::size_t at = 0;
      {
        const std::lock_guard lock(mutex);
        if (stopping || next_claim >= end()) return;
        at = next_claim++;
      }
      auto loaded = loadOne(at);
      if (!loaded) return;
      {
        const std::lock_guard lock(mutex);
        if (*loaded) {
          bytes_read += bytesInFile(reader->description(), work[at]);
          hold(at, bytesOf(**loaded));
          slots[at].ready = std::move(**loaded);
        } else {
          hold(at, 0);
          if (at < failed_at) {
            failed_at = at;
            failure = std::move(loaded->error());
          }
        }
      }
      more.notify_all();
      room.notify_all();
    }
  }

  std::optional<Result<Ready>> loadOne(std::size_t at) {
    const std::string& path = reader->path().string();
    try {
      return load(*reader, work[at], [&](std::size_t bytes) { return reserve(at, bytes); });
    } catch (const std::bad_alloc&) {
      return fail(path, "does not fit into memory",
                  "close other programs or bake the scene at lower quality");
    } catch (const std::exception& exception) {
      return fail(path, exception.what(), "bake it again");
    }
  }

  // Waits for memory. Returns false if the item is not wanted any more.
  bool reserve(std::size_t at, std::size_t bytes) {
    std::unique_lock lock(mutex);
    const auto unwanted = [&] { return stopping || at >= end(); };
    room.wait(lock, [&] { return unwanted() || at == next_take || held_bytes + bytes <= kMaxHeldBytes; });
    if (unwanted()) return false;
    hold(at, bytes);
    return true;
  }

  // --- the caller holds the mutex ---

  void hold(std::size_t at, std::size_t bytes) {
    held_bytes += bytes - slots[at].held;
    slots[at].held = bytes;
  }

  std::size_t end() const { return std::min(work.size(), failed_at); }
  bool frontIsReady() const { return next_take < end() && slots[next_take].ready.has_value(); }
  // Returns whether all items before the failed one are loaded, so that this failure is the first.
  bool failureIsFirst() const {
    if (failed_at == kNone) return false;
    for (std::size_t at = next_take; at < failed_at; ++at) {
      if (!slots[at].ready) return false;
    }
    return true;
  }

  const std::shared_ptr<const bundle::Reader> reader;
  const std::vector<Work> work;

  mutable std::mutex mutex;      // guards the members below
  std::condition_variable more;  // signals that an item is ready or no more will come
  std::condition_variable room;  // signals that an item was taken or is not wanted any more
  std::vector<Slot> slots;       // one per item of `work`
  std::size_t next_claim = 0;
  std::size_t next_take = 0;
  std::size_t held_bytes = 0;
  std::size_t failed_at = kNone;
  Error failure;
  std::uint64_t bytes_read = 0;
  bool stopping = false;
  std::size_t working = 0;        // number of workers that have not ended
  std::condition_variable ended;  // signals that a worker has ended
};

Loader::Loader(std::shared_ptr<const bundle::Reader> reader, ThreadPool& threads, unsigned workers)
    : Loader(reader, requestsOf(reader->description()), threads, workers) {}
Loader::Loader(std::shared_ptr<const bundle::Reader> reader, std::vector<Work> work, ThreadPool& threads,
               unsigned workers)
    : state_(std::make_unique<State>(std::move(reader), std::move(work), threads, workers)) {}
Loader::~Loader() = default;
Loader::Loader(Loader&&) noexcept = default;
Loader& Loader::operator=(Loader&&) noexcept = default;

std::vector<Ready> Loader::take(std::size_t max_bytes) {
  std::vector<Ready> taken;
  {
    const std::lock_guard lock(state_->mutex);
    std::size_t bytes = 0;
    while (state_->frontIsReady()) {
      State::Slot& front = state_->slots[state_->next_take];
      if (!taken.empty() && bytes + front.held > max_bytes) break;
      bytes += front.held;
      taken.push_back(std::move(*front.ready));
      front.ready.reset();
      state_->hold(state_->next_take, 0);
      ++state_->next_take;
    }
  }
  if (!taken.empty()) state_->room.notify_all();
  return taken;
}

void Loader::waitForMore(std::chrono::milliseconds most) {
  std::unique_lock lock(state_->mutex);
  state_->more.wait_for(lock, most,
                        [&] { return state_->frontIsReady() || state_->next_take >= state_->end(); });
}

bool Loader::finished() const {
  const std::lock_guard lock(state_->mutex);
  return state_->next_take >= state_->end();
}

std::optional<Error> Loader::error() const {
  const std::lock_guard lock(state_->mutex);
  return state_->failureIsFirst() ? std::optional(state_->failure) : std::nullopt;
}

void Loader::stop() {
  state_->stop();
}

bool Loader::idle() const {
  const std::lock_guard lock(state_->mutex);
  return state_->working == 0;
}

std::uint64_t Loader::bytesRead() const {
  const std::lock_guard lock(state_->mutex);
  return state_->bytes_read;
}

}  // namespace lambent::streaming
