// Draws the surfaces of a world coloured by numbers of their coded transfer instead of their light, or their
// triangles as wires over the picture. It takes what is resident and the view, and draws into the bound
// framebuffer: false colours that are shown as they are (ToneMapper::run with as_is), or in linear pictures
// the numbers themselves. Each draw is issued by itself, since these pictures need not be fast. A DataView
// exists only while a view asks for it. Render thread only. Fails if a shader does not compile on this
// device.
#pragma once

#include <map>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/debug/data_view_shared.h"
#include "runtime/draws/surface_record.hpp"
#include "runtime/evaluate/transfer_values.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/surface/views.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

class DataView {
 public:
  // If `numbers` is set, pictures hold the numbers themselves.
  explicit DataView(bool numbers);

  // Computes the numbers that are not known yet.
  Result<void> update(World& world, const lighting::GroupLights& lights, const ViewChoice& choice,
                      evaluate::TransferMode mode, gpu::Counters& counters);
  // Draws colours and depth for a view of transfer. Blended surfaces are drawn as opaque ones.
  Result<void> draw(World& world, const spec::View& view, gpu::Counters& counters);
  // Draws wires over what is there; colours are premultiplied by alpha.
  Result<void> drawWires(World& world, const spec::View& view, gpu::Counters& counters);

  // Returns the legend of the last update().
  const ViewLegend& legend() const { return legend_; }
  const evaluate::TransferValues& values() const { return values_; }

 private:
  enum class Kind : std::uint8_t { Values, Clusters, Wires };
  Result<void> drawAll(World& world, const spec::View& view, Kind kind, gpu::Counters& counters);

  bool numbers_;
  evaluate::TransferValues values_;
  std::map<Kind, gpu::Program> programs_;
  gpu::Table draws_, data_draws_, view_;
  gpu::VertexArray no_vertices_;
  TextureUnits units_;
  ViewChoice choice_;
  ViewLegend legend_;
};

}  // namespace lambent::frame
