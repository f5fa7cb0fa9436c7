#include "baker/cache/entry_file.hpp"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

#include "baker/cache/bytes.hpp"
#include "runtime/bundle/container.hpp"

namespace lambent::baker {

namespace {

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

class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags)
      : fd_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  bool close() { return ::close(std::exchange(fd_, -1)) == 0; }

 private:
  int fd_;
};

// This clock is common to all processes, and finer than the one with which the system stamps files.
void touch(int descriptor) {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  const std::array<timespec, 2> times = {now, now};
  // This fails in a folder without write permission, but there nothing is evicted either.
  ::futimens(descriptor, times.data());
}

}  // namespace

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

tl::expected<std::vector<std::byte>, ReadFailure> readAndTouch(const std::filesystem::path& path) {
  const Descriptor file(path, O_RDONLY);
  if (file.get() < 0) return tl::unexpected(errno == ENOENT ? ReadFailure::Absent : ReadFailure::Unreadable);
  struct stat status {};
  if (::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode))
    return tl::unexpected(ReadFailure::Unreadable);
  touch(file.get());
  std::vector<std::byte> bytes(static_cast<std::size_t>(status.st_size));
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t got = ::read(file.get(), bytes.data() + at, bytes.size() - at);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return tl::unexpected(ReadFailure::Unreadable);
    at += static_cast<std::size_t>(got);
  }
  return bytes;
}

Result<void> writeBeside(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  static std::atomic<std::uint64_t> count = 0;
  std::filesystem::path part = path;
  part += kPartMark + std::to_string(::getpid()) + "-" + std::to_string(count++);
  const auto failed = [&] {
    const std::string why = std::strerror(errno);
    ::unlink(part.c_str());
    return fail(path.string(), "cannot be written: " + why);
  };
  Descriptor file(part, O_WRONLY | O_CREAT | O_TRUNC);
  if (file.get() < 0) return failed();
  while (!bytes.empty()) {
    const ssize_t written = ::write(file.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return failed();
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  touch(file.get());
  // There is no fsync: a killed program loses nothing without it, and the checksum detects what a power cut
  // may spoil.
  if (!file.close() || ::rename(part.c_str(), path.c_str()) != 0) return failed();
  return {};
}

}  // namespace lambent::baker
