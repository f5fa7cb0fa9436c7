// Draws the surfaces of a world as numbers of their coded transfer, in place of their light, or their
// triangles as wires over the picture. Comes in: what is resident, and the view. Goes out: the bound
// framebuffer; in pictures for the eye false colours that are meant to be shown as they are (ToneMapper::run
// with as_is), in linear ones the numbers. Draws one by one: these pictures are looked at, not timed. It is
// made when a view asks for it first and thrown away when none does. Render thread only. Errors: shaders that
// do not compile on this device.
#pragma once

#include <map>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/debug/data_view_shared.h"
#include "runtime/draws/surface_record.hpp"
#include "runtime/draws/texture_units.hpp"
#include "runtime/effects/diffuse/transfer_values.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/surface/views.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

class DataView {
 public:
  // numbers: pictures hold the numbers themselves.
  explicit DataView(bool numbers);

  // Works out the numbers where they are not known yet.
  Result<void> update(World& world, const lighting::GroupLights& lights, const ViewChoice& choice,
                      effects::diffuse::TransferMode mode, gpu::Counters& counters);
  // Colours and depth, for a view of transfer. Opaque, blended surfaces too.
  Result<void> draw(World& world, const spec::View& view, gpu::Counters& counters);
  // Over what is there, colours times alpha.
  Result<void> drawWires(World& world, const spec::View& view, gpu::Counters& counters);

  // As the last update() left it.
  const ViewLegend& legend() const { return legend_; }
  const effects::diffuse::TransferValues& values() const { return values_; }

 private:
  enum class Kind : std::uint8_t { Values, Clusters, Wires };
  Result<void> drawAll(World& world, const spec::View& view, Kind kind, gpu::Counters& counters);

  bool numbers_;
  effects::diffuse::TransferValues values_;
  std::map<Kind, gpu::Program> programs_;
  gpu::Table draws_, data_draws_, view_;
  gpu::VertexArray no_vertices_;
  TextureUnits units_;
  ViewChoice choice_;
  ViewLegend legend_;
};

}  // namespace lambent::frame
