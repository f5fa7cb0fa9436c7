// The room baker/web_view shows a bundle in the browser, for `lambent view`. Files of the viewer, a bundle
// and an environment map come in, and a server on the loopback interface hands out these and nothing else.
// Its addresses are names in a table, so that no request can lead to another file. Errors are one line; the
// server has threads of its own.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <stop_token>
#include <string>

#include "runtime/base/result.hpp"

namespace lambent::baker {

// Files by the path of their address, as "/viewer/index.html".
using ServedFiles = std::map<std::string, std::filesystem::path>;

// Finds what the viewer loads: viewer/files.txt in `web` lists it.
Result<ServedFiles> viewerFiles(const std::filesystem::path& web);

// Returns share/lambent/web beside the folder of this program. In a build folder it is a link to the sources.
Result<std::filesystem::path> findWebFolder();

// Asks xdg-open to show an address and does not wait for it. Returns false where there is no display or no
// xdg-open. An interrupt from the terminal does not reach the browser.
bool openBrowser(const std::string& address);

// Serves files by HTTP to browsers on this machine: answers GET and HEAD, also by ranges, at 127.0.0.1. It
// takes a request only if that names this address or localhost as its host: a page whose own name leads here
// (DNS rebinding) reads nothing. `files` are all there is to serve; "/" leads on to the address `start`. Port
// 0 takes one that is free. Calls began("http://127.0.0.1:PORT/") once the port is taken, and serves until it
// is asked to stop. Fails if there is no such port, or if the system ends it.
Result<void> serveFiles(const ServedFiles& files, const std::string& start, int port,
                        const std::function<void(const std::string& address)>& began,
                        const std::stop_token& stop);

}  // namespace lambent::baker
