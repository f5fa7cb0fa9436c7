// An X server without a screen (Xvfb), for tests of programs that open windows: started by the test itself on
// a display that the server picks (-displayfd), which it names once it takes connections, and ended with the
// test, even when that is killed. Two tests at a time never get the same display. No xvfb-run between, so a
// program's exit code and streams are its own.
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
  // Null where there is no Xvfb, or it does not start; why() says so then.
  static std::unique_ptr<XServer> start(std::string& why) {
    // A server that ends between two looks may leave its place half cleared: the next try finds another.
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

  // For the environment variable DISPLAY.
  const std::string& display() const { return display_; }

 private:
  static constexpr int kPatienceMs = 60'000;  // of a machine that does much else

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

  // In the child: only calls that are safe after a fork.
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

  // Until its end; empty where the server gave up.
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
