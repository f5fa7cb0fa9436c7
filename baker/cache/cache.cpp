#include "baker/cache/cache.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <system_error>

#include <unistd.h>
#include <zstd.h>

#include "runtime/bundle/container.hpp"

namespace lambent::baker {

namespace fs = std::filesystem;

namespace {

using Time = fs::file_time_type;

constexpr const char* kExtension = ".entry";
constexpr const char* kPartMark = ".part-";  // in the names of files that are being written
// Eviction frees a tenth of the cache at a time, so that a full one is not listed for every entry.
constexpr double kLeftAfterEviction = 0.9;
// A file that has been in the process of being written for this long was left by a killed program.
constexpr std::chrono::hours kAbandoned{1};

// This clock is common to all processes, and finer than the one with which the system stamps files.
Time now() {
  return Time::clock::now();
}

// This fails in a folder without write permission, but there nothing is evicted either.
void touch(const fs::path& file) {
  std::error_code ignored;
  fs::last_write_time(file, now(), ignored);
}

// An entry is a file: a header, then the bytes, compressed by zstd if that saves enough.

constexpr std::array<char, 8> kMagic = {'L', 'M', 'C', 'A', 'C', 'H', 'E', '1'};
enum class Codec : std::uint64_t { Raw, Zstd };
// A fast level suits bytes that are mostly floats. Compression is kept if it saves an eighth, and tried only
// if a piece from the middle suggests that it may.
constexpr int kZstdLevel = 1;
constexpr std::size_t kTryBytes = std::size_t{128} << 10;

bool pays(std::size_t compressed, std::size_t bytes) {
  return ZSTD_isError(compressed) == 0 && compressed + bytes / 8 < bytes;
}

bool mayPay(std::span<const std::byte> bytes) {
  if (bytes.size() < 4 * kTryBytes) return true;
  std::vector<std::byte> out(ZSTD_compressBound(kTryBytes));
  const auto piece = bytes.subspan(bytes.size() / 2, kTryBytes);
  return pays(ZSTD_compress(out.data(), out.size(), piece.data(), piece.size(), kZstdLevel), kTryBytes);
}

// Limit on an entry's size; a header that claims more is damaged.
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 36;

struct Header {
  std::array<char, 8> magic = kMagic;
  Key key;
  Codec codec = Codec::Raw;
  std::uint64_t bytes = 0, stored_bytes = 0;
  std::uint64_t checksum = 0;  // of the header up to here, and of the stored bytes
};
static_assert(sizeof(Header) == 56 && std::has_unique_object_representations_v<Header>);

std::uint64_t checksumOf(Header header, std::span<const std::byte> stored) {
  header.checksum = bundle::checksum(stored);
  return bundle::checksum(std::as_bytes(std::span(&header, 1)));
}

// Returns the content of the file of an entry.
std::vector<std::byte> packEntry(const Key& key, std::span<const std::byte> bytes) {
  Header header{.key = key, .bytes = bytes.size(), .stored_bytes = bytes.size()};
  std::vector<std::byte> file;
  if (mayPay(bytes)) {
    file.resize(sizeof(Header) + ZSTD_compressBound(bytes.size()));
    const std::size_t compressed = ZSTD_compress(file.data() + sizeof(Header), file.size() - sizeof(Header),
                                                 bytes.data(), bytes.size(), kZstdLevel);
    if (pays(compressed, bytes.size())) {
      header.codec = Codec::Zstd;
      header.stored_bytes = compressed;
      file.resize(sizeof(Header) + compressed);
    }
  }
  if (header.codec == Codec::Raw) {
    file.resize(sizeof(Header));
    file.insert(file.end(), bytes.begin(), bytes.end());
  }
  header.checksum = checksumOf(header, std::span<const std::byte>(file).subspan(sizeof(Header)));
  std::memcpy(file.data(), &header, sizeof(Header));
  return file;
}

// Returns the whole file, and sets its time to now, since that is when it was last used.
std::optional<std::vector<std::byte>> readAndTouch(const fs::path& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = in ? std::streamoff{in.tellg()} : -1;
  if (size < 0) return std::nullopt;
  touch(path);
  std::vector<std::byte> bytes(static_cast<std::size_t>(size));
  in.seekg(0).read(reinterpret_cast<char*>(bytes.data()), size);
  if (in.gcount() != size) return std::nullopt;
  return bytes;
}

// Writes a file beside `path`, under a different name for each call, then renames it. Error: the system's
// reason.
Result<void> writeBeside(const fs::path& path, std::span<const std::byte> bytes) {
  static std::atomic<std::uint64_t> count = 0;
  fs::path part = path;
  part += kPartMark + std::to_string(::getpid()) + "-" + std::to_string(count++);
  std::ofstream out(part, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  // There is no fsync: a killed program loses nothing without it, and the checksum detects what a power cut
  // may spoil.
  out.close();
  touch(part);
  if (out && ::rename(part.c_str(), path.c_str()) == 0) return {};
  const std::string why = std::strerror(errno);
  ::unlink(part.c_str());
  return fail(path.string(), "cannot be written: " + why);
}

struct Listed {
  fs::path path;
  std::uint64_t bytes = 0;
  Time used;
};

// Lists the entries, oldest first. Removes files that killed programs left half written.
std::vector<Listed> list(const fs::path& folder) {
  std::vector<Listed> entries;
  std::error_code code;
  for (auto at = fs::recursive_directory_iterator(folder, code); !code && at != fs::end(at);
       at.increment(code)) {
    std::error_code gone;
    const std::uint64_t bytes = at->is_regular_file(gone) ? at->file_size(gone) : 0;
    if (gone || bytes == 0) continue;
    const Time used = at->last_write_time(gone);
    if (gone) continue;
    if (at->path().extension() == kExtension)
      entries.push_back({at->path(), bytes, used});
    else if (at->path().filename().string().find(std::string(kExtension) + kPartMark) != std::string::npos &&
             now() - used > kAbandoned)
      ::unlink(at->path().c_str());
  }
  std::ranges::sort(entries, [](const Listed& a, const Listed& b) {
    return a.used != b.used ? a.used < b.used : a.path < b.path;
  });
  return entries;
}

}  // namespace

std::optional<std::vector<std::byte>> unpackEntry(const Key& key, std::span<const std::byte> file) {
  if (file.size() < sizeof(Header)) return std::nullopt;
  Header header;
  std::memcpy(&header, file.data(), sizeof(Header));
  const auto stored = file.subspan(sizeof(Header));
  if (header.magic != kMagic || header.key != key || header.stored_bytes != stored.size() ||
      header.bytes > kMostBytes || header.checksum != checksumOf(header, stored))
    return std::nullopt;
  if (header.codec == Codec::Raw) {
    if (header.bytes != stored.size()) return std::nullopt;
    return std::vector<std::byte>(stored.begin(), stored.end());
  }
  if (header.codec != Codec::Zstd) return std::nullopt;
  std::vector<std::byte> bytes(static_cast<std::size_t>(header.bytes));
  if (ZSTD_decompress(bytes.data(), bytes.size(), stored.data(), stored.size()) != bytes.size())
    return std::nullopt;
  return bytes;
}

fs::path Cache::pathOf(const Key& key) const {
  const std::string hex = key.hex();
  return state_->folder / hex.substr(0, 2) / (hex.substr(2) + kExtension);
}

// Must be called with the lock held.
void Cache::makeRoom() {
  std::vector<Listed> entries = list(state_->folder);
  std::uint64_t sum = 0;
  for (const Listed& entry : entries) sum += entry.bytes;
  const auto most_bytes = static_cast<double>(state_->most_bytes);
  const auto wanted = static_cast<std::uint64_t>(kLeftAfterEviction * most_bytes);
  for (const Listed& entry : entries) {
    if (sum <= wanted || entry.used >= state_->bake_began.load()) break;
    if (::unlink(entry.path.c_str()) != 0) continue;
    sum -= entry.bytes;
    ++state_->figures.evicted;
  }
  state_->bytes = sum;
  // If all entries are in use, looking again after the next entry would be too early.
  state_->room_at = std::max(state_->most_bytes, sum + state_->most_bytes / 10);
}

fs::path Cache::defaultFolder() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return fs::path(value ? value : "");
  };
  if (const fs::path own = variable("LAMBENT_CACHE"); !own.empty()) return own == "off" ? fs::path() : own;
  // Relative paths do not count (XDG Base Directory Specification).
  if (const fs::path caches = variable("XDG_CACHE_HOME"); caches.is_absolute()) return caches / "lambent";
  if (const fs::path home = variable("HOME"); !home.empty()) return home / ".cache" / "lambent";
  return {};
}

