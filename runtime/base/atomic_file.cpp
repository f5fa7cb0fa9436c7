#include "runtime/base/atomic_file.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <fstream>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace lambent {

namespace fs = std::filesystem;

namespace {

constexpr const char* kPart = ".part-";

// Returns whether the process that wrote this part is gone. Its lock tells where its id does not, as in a
// container that has ids of its own.
bool isAbandoned(const fs::path& part, ::pid_t writer) {
  if (::kill(writer, 0) == 0 || errno != ESRCH) return false;
  const int descriptor = ::open(part.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) return false;
  const bool unlocked = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  ::close(descriptor);
  return unlocked;
}

// Removes parts of this file that programs left behind when they were killed.
void removeAbandoned(const fs::path& path) {
  const std::string prefix = path.filename().string() + kPart;
  std::error_code failed;
  fs::directory_iterator at(path.has_parent_path() ? path.parent_path() : ".", failed);
  for (; !failed && at != fs::directory_iterator(); at.increment(failed)) {
    const std::string name = at->path().filename().string();
    if (!name.starts_with(prefix)) continue;
    ::pid_t writer = 0;
    const char* const end = name.data() + name.size();
    const auto [last, error] = std::from_chars(name.data() + prefix.size(), end, writer);
    if (error == std::errc{} && last == end && writer > 0 && isAbandoned(at->path(), writer))
      ::unlink(at->path().c_str());
  }
}

}  // namespace

AtomicFile::AtomicFile(fs::path path, fs::path part, int descriptor)
    : path_(std::move(path)), part_(std::move(part)), descriptor_(descriptor) {}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : path_(std::move(other.path_)),
      part_(std::move(other.part_)),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

AtomicFile& AtomicFile::operator=(AtomicFile&& other) noexcept {
  if (this != &other) {
    discard();
    path_ = std::move(other.path_);
    part_ = std::move(other.part_);
    descriptor_ = std::exchange(other.descriptor_, -1);
  }
  return *this;
}

AtomicFile::~AtomicFile() {
  discard();
}

void AtomicFile::discard() noexcept {
  if (descriptor_ < 0) return;
  ::close(std::exchange(descriptor_, -1));
  ::unlink(part_.c_str());
}

Result<AtomicFile> AtomicFile::open(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status there = fs::status(path, ignored);
  if (fs::is_directory(there)) return fail(path.string(), "is a folder", "name a file to write");
  // A rename would replace a device or a pipe by a plain file.
  if (fs::exists(there) && !fs::is_regular_file(there))
    return fail(path.string(), "is a device or a pipe", "name a file to write");
  removeAbandoned(path);
  fs::path part = path;
  part += kPart + std::to_string(::getpid());
  const int descriptor = ::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    const int why = errno;
    const fs::path folder = path.has_parent_path() ? path.parent_path() : ".";
    // A folder may be there and take no files, as /proc does.
    if (why == ENOENT && !fs::exists(folder, ignored))
      return fail(path.string(), "its folder does not exist", "create the folder first");
    return fail(path.string(), std::string("cannot be written: ") + std::strerror(why),
                "choose another place");
  }
  ::flock(descriptor, LOCK_EX | LOCK_NB);  // says that it is in use to those who cannot see this process
  return AtomicFile(path, std::move(part), descriptor);
}

Result<void> AtomicFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      return fail(path_.string(), std::string("cannot be written: ") + std::strerror(errno),
                  "free some space or choose another place");
    }
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return {};
}

Result<void> AtomicFile::write(const std::string& text) {
  return write(std::as_bytes(std::span(text)));
}

Result<void> AtomicFile::commit() {
  const bool synced =
      ::fsync(descriptor_) == 0 || errno == EINVAL || errno == EROFS;  // pipes have nothing to sync
  const bool closed = ::close(std::exchange(descriptor_, -1)) == 0;
  if (synced && closed && ::rename(part_.c_str(), path_.c_str()) == 0) return {};
  const int why = errno;
  ::unlink(part_.c_str());
  return fail(path_.string(), std::string("cannot be written: ") + std::strerror(why),
              "choose another place");
}

Result<void> writeFile(const fs::path& path, std::span<const std::byte> bytes) {
  Result<AtomicFile> file = AtomicFile::open(path);
  if (!file) return failAgain(std::move(file.error()));
  if (Result<void> written = file->write(bytes); !written) return written;
  return file->commit();
}

Result<void> checkRegularFile(const fs::path& path, const std::string& kind) {
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  if (status.type() == fs::file_type::not_found) return fail(path.string(), "no such file", "check the path");
  if (!fs::status_known(status))
    return fail(path.string(), "cannot be reached: " + code.message(), "check its permissions");
  if (fs::is_directory(status)) return fail(path.string(), "is a folder", "name " + kind);
  if (!fs::is_regular_file(status)) return fail(path.string(), "is a device or a pipe", "name " + kind);
  return {};
}

Result<std::string> readTextFile(const fs::path& path) {
  if (auto checked = checkRegularFile(path, "a file"); !checked) return failAgain(checked.error());
  std::ifstream in(path, std::ios::binary);
  if (!in) return fail(path.string(), "cannot be read", "check its permissions");
  // Its size at once, since growing would take three times as much.
  std::error_code unknown;
  std::string text;
  if (const auto bytes = fs::file_size(path, unknown); !unknown) text.reserve(bytes);
  std::array<char, 1 << 16> part;
  while (in.read(part.data(), part.size()), in.gcount() > 0)
    text.append(part.data(), static_cast<std::size_t>(in.gcount()));
  if (in.bad()) return fail(path.string(), "cannot be read", "check the disk");
  return text;
}

}  // namespace lambent
