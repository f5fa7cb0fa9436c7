#include "runtime/surface/light_modules.hpp"

#include "lambent_bounces_embedded.hpp"
#include "runtime/surface/surfaces.hpp"

namespace lambent::frame {

namespace {

constexpr gpu::FindText kBounceShaders[] = {&embedded::lambent_bounces::find};

constexpr SurfaceFunction kLocal[] = {
    {SurfaceHook::Received, CalledBy::All, "local_surface.glsl", "addLocalLights"}};
constexpr SurfaceFunction kKey[] = {
    {SurfaceHook::Received, CalledBy::All, "key_surface.glsl", "addKeyLights"}};
constexpr SurfaceFunction kBounces[] = {
    {SurfaceHook::Vertex, CalledBy::Diffuse, "bounced_vertex.glsl", "addBounces"},
    {SurfaceHook::Gathered, CalledBy::Glossy, "bounced_corners.glsl", "addBounces"}};
constexpr SurfaceFunction kNeighborhoods[] = {
    {SurfaceHook::Received, CalledBy::Diffuse, "neighborhood_surface.glsl", "addNeighborhoods"},
    {SurfaceHook::Received, CalledBy::Glossy, "neighborhood_surface.glsl", "addReflectedNeighborhoods"}};
constexpr SurfaceFunction kVertexChange[] = {
    {SurfaceHook::Vertex, CalledBy::Diffuse, "neighborhood_vertex.glsl", "addVertexChange"}};
constexpr SurfaceFunction kSpecular[] = {
    {SurfaceHook::MirroredSky, CalledBy::Ggx, "specular_environment.glsl", "addSpecularEnvironment"},
    {SurfaceHook::MirroredSky, CalledBy::Layered, "specular_environment.glsl", "addLayeredEnvironment"}};

constexpr SurfaceFunction kProbes[] = {
    {SurfaceHook::MirroredSky, CalledBy::Ggx, "reflection_probes.glsl", "addGlossyProbes"},
    {SurfaceHook::MirroredSky, CalledBy::Layered, "reflection_probes.glsl", "addLayeredProbes"}};

}  // namespace

std::span<const SurfaceFunction> LocalLightModule::functions() const {
  return kLocal;
}
std::span<const gpu::FindText> LocalLightModule::shaders() const {
  return kShadowShaders;
}
std::span<const SurfaceFunction> KeyLightModule::functions() const {
  return kKey;
}
std::span<const gpu::FindText> KeyLightModule::shaders() const {
  return kShadowShaders;
}
std::span<const SurfaceFunction> BounceModule::functions() const {
  return kBounces;
}
std::span<const gpu::FindText> BounceModule::shaders() const {
  return kBounceShaders;
}
std::span<const SurfaceFunction> NeighborhoodModule::functions() const {
  return kNeighborhoods;
}
std::span<const gpu::FindText> NeighborhoodModule::shaders() const {
  return kSurfaceShaders;
}
std::span<const SurfaceFunction> VertexChangeModule::functions() const {
  return kVertexChange;
}
std::span<const gpu::FindText> VertexChangeModule::shaders() const {
  return kSurfaceShaders;
}
std::span<const SurfaceFunction> SpecularEnvironmentModule::functions() const {
  return kSpecular;
}
std::span<const gpu::FindText> SpecularEnvironmentModule::shaders() const {
  return kSurfaceShaders;
}
std::span<const SurfaceFunction> ReflectionProbeModule::functions() const {
  return kProbes;
}
std::span<const gpu::FindText> ReflectionProbeModule::shaders() const {
  return kSurfaceShaders;
}

}  // namespace lambent::frame
