#include <system_error>

#include <dlfcn.h>

#include "baker/import/openimageio/module.hpp"

namespace lambent::baker {
namespace {

Result<const OpenImageIo*> load() {
  // It lies in ../lib of the program, in a build folder as where it is installed, or where the loader looks.
  constexpr const char *kFile = "liblambent-openimageio.so", *kSymbol = "lambent_openimageio";
  std::error_code ignored;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const std::filesystem::path beside = program.parent_path().parent_path() / "lib" / kFile;
  const bool is_beside = std::filesystem::exists(beside, ignored);
  void* module = ::dlopen(is_beside ? beside.c_str() : kFile, RTLD_NOW | RTLD_LOCAL);
  const char* why = module ? nullptr : ::dlerror();
  const void* symbol = module ? ::dlsym(module, kSymbol) : nullptr;
  if (!symbol)
    return fail(kFile, why ? why : "is not of this program", "install Lambent again, or build all of it");
  return static_cast<const OpenImageIo*>(symbol);
}

}  // namespace

Result<const OpenImageIo*> openImageIo() {
  static const Result<const OpenImageIo*> kModule = load();
  return kModule;
}

}  // namespace lambent::baker
