// Measures how wrong pictures show the surfaces of a group: relative RMS of the light that leaves them
// towards eyes, over real skies that the bake's bands carry, with the group's lamps as bright as in the file.
// At points that eyes see (ViewPoints), the light that vertices, codes and interpolation show is
// compared with what many rays from the point itself find, all bounces included. What few bands cannot show,
// of light or of a highlight, is no part of it, and neither is the light of lamps on glossy surfaces, nor the
// detail of normal maps.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "baker/bake/group_scene.hpp"
#include "baker/cache/key.hpp"
#include "baker/compress/cpca.hpp"
#include "baker/effects/surface/bounces.hpp"
#include "baker/effects/surface/inside_faces.hpp"
#include "baker/importance/importance.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

template <>
inline constexpr bool kPlainBytes<bundle::PictureError> = true;

// Chooses points of a group's surfaces as eyes see them (baker/importance), to measure there how wrong
// pictures are.
struct ViewPoints {
  FacePoints points;                // in the order of the eyes
  std::vector<glm::vec3> weights;   // of the corners of each point's triangle
  std::vector<glm::vec3> to_eyes;   // unit directions
  std::vector<std::uint32_t> eyes;  // the eye that sees each point, rising
  std::uint32_t stands_for = 1;     // so many points that are seen
};

struct View {
  std::vector<float> eye_weights;  // shares of all pictures
  ViewPoints diffuse;              // and normal-mapped
  ViewPoints glossy;               // at most a few hundred, since their rays are dear
};

// The same points, traced with as many rays as vertices, whose noise they tell, and with many. Null without
// surfaces of the kind in the group.
struct TracedView {
  View view;
  std::unique_ptr<TracedPoints> noisy, exact, noisy_glossy, exact_glossy;
};

// Matrices have `glossy_order` bands. Returns nothing if stopped. Without surfaces in sight, there are no
// points. No result is kept.
std::optional<TracedView> traceView(const DirectPass& vertices, int glossy_order, const TracedScene& scene,
                                    const Importance& importance, const BakeContext& context);

// Holds what the bake knows of the vertices. Without bounces `bounced` is null, without glossy surfaces
// `brdfs` is.
struct BakedVertices {
  const DirectResult& direct;
  const BounceResult* bounced;
  const SurfaceBrdfs* brdfs;
  // These are SurfaceCells::cells. If null, codes do not count, as if they were exact.
  const std::vector<std::vector<CodedTransfer>>* cells;
};

// Returns nothing if too few points are seen for a figure.
std::optional<bundle::PictureError> measurePictureError(const TracedView& traced, const TracedScene& scene,
                                                        const BakedVertices& baked);

}  // namespace lambent::baker
