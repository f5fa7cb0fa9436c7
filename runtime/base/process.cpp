#include "runtime/base/process.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <system_error>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#if __has_include(<malloc.h>)
#include <malloc.h>
#endif

namespace lambent {

namespace {

constexpr int kLookForStopMs = 100;

// A Pipe closes what is still open of it.
struct Pipe {
  std::array<int, 2> ends{-1, -1};

  Pipe() {
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) ends = {-1, -1};
  }
  ~Pipe() {
    close(0);
    close(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  bool open() const { return ends[0] >= 0; }
  void close(std::size_t end) {
    if (ends[end] >= 0) ::close(ends[end]);
    ends[end] = -1;
  }
};

// Starts the program with no signal blocked: lambent blocks those that it waits for, and a child inherits
// that.
int start(const std::filesystem::path& program, const std::vector<std::string>& words, const Pipe& out,
          const Pipe& err, ::pid_t& id) {
  std::vector<std::string> all = {program.string()};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> argv;
  for (std::string& word : all) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, out.ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, err.ends[1], STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  const int failed = posix_spawn(&id, program.c_str(), &files, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return failed;
}

// Reads both pipes until the program closes them, and asks it to end once `stop` is requested.
void collect(Pipe& out, Pipe& err, ::pid_t id, const std::stop_token& stop, std::string& out_text,
             std::string& err_text) {
  bool asked = false;
  std::array<char, 1 << 14> bytes;
  while (out.ends[0] >= 0 || err.ends[0] >= 0) {
    std::array<pollfd, 2> waits = {pollfd{out.ends[0], POLLIN, 0}, pollfd{err.ends[0], POLLIN, 0}};
    ::poll(waits.data(), waits.size(), kLookForStopMs);
    if (stop.stop_requested() && !asked) {
      ::kill(id, SIGTERM);
      asked = true;
    }
    for (std::size_t i = 0; i < waits.size(); ++i) {
      Pipe& pipe = i == 0 ? out : err;
      if (pipe.ends[0] < 0 || waits[i].revents == 0) continue;
      const ssize_t count = ::read(pipe.ends[0], bytes.data(), bytes.size());
      if (count > 0)
        (i == 0 ? out_text : err_text).append(bytes.data(), static_cast<std::size_t>(count));
      else if (count == 0 || errno != EINTR)
        pipe.close(0);
    }
  }
}

double secondsOf(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

std::string lastLine(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  const std::size_t before = text.rfind('\n');
  return before == std::string::npos ? text : text.substr(before + 1);
}

}  // namespace

Result<Ran> runToAnyEnd(const std::filesystem::path& program, const std::vector<std::string>& words,
                        const std::stop_token& stop) {
  const std::string name = program.filename().string();
  Pipe out, err;
  if (!out.open() || !err.open())
    return fail(name, "cannot be started: there are too many open files", "see ulimit -n");
  ::pid_t id = -1;
  if (const int failed = start(program, words, out, err, id); failed != 0)
    return fail(program.string(), "cannot be started: " + std::generic_category().message(failed));
  out.close(1);
  err.close(1);
  std::string out_text, err_text;
  collect(out, err, id, stop, out_text, err_text);
  int status = 0;
  rusage used{};
  while (::wait4(id, &status, 0, &used) < 0 && errno == EINTR) {
  }
  if (stop.stop_requested()) return fail(name, "stopped", "run it again, and it goes on from where it was");
  if (!WIFEXITED(status)) return fail(name, "was ended by signal " + std::to_string(WTERMSIG(status)));
  return Ran{std::move(out_text), std::move(err_text), WEXITSTATUS(status),
             secondsOf(used.ru_utime) + secondsOf(used.ru_stime)};
}

Result<Ran> runProgram(const std::filesystem::path& program, const std::vector<std::string>& words,
                       const std::stop_token& stop) {
  Result<Ran> ran = runToAnyEnd(program, words, stop);
  if (!ran || ran->exit_code == 0) return ran;
  const std::string name = program.filename().string(), said = lastLine(ran->err);
  if (!said.empty()) return fail(name + (words.empty() ? "" : " " + words.front()), "failed: " + said);
  return fail(name, "ended with code " + std::to_string(ran->exit_code));
}

namespace fs = std::filesystem;

Result<fs::path> ownProgram() {
  std::error_code failed;
  fs::path program = fs::read_symlink("/proc/self/exe", failed);
  if (failed) return fail("/proc/self/exe", "does not name this program: " + failed.message());
  return program;
}

std::vector<fs::path> sampleFolders(const fs::path& program) {
  std::vector<fs::path> folders;
  std::error_code ignored;
  const fs::path above = program.parent_path().parent_path();
  for (const char* place : {"share/lambent/scenes", "share/lambent/probes", "assets"})
    if (fs::is_directory(above / place, ignored)) folders.push_back(above / place);
  return folders;
}

namespace {

struct Pages {
  std::uint64_t reserved = 0, resident = 0;
};

Pages pagesNow() {
  std::ifstream file("/proc/self/statm");
  Pages pages;
  file >> pages.reserved >> pages.resident;
  return pages;
}

std::uint64_t bytesOf(std::uint64_t pages) {
  const long page_bytes = ::sysconf(_SC_PAGESIZE);
  return page_bytes > 0 ? pages * static_cast<std::uint64_t>(page_bytes) : 0;
}

}  // namespace

std::uint64_t addressSpaceBytes() {
  return bytesOf(pagesNow().reserved);
}

std::uint64_t residentBytes() {
  return bytesOf(pagesNow().resident);
}

std::uint64_t peakBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::uint64_t{1024} * static_cast<std::uint64_t>(usage.ru_maxrss);
}

void returnFreedMemory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

std::uint64_t machineBytes() {
  const long pages = ::sysconf(_SC_PHYS_PAGES);
  return pages > 0 ? bytesOf(static_cast<std::uint64_t>(pages)) : 0;
}

Result<void> flushStandardOutput() {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return {};
  const int why = errno;
  return fail("standard output",
              std::string("cannot be written") + (why != 0 ? std::string(": ") + std::strerror(why) : ""),
              "free some space or send it elsewhere");
}

}  // namespace lambent
