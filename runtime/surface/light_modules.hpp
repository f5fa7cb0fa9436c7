// Defines the modules that add light to surfaces. Each refers to what brings the light, which must outlive
// the frame.
#pragma once

#include <optional>

#include "runtime/bounces/patch_bounces.hpp"
#include "runtime/draws/surface_module.hpp"
#include "runtime/lighting/prefiltered_environment.hpp"
#include "runtime/shadows/key_shadows.hpp"
#include "runtime/shadows/local_shadows.hpp"
#include "runtime/surface/neighborhoods.hpp"
#include "runtime/surface/reflection_probes.hpp"

namespace lambent::frame {

// Adds lights that stand among the surfaces. LocalShadows::bind() must be called before the draws.
class LocalLightModule : public SurfaceModule {
 public:
  explicit LocalLightModule(const LocalShadows& shadows) : shadows_(shadows) {}
  std::span<const SurfaceFunction> functions() const override;
  std::span<const gpu::FindText> shaders() const override;
  bool reaches(std::size_t draw, const SurfaceDraw&) const override { return shadows_.lightsOf(draw) != 0; }
  std::uint64_t version() const override { return shadows_.version(); }
  void bind(SurfaceReceiver) const override {}

 private:
  const LocalShadows& shadows_;
};

// Adds key lights. KeyShadows::bind() must be called before the draws.
class KeyLightModule : public SurfaceModule {
 public:
  explicit KeyLightModule(const KeyShadows& shadows) : shadows_(shadows) {}
  std::span<const SurfaceFunction> functions() const override;
  std::span<const gpu::FindText> shaders() const override;
  bool reaches(std::size_t, const SurfaceDraw& record) const override {
    return shadows_.any() && record.unlit == 0;
  }
  std::uint64_t version() const override { return shadows_.any() ? 1 : 0; }
  void bind(SurfaceReceiver) const override {}

 private:
  const KeyShadows& shadows_;
};

// Adds light that patches bounce.
class BounceModule : public SurfaceModule {
 public:
  explicit BounceModule(const PatchBounces& bounces) : bounces_(bounces) {}
  std::span<const SurfaceFunction> functions() const override;
  std::span<const gpu::FindText> shaders() const override;
  bool reaches(std::size_t draw, const SurfaceDraw&) const override {
    return bounces_.wordOf(draw) != PatchBounces::kNothing;
  }
  std::uint64_t version() const override { return bounces_.layoutVersion(); }
  void describe(std::size_t draw, SurfaceDraw& record) const override {
    record.bounced_word = bounces_.wordOf(draw);
  }
  void bind(SurfaceReceiver receiver) const override {
    bounces_.bindStorage(isGlossy(receiver) ? kBindGlossyBounced : kBindBounced);
  }

 private:
  const PatchBounces& bounces_;
};

// Adds what bodies with grids change around them, per pixel.
class NeighborhoodModule : public SurfaceModule {
 public:
  NeighborhoodModule(const Neighborhoods& neighborhoods, const bool& shown)
      : neighborhoods_(neighborhoods), on_(shown) {}
  std::span<const SurfaceFunction> functions() const override;
  std::span<const gpu::FindText> shaders() const override;
  bool reaches(std::size_t draw, const SurfaceDraw&) const override {
    return on_ && neighborhoods_.receives(draw);
  }
  std::uint64_t version() const override { return on_ ? neighborhoods_.version() : 0; }
  void bind(SurfaceReceiver) const override { neighborhoods_.bind(); }

 private:
  const Neighborhoods& neighborhoods_;
  const bool& on_;
};

// Adds the same at vertices, for draws that have transfer of their own.
class VertexChangeModule : public SurfaceModule {
 public:
  VertexChangeModule(const Neighborhoods& neighborhoods, const bool& shown)
      : neighborhoods_(neighborhoods), on_(shown) {}
  std::span<const SurfaceFunction> functions() const override;
  std::span<const gpu::FindText> shaders() const override;
  bool reaches(std::size_t draw, const SurfaceDraw&) const override {
    return on_ && neighborhoods_.receivesAtVertices(draw);
  }
  std::uint64_t version() const override { return on_ ? neighborhoods_.version() : 0; }
  void bind(SurfaceReceiver) const override {
    neighborhoods_.bind();
    neighborhoods_.bindVertices();
  }

 private:
  const Neighborhoods& neighborhoods_;
  const bool& on_;
};

// Adds what mirrors show of the environment beyond the few bands of light, if it has been prefiltered and is
// shown.
class SpecularEnvironmentModule : public SurfaceModule {
 public:
  SpecularEnvironmentModule(const std::optional<lighting::PrefilteredEnvironment>& environment,
                            const bool& shown)
      : environment_(environment), on_(shown) {}
  std::span<const SurfaceFunction> functions() const override;
  std::span<const gpu::FindText> shaders() const override;
  bool reaches(std::size_t, const SurfaceDraw&) const override { return on_ && environment_.has_value(); }
  std::uint64_t version() const override { return on_ && environment_ ? 1 : 0; }
  void bind(SurfaceReceiver) const override { environment_->bind(); }

 private:
  const std::optional<lighting::PrefilteredEnvironment>& environment_;
  const bool& on_;
};

// Shows the room in mirrors, where reflection probes know it. It needs the specular environment, whose
// function is called before.
class ReflectionProbeModule : public SurfaceModule {
 public:
  ReflectionProbeModule(const ReflectionProbes& probes, const SpecularEnvironmentModule& environment)
      : probes_(probes), environment_(environment) {}
  std::span<const SurfaceFunction> functions() const override;
  std::span<const gpu::FindText> shaders() const override;
  bool reaches(std::size_t draw, const SurfaceDraw& record) const override {
    return probes_.shownBy(draw) && environment_.reaches(draw, record);
  }
  std::uint64_t version() const override { return probes_.layoutVersion() + environment_.version(); }
  void bind(SurfaceReceiver receiver) const override { probes_.bind(receiver); }

 private:
  const ReflectionProbes& probes_;
  const SpecularEnvironmentModule& environment_;
};

}  // namespace lambent::frame