Result<Cache> Cache::open(const fs::path& folder, std::uint64_t most_bytes) {
  std::error_code code, unreachable;
  fs::create_directories(folder, code);
  if (!fs::is_directory(folder, unreachable))
    return fail(folder.string(), "cannot be made a cache: " + (code ? code.message() : "it is no folder"),
                "name another folder with --cache, or --cache off");
  Cache cache;
  cache.state_->folder = folder;
  cache.state_->most_bytes = most_bytes;
  cache.beginBake();
  return cache;
}

std::optional<std::vector<std::byte>> Cache::find(const Key& key) const {
  if (!state_->reading) return std::nullopt;
  const fs::path path = pathOf(key);
  const auto file = readAndTouch(path);
  if (!file) return std::nullopt;
  auto bytes = unpackEntry(key, *file);
  if (!bytes) ::unlink(path.c_str());
  const std::lock_guard hold(state_->lock);
  ++(bytes ? state_->figures.found : state_->figures.damaged);
  if (bytes) state_->figures.bytes_read += file->size();
  return bytes;
}

bool Cache::has(const Key& key) const {
  return state_->reading && ::access(pathOf(key).c_str(), R_OK) == 0;
}

void Cache::put(const Key& key, std::span<const std::byte> bytes) {
  if (!state_->writing) return;
  const std::vector<std::byte> file = packEntry(key, bytes);
  const fs::path path = pathOf(key);
  std::error_code ignored;  // the error shows when the file is written
  fs::create_directory(path.parent_path(), ignored);
  const auto written = writeBeside(path, file);
  const std::lock_guard hold(state_->lock);
  if (!written) {
    state_->writing = false;
    if (state_->notice.empty())
      state_->notice = "cache: " + written.error().line() + "; the bake goes on and keeps nothing more in it";
    return;
  }
  ++state_->figures.stored;
  state_->figures.bytes_written += file.size();
  if (state_->bytes) *state_->bytes += file.size();
  if (!state_->bytes || *state_->bytes > state_->room_at) makeRoom();
}

void Cache::drop(const Key& key) {
  ::unlink(pathOf(key).c_str());
}

void Cache::beginBake() {
  state_->bake_began = now();
  checkpointed();
}

bool Cache::checkpointDue() const {
  return std::chrono::duration<double>(now() - state_->checkpoint.load()).count() >=
         state_->checkpoint_every_s;
}

void Cache::checkpointed() {
  state_->checkpoint = now();
}

CacheFigures Cache::figures() const {
  const std::lock_guard hold(state_->lock);
  return state_->figures;
}

std::string Cache::notice() const {
  const std::lock_guard hold(state_->lock);
  return state_->notice;
}

}  // namespace lambent::baker
