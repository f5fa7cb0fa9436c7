// Results on disk, by key: what a bake found out, for the bakes after it. One file an entry, written beside
// its place and renamed, so that a program that is killed leaves whole entries or none; an entry that is
// damaged or cut off counts as absent and is removed. Entries that nobody asked for longest go when there are
// more bytes than allowed, never those that the running bake read or wrote. Any number of threads and of
// processes may use one folder. Nothing that goes wrong in it (no room, no right to write) fails a bake:
// notice() says so once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "baker/cache/key.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

inline constexpr std::uint64_t kCacheBytes = std::uint64_t{8} << 30;  // unless told otherwise

inline constexpr double kCheckpointEvery_s = 8.0;

struct CacheFigures {
  std::uint64_t found = 0, bytes_read = 0;  // bytes of files
  std::uint64_t stored = 0, bytes_written = 0;
  std::uint64_t damaged = 0, evicted = 0;
};

class Cache {
 public:
  // $LAMBENT_CACHE, else $XDG_CACHE_HOME/lambent, else ~/.cache/lambent; empty where none of them is set, or
  // the first is "off".
  static std::filesystem::path defaultFolder();

  // Makes the folder where there is none. Error: it cannot be made, or is no folder.
  static Result<Cache> open(const std::filesystem::path& folder, std::uint64_t most_bytes = kCacheBytes);
  Cache(Cache&&) noexcept;
  Cache& operator=(Cache&&) noexcept;
  ~Cache();

  std::optional<std::vector<std::byte>> find(const Key& key) const;
  bool has(const Key& key) const;  // at a glance: it may still prove damaged
  void put(const Key& key, std::span<const std::byte> bytes);
  void drop(const Key& key);

  // From now on entries are in use; those used before may go. A bake calls this when it begins.
  void beginBake();
  // Without: finds nothing, and keeps what it is given (`--force`).
  void setReading(bool reading);

  // How much work a bake that is killed may lose: what takes longer is kept in parts (baker/jobs/stage.hpp).
  void setCheckpointEvery(double seconds);
  double checkpointEvery() const;
  // Is it time for the next? checkpointed() says that all is safe now.
  bool checkpointDue() const;
  void checkpointed();

  const std::filesystem::path& folder() const;
  CacheFigures figures() const;
  // Why entries are not kept any more; empty while all is well.
  std::string notice() const;

 private:
  struct State;
  explicit Cache(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace lambent::baker
