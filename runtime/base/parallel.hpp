// Work that falls into independent parts, on as many threads as it is worth. What comes out must not depend
// on which thread does which part, nor on how many there are.
#pragma once

#include <cstddef>
#include <functional>

namespace lambent {

// Calls part(i) for all i below count and returns when all are done. The caller works, too; a helper is
// called for each `worth` parts beyond the first as many, up to the number of processors (16 at most). Nobody
// waits for a helper that other programs keep from beginning. From any thread; parts must not throw.
void inParallel(std::size_t count, std::size_t worth, const std::function<void(std::size_t)>& part);

}  // namespace lambent
