// A Cache keeps results of bakes on disk, by key, for later bakes. Each entry is a file, which is written
// beside its place and renamed, so that a killed program leaves whole entries or none; an entry that is
// damaged or truncated counts as absent and is removed. When there are more bytes than allowed, the entries
// that have been unused for longest are removed, but never those that the running bake has read or written.
// Any number of threads and processes may use one folder. No problem with it (no space, no permission) makes
// a bake fail; notice() reports it.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "baker/cache/key.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

inline constexpr std::uint64_t kCacheBytes = std::uint64_t{8} << 30;  // default limit on the folder's size

struct CacheFigures {
  std::uint64_t found = 0, bytes_read = 0;  // entries; bytes of their files
  std::uint64_t stored = 0, bytes_written = 0;
  std::uint64_t damaged = 0, evicted = 0;
};

class Cache {
 public:
  // Returns $LAMBENT_CACHE, else $XDG_CACHE_HOME/lambent, else ~/.cache/lambent. The path is empty if none of
  // them is set, or if the first is "off".
  static std::filesystem::path defaultFolder();

  // Makes the folder if it does not exist. Errors: the folder cannot be made, or the path is no folder.
  static Result<Cache> open(const std::filesystem::path& folder, std::uint64_t most_bytes = kCacheBytes);

  std::optional<std::vector<std::byte>> find(const Key& key) const;
  bool has(const Key& key) const;  // a quick test; the entry may still be damaged
  void put(const Key& key, std::span<const std::byte> bytes);
  void drop(const Key& key);

  // Marks the begin of a bake: entries that were used before may be evicted, those used from now on are kept.
  void beginBake();
  // If `reading` is false, find() finds nothing, but put() still keeps results (`--force`).
  void setReading(bool reading) { state_->reading = reading; }

  // Sets how many seconds of work a killed bake may lose: longer work is kept in parts
  // (baker/jobs/stage.hpp).
  void setCheckpointEvery(double seconds) { state_->checkpoint_every_s = seconds; }
  // Returns whether it is time for the next checkpoint. checkpointed() says that one was just made.
  bool checkpointDue() const;
  void checkpointed();

  CacheFigures figures() const;
  // Says why entries are not kept any more; empty if there is no problem.
  std::string notice() const;

 private:
  using Time = std::filesystem::file_time_type;
  struct State {
    std::filesystem::path folder;
    std::uint64_t most_bytes = 0;
    std::atomic<Time> bake_began = Time(), checkpoint = Time();
    std::atomic<double> checkpoint_every_s = 8.0;
    std::atomic<bool> reading = true, writing = true;

    std::mutex lock;                     // protects the members below
    std::optional<std::uint64_t> bytes;  // size of the folder as far as known; other processes add to it
    std::uint64_t room_at = 0;           // size from which eviction begins
    CacheFigures figures;
    std::string notice;
  };

  Cache() : state_(std::make_unique<State>()) {}
  std::filesystem::path pathOf(const Key& key) const;
  void makeRoom();

  std::unique_ptr<State> state_;
};

// Returns the bytes of an entry; nothing unless `file`, from its first byte to its last, is the entry of
// `key`.
std::optional<std::vector<std::byte>> unpackEntry(const Key& key, std::span<const std::byte> file);

}  // namespace lambent::baker
