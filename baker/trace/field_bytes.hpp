// Packs direct transfer of ranges of samples into bytes. Light of the environment has no colour before it is
// reflected, unless it passes coloured panes, nor has that of grey lamps: what is the same for red, green and
// blue is kept once, so that traced results stay valid when a grey scene becomes a coloured one.
#pragma once

#include "baker/jobs/stage.hpp"
#include "baker/trace/transfer_field.hpp"

namespace lambent::baker {

// Says which columns are the same in all channels: those of the environment, and those after them.
struct GreyColumns {
  bool sky, lights;
};

// Returns the direct transfer of a field as an output of a stage; its rows (rowOfItem) are samples.
Output directRows(TransferField& field, GreyColumns grey, std::ptrdiff_t first_row = 0);

}  // namespace lambent::baker
