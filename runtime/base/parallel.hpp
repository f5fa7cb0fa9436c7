// Runs independent parts of a task on several threads. The result must not depend on which thread runs which
// part, nor on the number of threads.
#pragma once

#include <cstddef>
#include <functional>

namespace lambent {

// Calls part(i) for all i below `count` and returns when all are done. The calling thread works, too. Each
// further `worth` parts get a helper thread, up to the number of processors and at most 16 threads. The call
// does not wait for helpers that have not started yet. It may be made from any thread. Parts must not throw.
void inParallel(std::size_t count, std::size_t worth, const std::function<void(std::size_t)>& part);

}  // namespace lambent
