// Threads for work that may wait for others, kept for the next such work: beginning a thread costs up to a
// millisecond of whoever asks for it, which is much of a frame.
#pragma once

#include <functional>

namespace lambent {

// Calls work() on a thread of its own, one that has nothing to do if there is any, at once and not after
// other work. work must end before the program does, and must not throw. From any thread.
void onKeptThread(std::function<void()> work);

}  // namespace lambent
