// The room baker/web_view shows a bundle in the browser, for `lambent view`. Files of the viewer, a bundle
// and an environment map come in, and a server on the loopback interface hands out these and nothing else.
// Its addresses are names in a table, so that no request can lead to another file. Errors are one line; the
// server runs on threads of its own until it is asked to stop.
#pragma once

#include <filesystem>
#include <map>
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

}  // namespace lambent::baker
