#include "runtime/base/atomic_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace lambent {

namespace fs = std::filesystem;

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
  fs::path part = path;
  part += ".part-" + std::to_string(::getpid());
  const int descriptor = ::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    if (errno == ENOENT) return fail(path.string(), "its folder does not exist", "create the folder first");
    return fail(path.string(), std::string("cannot be written: ") + std::strerror(errno),
                "choose another place");
  }
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

Result<std::string> readTextFile(const fs::path& path) {
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  if (!fs::exists(status)) return fail(path.string(), "no such file", "check the path");
  if (fs::is_directory(status)) return fail(path.string(), "is a folder", "name a file");
  std::ifstream in(path, std::ios::binary);
  if (!in) return fail(path.string(), "cannot be read", "check its permissions");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) return fail(path.string(), "cannot be read", "check the disk");
  return text;
}

}  // namespace lambent
