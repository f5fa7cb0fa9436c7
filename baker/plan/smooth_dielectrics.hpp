// Measures how much of a highlight few bands can represent.
#pragma once

#include <glm/vec3.hpp>

#include "runtime/bundle/gltf_types.hpp"

namespace lambent::baker {

// Returns the share of the energy (integral of the square over directions) of the GGX lobe times cosine, seen
// along the normal, that lies in the first `order` bands: near 1 for rough surfaces, towards 0 for mirrors.
// Roughness is glTF's, 0..1.
double lobeEnergyShare(double roughness, int order);

// Decides which surfaces get transfer matrices. Matrices give highlights in a few bands. What a dielectric
// reflects is little beside its diffuse light, and few bands blur what a smooth one reflects, so such a
// surface has diffuse transfer, and the runtime adds a specular layer: the prefiltered environment, hidden as
// far as the transfer knows (docs/design/glossy.md, "Smooth dielectrics").

// Returns whether the material is a smooth dielectric: a GGX layer without direction over a diffuse base, for
// which five bands carry too little of the highlight. A texture of roughness can only make it smoother.
bool isSmoothDielectric(const gltf::Material& material);

// Returns whether surfaces of the material have matrices where the glossy effect is baked.
bool hasMatrices(const gltf::Material& material);

// Returns F0 of a dielectric, without textures.
glm::vec3 reflectedStraightOn(const gltf::Material& material);

// Returns the mean share of light from everywhere that the layer of a smooth dielectric reflects, 0..1.
glm::vec3 meanSpecularAlbedo(const gltf::Material& material);

// Returns the share of light from everywhere that leaves a surface of this base colour, each 0..1, under a
// layer with this mean albedo. The base gets what the layer lets through in the channel where that is least.
glm::vec3 albedoUnderLayer(const glm::vec3& base_color, const glm::vec3& layer);
// Returns the base colour that has this albedo under the layer.
glm::vec3 baseUnderLayer(const glm::vec3& albedo, const glm::vec3& layer);

}  // namespace lambent::baker
