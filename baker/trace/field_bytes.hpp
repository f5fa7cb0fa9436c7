// Direct transfer of ranges of samples as bytes to keep. Light of the environment has no colour before it is
// reflected, and that of grey lamps none either: what is the same for red, green and blue is kept once, so
// that what was traced stays good when a grey scene becomes a coloured one.
#pragma once

#include "baker/jobs/stage.hpp"
#include "baker/trace/transfer_field.hpp"

namespace lambent::baker {

// The direct transfer of a field as an output of a stage: its samples are the rows
// (rowOfItem).
// grey_lights: the columns after the environment's are the same in all channels.
Output directRows(TransferField& field, bool grey_lights, std::ptrdiff_t first_row = 0);

}  // namespace lambent::baker
