// Makes programs from GLSL text that is embedded in the binary. Each stage has an entry file. The directive
// `#include "file"` is resolved with the caller's tables of embedded text, each file once. `#version 450
// core` and the defines are put first, with LAMBENT_VERTEX in vertex shaders, so that both stages of a
// program may share a file. Errors name the file and line of the shader's source, also in included files.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/gpu/objects.hpp"

namespace lambent::gpu {

// A table made by lambent_embed. It returns the text of a file, or an empty text if it does not have the
// file.
using FindText = std::string_view (*)(std::string_view);

struct Define {
  std::string name, value;
};

// Holds a file of GLSL that is not embedded but written by the program, for others to include.
struct WrittenFile {
  std::string name, text;
};

// Tells where shaders come from: tables of embedded text, then files that the caller wrote.
struct ShaderSources {
  std::span<const FindText> tables;
  std::span<const Define> defines{};
  std::span<const WrittenFile> written{};
};

struct Stage {
  GLenum kind = GL_COMPUTE_SHADER;
  std::string_view file;
};

// Holds the text of a shader with its includes, and the origin of each line.
struct ShaderText {
  struct Origin {
    std::string file;
    int line = 0;
  };
  std::string text;
  std::vector<Origin> origins;  // origins[i] is that of line i + 1
};
Result<ShaderText> assembleShader(std::string_view file, const ShaderSources& sources);
// Returns the compiler's log with its positions replaced by "FILE:LINE:".
std::string mapLog(std::string_view log, const ShaderText& shader);

struct ProgramTraits {
  static void destroy(GLuint id) { glDeleteProgram(id); }
};

class Program : public Handle<ProgramTraits> {
 public:
  Program() = default;
  static Result<Program> create(std::string_view label, std::initializer_list<Stage> stages,
                                const ShaderSources& sources);
  static Result<Program> create(std::string_view label, std::initializer_list<Stage> stages,
                                std::span<const FindText> tables, std::span<const Define> defines = {}) {
    return create(label, stages, ShaderSources{.tables = tables, .defines = defines, .written = {}});
  }
  void use() const { glUseProgram(id()); }

 private:
  explicit Program(GLuint id) : Handle(id) {}
};

// Programs compiles kernels and other programs when they are first needed, and keeps them.
class Programs {
 public:
  explicit Programs(std::span<const FindText> texts) : texts_(texts) {}

  // Makes the kernel of this entry file the current program. Fails if it does not compile on this device.
  Result<void> use(std::string_view file, std::vector<Define> defines = {}) {
    return use({{GL_COMPUTE_SHADER, file}}, std::move(defines));
  }
  Result<void> use(std::initializer_list<Stage> stages, std::vector<Define> defines = {});

 private:
  std::span<const FindText> texts_;
  std::map<std::string, Program, std::less<>> programs_;  // keyed by files and defines
};

// Holds the work of a compute pass as batches of work items. Each batch is one indirect dispatch whose items
// share all bindings (one arena page, one program). In the kernel, work group i = x + y * 65535 processes
// work[i] and does nothing if i >= work_count; OpenGL guarantees at most 65535 groups along x. A list that
// does not change is uploaded only once.
struct WorkItem {
  std::uint32_t record = 0;  // index of the record to process
  std::uint32_t first = 0;   // first element of the record for this work group
};

// Holds the program variant of a batch, followed by its pages.
using BatchKey = std::vector<std::uint32_t>;

class WorkList {
 public:
  static constexpr std::uint32_t kMaxGroupsX = 65535;

  explicit WorkList(std::string_view label) : buffer_(label) {}

  void clear() { batches_.clear(); }
  // Adds items for elements 0..count-1 of a record, with `group_size` elements per item.
  void add(const BatchKey& key, std::uint32_t record, std::uint32_t count, std::uint32_t group_size);
  bool empty() const { return batches_.empty(); }

  // Uploads the list if it differs from the last upload. Batches are ordered by their keys.
  void upload(Counters& counters);
  const std::map<BatchKey, std::vector<WorkItem>>& batches() const { return batches_; }
  // Binds and dispatches batch `index`. The caller has bound the program and its other buffers.
  void dispatch(std::size_t index, std::uint32_t binding, Counters& counters) const;

 private:
  std::map<BatchKey, std::vector<WorkItem>> batches_;
  std::vector<std::size_t> offsets_;  // offset of each batch's arguments in the buffer
  std::vector<std::byte> bytes_;      // the bytes of the last upload
  Table buffer_;
};

}  // namespace lambent::gpu
