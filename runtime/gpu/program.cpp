#include "runtime/gpu/program.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <optional>
#include <regex>
#include <set>
#include <sstream>

#include <fmt/format.h>

namespace lambent::gpu {

namespace {

struct Assembler {
  const ShaderSources& sources;
  ShaderText out;
  std::set<std::string, std::less<>> included;

  void addLine(std::string_view line, std::string_view file, int number) {
    out.text.append(line).push_back('\n');
    out.origins.push_back({std::string(file), number});
  }

  std::string_view find(std::string_view file) const {
    for (const FindText table : sources.tables)
      if (const std::string_view text = table(file); !text.empty()) return text;
    for (const WrittenFile& written : sources.written)
      if (written.name == file) return written.text;
    return {};
  }

  Result<void> addFile(std::string_view file, std::string_view from, int from_line) {
    if (!included.insert(std::string(file)).second) return {};
    std::string_view rest = find(file);
    if (rest.empty())
      return fail(from.empty() ? std::string(file) : fmt::format("{}:{}", from, from_line),
                  fmt::format("shader file \"{}\" is not embedded", file),
                  "add it to the room's lambent_embed");
    for (int number = 1; !rest.empty(); ++number) {
      const std::size_t end = rest.find('\n');
      const std::string_view line = rest.substr(0, end);
      rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
      if (const auto name = includedName(line)) {
        if (Result<void> added = addFile(*name, file, number); !added) return added;
      } else {
        addLine(line, file, number);
      }
    }
    return {};
  }

  static std::optional<std::string_view> includedName(std::string_view line) {
    const std::size_t start = line.find_first_not_of(" \t");
    if (start == std::string_view::npos || !line.substr(start).starts_with("#include")) return {};
    const std::size_t open = line.find('"');
    const std::size_t close = open == std::string_view::npos ? open : line.find('"', open + 1);
    if (close == std::string_view::npos) return {};
    const std::string_view name = line.substr(open + 1, close - open - 1);
    // A path is for C++ alone, in texts that both languages share; embedded files have names.
    if (name.find('/') != std::string_view::npos) return {};
    return name;
  }
};

// Returns the log of a shader or a program.
template <typename Get, typename GetLog>
std::string logOf(GLuint id, Get get, GetLog get_log) {
  GLint length = 0;
  get(id, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(length), '\0');
  get_log(id, length, &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  return log;
}

struct ShaderTraits {
  static void destroy(GLuint id) { glDeleteShader(id); }
};

}  // namespace

Result<ShaderText> assembleShader(std::string_view file, const ShaderSources& sources) {
  Assembler assembler{.sources = sources, .out = {}, .included = {}};
  assembler.addLine("#version 450 core", "<head>", 1);
  for (const Define& define : sources.defines)
    assembler.addLine(fmt::format("#define {} {}", define.name, define.value), "<head>", 1);
  if (Result<void> added = assembler.addFile(file, {}, 0); !added) return failAgain(added.error());
  return std::move(assembler.out);
}

std::string mapLog(std::string_view log, const ShaderText& shader) {
  // Drivers write before a message "0:12(5): error" (Mesa), "0(12) : error" (NVIDIA), or "ERROR: 0:12: ..."
  // (AMD, Apple). The column and the punctuation before the message are left out.
  static const std::regex kPosition("([^0]{0,8})0[:(]([0-9]{1,9}).*?(: [\\s\\S]*)");
  std::string mapped;
  std::istringstream lines{std::string(log)};
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) continue;
    if (!mapped.empty()) mapped += " | ";
    std::smatch found;
    const std::size_t number = std::regex_match(line, found, kPosition) ? std::stoul(found[2]) : 0;
    if (number >= 1 && number <= shader.origins.size()) {
      const ShaderText::Origin& origin = shader.origins[number - 1];
      mapped += fmt::format("{}{}:{}{}", found[1].str(), origin.file, origin.line, found[3].str());
    } else {
      mapped += line;
    }
  }
  return mapped;
}

