// Checks that what a program printed has arrived.
#pragma once

#include "runtime/base/result.hpp"

namespace lambent {

// Flushes standard output. Fails if any of it could not be written, because a full disk or a closed file
// shows only now.
Result<void> flushStandardOutput();

}  // namespace lambent
