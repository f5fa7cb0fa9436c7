// Programs from GLSL text that lies in the binary. A stage is an entry file; `#include "file"` is resolved
// over the tables of embedded text that the caller names (each file once), `#version 450 core` and the
// defines come first. Errors name the shader's own file and line, whatever was included: the compiler's line
// numbers are mapped back.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/gpu/objects.hpp"

namespace lambent::gpu {

// A table made by lambent_embed: the text of a file by its name, empty if it is not there.
using FindText = std::string_view (*)(std::string_view);

struct Define {
  std::string name, value;
};

struct Stage {
  GLenum kind = GL_COMPUTE_SHADER;
  std::string_view file;
};

// A shader's text with its includes in place, and where each of its lines came from.
struct ShaderText {
  struct Origin {
    std::string file;
    int line = 0;
  };
  std::string text;
  std::vector<Origin> origins;  // of line i + 1
};
Result<ShaderText> assembleShader(std::string_view file, std::span<const FindText> tables,
                                  std::span<const Define> defines);
// The log with "FILE:LINE:" in place of the compiler's own positions.
std::string mapLog(std::string_view log, const ShaderText& shader);

struct ProgramTraits {
  static void destroy(GLuint id) { glDeleteProgram(id); }
};

class Program : public Handle<ProgramTraits> {
 public:
  Program() = default;
  static Result<Program> create(std::string_view label, std::initializer_list<Stage> stages,
                                std::span<const FindText> tables, std::span<const Define> defines = {});
  void use() const { glUseProgram(id()); }

 private:
  explicit Program(GLuint id) : Handle(id) {}
};

}  // namespace lambent::gpu
