// Runs parallel loops by TBB that can be stopped. Work is cut into fixed ranges, so that a result which is a
// function of the range alone is the same for any number of threads.
#pragma once

#include <cstddef>
#include <functional>
#include <stop_token>

namespace lambent::baker {

// Calls body(begin, end) over [0, count) in ranges of `grain` (the last may be shorter). Ranges that have not
// begun when a stop is requested are left out; returns false then.
bool parallelRanges(std::size_t count, std::size_t grain, const std::stop_token& stop,
                    const std::function<void(std::size_t begin, std::size_t end)>& body);

// Runs `job` with at most `threads` threads in every parallel loop inside it. 0, or more than the machine
// has, means all of the machine.
void withThreads(unsigned threads, const std::function<void()>& job);

// Does the same for work that runs beside something interactive: the limit holds for this job alone, and its
// loops give way to those of other threads. 0 means all of the machine but one, and at least one.
void inBackground(unsigned threads, const std::function<void()>& job);

}  // namespace lambent::baker
