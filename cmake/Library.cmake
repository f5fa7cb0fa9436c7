# The libraries that other programs link: lambent::sh, lambent::runtime and lambent::baker, each a shared library over the
# rooms, which shows the headers of its own folder `include` and hides all else. `cmake --install --component library`
# installs them with a CMake package and files for pkg-config (docs/library.md).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# The number rises when a program that was linked against an older library would not run with this one.
file(STRINGS "${PROJECT_SOURCE_DIR}/runtime/library/include/lambent/version.hpp" LAMBENT_ABI REGEX "^#define LAMBENT_ABI [0-9]+$")
string(REPLACE "#define LAMBENT_ABI " "" LAMBENT_ABI "${LAMBENT_ABI}")

# lambent_library(COMPONENT DESCRIPTION text SOURCES file... LINK_PRIVATE target... [NEEDS component...])
function(lambent_library component)
  cmake_parse_arguments(LIBRARY "" "DESCRIPTION" "SOURCES;LINK_PRIVATE;NEEDS" ${ARGN})
  set(target lambent_library_${component})
  add_library(${target} SHARED ${LIBRARY_SOURCES})
  add_library(lambent::${component} ALIAS ${target})
  list(TRANSFORM LIBRARY_NEEDS PREPEND lambent_library_ OUTPUT_VARIABLE needed)
  target_link_libraries(${target} PUBLIC ${needed} PRIVATE lambent_flags ${LIBRARY_LINK_PRIVATE})
  target_compile_features(${target} INTERFACE cxx_std_20)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  set_target_properties(${target} PROPERTIES
    OUTPUT_NAME lambent-${component} EXPORT_NAME ${component} VERSION ${PROJECT_VERSION} SOVERSION ${LAMBENT_ABI}
    LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib" INSTALL_RPATH "$ORIGIN" BUILD_WITH_INSTALL_RPATH ON
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  # The rooms are archives, whose symbols would show.
  target_link_options(${target} PRIVATE LINKER:--exclude-libs,ALL)
  if(NOT LAMBENT_SANITIZE)  # whose symbols come with the program
    target_link_options(${target} PRIVATE LINKER:--no-undefined)
  endif()

  set(package ${CMAKE_INSTALL_LIBDIR}/cmake/lambent)
  install(TARGETS ${target} EXPORT lambent-${component}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
  install(EXPORT lambent-${component} NAMESPACE lambent:: FILE lambent-${component}.cmake DESTINATION ${package} COMPONENT library)
  install(DIRECTORY include/lambent DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library)
  list(TRANSFORM LIBRARY_NEEDS PREPEND lambent- OUTPUT_VARIABLE LIBRARY_REQUIRES)
  string(JOIN " " LIBRARY_REQUIRES ${LIBRARY_REQUIRES})
  # The folder may be another than the one that was configured (--prefix), and may be moved.
  file(RELATIVE_PATH LIBRARY_PREFIX "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
  configure_file("${PROJECT_SOURCE_DIR}/cmake/library/lambent.pc.in" "${CMAKE_BINARY_DIR}/library/lambent-${component}.pc" @ONLY)
  install(FILES "${CMAKE_BINARY_DIR}/library/lambent-${component}.pc" DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT library)
endfunction()

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/library/lambentConfig.cmake.in"
  "${CMAKE_BINARY_DIR}/library/lambentConfig.cmake" INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/lambent)
write_basic_package_version_file("${CMAKE_BINARY_DIR}/library/lambentConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_BINARY_DIR}/library/lambentConfig.cmake" "${CMAKE_BINARY_DIR}/library/lambentConfigVersion.cmake"
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/lambent COMPONENT library)
