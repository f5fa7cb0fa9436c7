// Puts another function in place of one of OpenGL's, so that a driver fails as few here do: epoxy calls each
// through a pointer. While it lives, `function` is called instead, and before() is the driver's.
#pragma once

#include <utility>

#include <epoxy/gl.h>

namespace lambent::testing {

template <typename Function>
class GlSeam {
 public:
  // `place` is the name of the function, as glGetIntegerv.
  GlSeam(Function& place, Function function) : place_(place), before_(std::exchange(place, function)) {
    current() = before_;
  }
  ~GlSeam() { place_ = before_; }
  GlSeam(const GlSeam&) = delete;
  GlSeam& operator=(const GlSeam&) = delete;

  // Returns the function of the driver, for `function`, which can capture nothing.
  static Function& current() {
    static Function driver = nullptr;
    return driver;
  }

 private:
  Function& place_;
  Function before_;
};

// Leaves buffers of at least so many bytes without memory, as drivers do that have none left.
class FullGpu {
 public:
  static constexpr GLsizeiptr kRefusedBytes = GLsizeiptr{1} << 20;

 private:
  using Storage = decltype(glNamedBufferStorage);
  static void GLAPIENTRY store(GLuint buffer, GLsizeiptr bytes, const void* data, GLbitfield flags) {
    if (bytes < kRefusedBytes) GlSeam<Storage>::current()(buffer, bytes, data, flags);
  }
  GlSeam<Storage> seam_{glNamedBufferStorage, &store};
};

// Answers as a context does whose GPU was reset.
class LostContext {
  static GLenum GLAPIENTRY status() { return GL_INNOCENT_CONTEXT_RESET; }
  GlSeam<decltype(glGetGraphicsResetStatus)> seam_{glGetGraphicsResetStatus, &status};
};

// Answers as drivers do that have no storage blocks in vertex shaders.
class FewFeatures {
  using GetInteger = decltype(glGetIntegerv);
  static void GLAPIENTRY get(GLenum name, GLint* value) {
    GlSeam<GetInteger>::current()(name, value);
    if (name == GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS) *value = 0;
  }
  GlSeam<GetInteger> seam_{glGetIntegerv, &get};
};

}  // namespace lambent::testing
