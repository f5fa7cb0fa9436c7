#include <string>
#include <system_error>

#include <dlfcn.h>
#include <link.h>

#include "baker/import/openimageio/module.hpp"
#include "runtime/base/process.hpp"

namespace lambent::baker {
namespace {

// Returns the file that holds this code: the program, or the library that another program has loaded.
std::filesystem::path ownFile() {
  Dl_info unused;
  link_map* file = nullptr;
  const auto* code = reinterpret_cast<const void*>(&ownFile);
  std::error_code ignored;
  if (::dladdr1(code, &unused, reinterpret_cast<void**>(&file), RTLD_DL_LINKMAP) != 0 && file &&
      file->l_name[0] != '\0')
    return std::filesystem::canonical(file->l_name, ignored);
  return ownProgram().value_or(std::filesystem::path());
}

Result<const OpenImageIo*> load() {
  // It lies beside the library, in ../lib of the program (in a build folder as where it is installed), or
  // where the loader looks.
  constexpr const char *kFile = "liblambent-openimageio.so", *kSymbol = "lambent_openimageio";
  const std::filesystem::path folder = ownFile().parent_path();
  std::string path = kFile;
  std::error_code ignored;
  for (const std::filesystem::path& beside : {folder / kFile, folder.parent_path() / "lib" / kFile})
    if (std::filesystem::exists(beside, ignored)) path = beside;
  void* module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
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
