// Serves files by HTTP to browsers on this machine.
#pragma once

#include <memory>
#include <stop_token>
#include <string>

#include "baker/web_view/viewer_files.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

// Answers GET and HEAD, also by ranges, at 127.0.0.1. It takes a request only if that names this address or
// localhost as its host: a page whose own name leads here (DNS rebinding) reads nothing.
class FileServer {
 public:
  // `files` are all there is to serve; "/" leads on to the address `start`. Port 0 takes one that is free.
  static Result<FileServer> bind(ServedFiles files, const std::string& start, int port);
  FileServer(FileServer&&) noexcept;
  FileServer& operator=(FileServer&&) noexcept;
  ~FileServer();

  // Returns "http://127.0.0.1:PORT/".
  std::string address() const;
  // Serves until it is asked to stop. Fails if the system ends it.
  Result<void> run(const std::stop_token& stop);

 private:
  struct State;
  explicit FileServer(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace lambent::baker