Result<Program> Program::create(std::string_view label, std::initializer_list<Stage> stages,
                                const ShaderSources& sources) {
  Program program(glCreateProgram());
  for (const Stage& stage : stages) {
    std::vector<Define> defines(sources.defines.begin(), sources.defines.end());
    if (stage.kind == GL_VERTEX_SHADER) defines.push_back({"LAMBENT_VERTEX", "1"});
    const Result<ShaderText> shader = assembleShader(
        stage.file, {.tables = sources.tables, .defines = defines, .written = sources.written});
    if (!shader) return failAgain(shader.error());
    const Handle<ShaderTraits> object(glCreateShader(stage.kind));
    const char* text = shader->text.c_str();
    glShaderSource(object.id(), 1, &text, nullptr);
    glCompileShader(object.id());
    GLint done = 0;
    glGetShaderiv(object.id(), GL_COMPILE_STATUS, &done);
    if (!done)
      return fail(std::string(stage.file),
                  fmt::format("does not compile: {}",
                              mapLog(logOf(object.id(), glGetShaderiv, glGetShaderInfoLog), *shader)));
    glAttachShader(program.id(), object.id());
  }
  glLinkProgram(program.id());
  GLint done = 0;
  glGetProgramiv(program.id(), GL_LINK_STATUS, &done);
  if (!done)
    return fail(std::string(label),
                fmt::format("does not link: {}", logOf(program.id(), glGetProgramiv, glGetProgramInfoLog)));
  glObjectLabel(GL_PROGRAM, program.id(), static_cast<GLsizei>(label.size()), label.data());
  return program;
}

namespace {

// Batches start at multiples of a block, where any driver can bind a storage range. The first block holds the
// arguments of the dispatch. The list follows: its length, padding to 16 bytes, and the items.
constexpr std::size_t kBlockBytes = 256;
constexpr std::size_t kHeaderBytes = 16;

std::size_t listBytes(std::size_t item_count) {
  return kHeaderBytes + item_count * sizeof(WorkItem);
}

}  // namespace

void WorkList::add(const BatchKey& key, std::uint32_t record, std::uint32_t count, std::uint32_t group_size) {
  if (count == 0) return;
  std::vector<WorkItem>& items = batches_[key];
  for (std::uint64_t first = 0; first < count; first += group_size)
    items.push_back({record, static_cast<std::uint32_t>(first)});
}

void WorkList::upload(Counters& counters) {
  std::size_t end = 0;
  offsets_.clear();
  for (const auto& [key, items] : batches_) {
    offsets_.push_back(end);
    end += kBlockBytes + (listBytes(items.size()) + kBlockBytes - 1) / kBlockBytes * kBlockBytes;
  }
  std::vector<std::byte> bytes(end);
  std::size_t batch = 0;
  for (const auto& [key, items] : batches_) {
    const auto count = static_cast<std::uint32_t>(items.size());
    const std::uint32_t arguments[] = {std::min(count, kMaxGroupsX), (count + kMaxGroupsX - 1) / kMaxGroupsX,
                                       1};
    std::byte* at = bytes.data() + offsets_[batch++];
    std::memcpy(at, arguments, sizeof(arguments));
    std::memcpy(at + kBlockBytes, &count, sizeof(count));
    std::memcpy(at + kBlockBytes + kHeaderBytes, items.data(), items.size() * sizeof(WorkItem));
  }
  if (bytes == bytes_) return;
  bytes_ = std::move(bytes);
  buffer_.assignBytes(bytes_);
  counters.uploaded_bytes += bytes_.size();
}

void WorkList::dispatch(std::size_t index, std::uint32_t binding, Counters& counters) const {
  assert(index < offsets_.size());
  const std::size_t item_count =
      std::next(batches_.begin(), static_cast<std::ptrdiff_t>(index))->second.size();
  glBindBufferRange(GL_SHADER_STORAGE_BUFFER, binding, buffer_.buffer().id(),
                    static_cast<GLintptr>(offsets_[index] + kBlockBytes),
                    static_cast<GLsizeiptr>(listBytes(item_count)));
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, buffer_.buffer().id());
  glDispatchComputeIndirect(static_cast<GLintptr>(offsets_[index]));
  ++counters.dispatches;
}

Result<void> Programs::use(std::initializer_list<Stage> stages, std::vector<Define> defines) {
  std::string label;
  for (const Stage& stage : stages) label += fmt::format("{}{}", label.empty() ? "" : " ", stage.file);
  for (const Define& define : defines) label += fmt::format(" {} {}", define.name, define.value);
  auto found = programs_.find(label);
  if (found == programs_.end()) {
    Result<Program> made = Program::create(label, stages, texts_, defines);
    if (!made) return failAgain(made.error());
    found = programs_.emplace(label, std::move(*made)).first;
  }
  found->second.use();
  return {};
}

}  // namespace lambent::gpu
