// Runs an X server without a screen (Xvfb), for tests of programs that open windows. The test starts it on a
// display that the server picks (-displayfd) and names once it accepts connections, and ends it even when the
// test is killed. Two concurrent tests never get the same display. xvfb-run is not used, so that exit code
// and streams are the program's own.
#pragma once

#include <array>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <string>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace lambent::testing {

class XServer {
 public:
  // Starts a server. Returns null if Xvfb is missing or does not start; `why` then says so.
  static std::unique_ptr<XServer> start(std::string& why) {
    // A server that ends at the wrong moment may leave its files half removed; the next try then finds
    // another display.
    for (int tries = 3; tries > 0; --tries)
      if (auto server = std::unique_ptr<XServer>(new XServer); server->begin(why)) return server;
    return nullptr;
  }
  ~XServer() {
    if (process_ <= 0) return;
    ::kill(process_, SIGTERM);
    ::waitpid(process_, nullptr, 0);
  }
  XServer(const XServer&) = delete;
  XServer& operator=(const XServer&) = delete;

  // Returns the value for the environment variable DISPLAY.
  const std::string& display() const { return display_; }

 private:
  static constexpr int kPatienceMs = 60'000;  // timeout, long enough for a busy machine

  XServer() = default;

  bool begin(std::string& why) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
      why = "no pipe to the X server";
      return false;
    }
    process_ = ::fork();
    if (process_ == 0) run(ends[1]);
    ::close(ends[1]);
    const std::string answer = lineFrom(ends[0]);
    ::close(ends[0]);
    int number = -1;
    std::from_chars(answer.data(), answer.data() + answer.size(), number);
    if (process_ > 0 && number >= 0) {
      display_ = ":" + std::to_string(number);
      return true;
    }
    why = "there is no Xvfb, or it does not start (Debian: xvfb)";
    return false;
  }

  // This runs in the child process, where only calls that are safe after a fork are allowed.
  [[noreturn]] static void run(int answer) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    constexpr int kAnswer = 3;
    if (answer == kAnswer)
      ::fcntl(answer, F_SETFD, 0);
    else
      ::dup2(answer, kAnswer);
    const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nowhere, stream);
    ::execlp("Xvfb", "Xvfb", "-displayfd", "3", "-screen", "0", "1800x1100x24", "-nolisten", "tcp",
             "-noreset", static_cast<char*>(nullptr));
    ::_exit(127);
  }

  // Reads a line until its end. It is empty if the server gave up.
  static std::string lineFrom(int end) {
    std::string line;
    for (char c = 0; c != '\n';) {
      ::pollfd waits{.fd = end, .events = POLLIN, .revents = 0};
      if (::poll(&waits, 1, kPatienceMs) <= 0 || ::read(end, &c, 1) != 1) return {};
      line += c;
    }
    return line;
  }

  ::pid_t process_ = -1;
  std::string display_;
};

}  // namespace lambent::testing
