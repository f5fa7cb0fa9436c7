// This is the output of the command line: the progress line on a terminal, errors as one line, and interrupts
// as stop requests.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "baker/cache/cache.hpp"
#include "baker/jobs/progress.hpp"
#include "baker/pipeline/whole_progress.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

// These return texts such as "1.2 M", "3.4 MiB" and "1:02".
std::string countText(double count);
std::string bytesText(double bytes);
std::string durationText(double seconds);

// Opens the cache in this folder, in the default one if it is empty, or none if it is "off". A bake without a
// cache is only slower, so a problem with the folder is reported and no error.
std::optional<Cache> openCache(const std::string& folder, std::uint64_t most_bytes = kCacheBytes);

// Prints "lambent: SUBJECT: PROBLEM; MEND" to stderr and returns the exit code 1.
int reportError(const Error& error);

// Prints "lambent: SUBJECT: SENTENCE" to stderr, for what a user should know though it is no error.
void reportNotice(const std::filesystem::path& subject, const std::string& sentence);

// Follows `progress` on stderr while it lives: the share of the whole, the stage, its rate and the time left.
// A terminal has one line that changes, and a log file gets a line every ten seconds. `seen_as` knows what
// stages will take.
class ProgressLine {
 public:
  ProgressLine(const Progress& progress, WholeProgress seen_as);
  ~ProgressLine();

 private:
  std::jthread thread_;
};

// While it lives, SIGINT and SIGTERM ask `stop` to stop, and a second one ends the program at once. Construct
// it before any thread, so that all of them inherit the blocked signals.
class InterruptGuard {
 public:
  explicit InterruptGuard(std::stop_source stop);
  ~InterruptGuard();

 private:
  std::jthread thread_;
};

}  // namespace lambent::baker
