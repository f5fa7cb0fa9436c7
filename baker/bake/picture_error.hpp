// Measures how wrong pictures show the surfaces of a group: relative RMS of the light that leaves them
// towards eyes, over real skies that the bake's bands carry, with the group's lamps as bright as in the file.
// At points that eyes see (picture_sums.hpp), the light that vertices, codes and interpolation show is
// compared with what many rays from the point itself find, all bounces included. What few bands cannot show,
// of light or of a highlight, is no part of it, and neither is the light of lamps on glossy surfaces, nor the
// detail of normal maps.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "baker/bake/group_scene.hpp"
#include "baker/bake/picture_sums.hpp"
#include "baker/cache/bytes.hpp"
#include "baker/compress/cpca.hpp"
#include "baker/effects/diffuse/bounces.hpp"
#include "baker/effects/diffuse/traced_points.hpp"
#include "baker/effects/glossy/traced_points.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

template <>
inline constexpr bool kPlainBytes<bundle::PictureError> = true;
inline void write(const bundle::PictureError& error, ByteWriter& out) {
  out.add(error);
}
inline bool read(ByteReader& in, bundle::PictureError& error) {
  return in.read(error);
}

// The same points, traced with as many rays as vertices, whose noise they tell, and with many. Null without
// surfaces of the kind in the group.
struct TracedView {
  View view;
  std::shared_ptr<TracedPoints> noisy, exact;
  std::shared_ptr<TracedGlossyPoints> noisy_glossy, exact_glossy;
};

// Matrices have `glossy_order` bands. Returns nothing if stopped. Without surfaces in sight, there are no
// points. No result is kept.
std::optional<TracedView> traceView(const DirectPass& vertices, int glossy_order, const TracedScene& scene,
                                    const Importance& importance, const BakeContext& context);

// What the bake knows of the vertices, and what bounces brought to the points: to the noisy ones, then to the
// exact ones. Without bounces, `bounced` is null and the list is empty; without glossy surfaces `glossy` and
// `brdfs` are null.
struct BakedVertices {
  const TransferField &direct, &mapped;  // of all samples, and of normal-mapped ones (DirectResult)
  const BounceResult* bounced;
  std::span<const TransferField> bounced_at_points;
  const GlossyField* glossy;
  const SurfaceBrdfs* brdfs;
  // These are SurfaceCells::cells. If null, codes do not count, as if they were exact.
  const std::vector<std::vector<CodedTransfer>>* cells;
};

// Returns nothing if too few points are seen for a figure.
std::optional<bundle::PictureError> measurePictureError(const TracedView& traced, const TracedScene& scene,
                                                        const BakedVertices& baked);

}  // namespace lambent::baker
