# The least versions that Lambent builds with, all in this one place: those of Debian 12. Rooms look for what they use without
# a version; they find what was found here.
set(LAMBENT_PACKAGES
  "fmt 9.1" "glm 0.9.9.8" "nlohmann_json 3.11" "tl-expected 1.0" "CLI11 2.1" "draco 1.5" "glfw3 3.3"  # runtime
  "embree 3.13" "TBB 2021.8" "Eigen3 3.4" "meshoptimizer 0.18")                                      # baker
set(LAMBENT_PKG_CONFIG_MODULES
  "libzstd 1.5" "libxxhash 0.8" "OpenEXR 3.1" "epoxy 1.5"  # runtime
  "OpenImageIO 2.4"                                        # baker
  "imgui 1.86")                                            # editor

macro(lambent_check_version name found least)
  if("${found}" STREQUAL "")
    message(FATAL_ERROR "lambent: ${name} says no version; Lambent needs ${least} or newer")
  elseif("${found}" VERSION_LESS "${least}")
    message(FATAL_ERROR "lambent: ${name} ${found} is too old; Lambent needs ${least} or newer")
  endif()
endmacro()

foreach(package ${LAMBENT_PACKAGES})
  string(REPLACE " " ";" package "${package}")
  list(GET package 0 name)
  list(GET package 1 least)
  find_package(${name} REQUIRED)
  lambent_check_version(${name} "${${name}_VERSION}" ${least})
endforeach()
find_package(PkgConfig REQUIRED)
foreach(module ${LAMBENT_PKG_CONFIG_MODULES})
  string(REPLACE " " ";" module "${module}")
  list(GET module 0 name)
  list(GET module 1 least)
  pkg_check_modules(FOUND_${name} QUIET REQUIRED ${name})
  lambent_check_version(${name} "${FOUND_${name}_VERSION}" ${least})
endforeach()
