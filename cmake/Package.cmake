# What `cmake --install` and `cpack` put together (docs/packaging.md): the component runtime, lambent-demo with a scene and
# skies to show, and the component tools, lambent and, where it is built, lambent-editor. Both carry their libraries.

set(LAMBENT_PACKAGE_SCENE gallery CACHE STRING "Sample scene that the runtime package shows; baked while packing")
set(LAMBENT_RUNTIME_PROGRAMS lambent-demo)
set(LAMBENT_TOOL_PROGRAMS lambent lambent-editor)

# Left to the system, and not looked into: the loader, glibc and the compiler's libraries must be as new as the newest user in
# the process, and that may be the OpenGL driver; zlib is everywhere.
set(LAMBENT_SYSTEM_LIBRARIES "^ld-linux" "^lib(c|m|dl|pthread|rt|resolv|util|anl|mvec)\\.so" "^lib(stdc\\+\\+|gcc_s|z)\\.so")
# And what a program shares with the driver and the display server. Whoever shows something must take the system's; lambent
# never does, only what reads its pictures links these, and so it has them in a folder that no other program looks into.
set(LAMBENT_DISPLAY_LIBRARIES
  "^lib(GL|EGL|OpenGL|GLX|GLdispatch|GLESv2|glapi|gbm|drm)[-_a-z0-9]*\\.so" "^libudev\\.so"
  "^lib(X11|Xau|Xdmcp|Xext|Xfixes|Xrender|Xrandr|Xi|Xcursor|Xinerama|xcb|xkbcommon|wayland|bsd|md)[-_a-zA-Z0-9]*\\.so")
set(LAMBENT_HEADLESS_PROGRAMS lambent)
set_target_properties(${LAMBENT_HEADLESS_PROGRAMS} PROPERTIES INSTALL_RPATH "$ORIGIN/../lib;$ORIGIN/../lib/headless")

# Debian's names of what leaves no library behind, only code in the programs.
set(LAMBENT_COMPILED_INTO_runtime libcli11-dev libexpected-dev libglm-dev libstb-dev nlohmann-json3-dev)
set(LAMBENT_COMPILED_INTO_tools ${LAMBENT_COMPILED_INTO_runtime} libeigen3-dev libimgui-dev)

# lambent_package(COMPONENT target...): programs to bin/, what they link to lib/.
function(lambent_package component)
  set(programs "")
  set(headless "")
  foreach(target ${ARGN})
    if(TARGET ${target})
      install(TARGETS ${target} RUNTIME DESTINATION bin COMPONENT ${component})
      list(APPEND programs "$<TARGET_FILE:${target}>")
      if(target IN_LIST LAMBENT_HEADLESS_PROGRAMS)
        list(APPEND headless "$<TARGET_FILE:${target}>")
      endif()
    endif()
  endforeach()
  set(modules "")
  if(component STREQUAL tools)
    install(TARGETS lambent_openimageio LIBRARY DESTINATION lib COMPONENT tools)
    set(modules "$<TARGET_FILE:lambent_openimageio>")
  endif()
  install(CODE "
    set(PROGRAMS \"${programs}\")
    set(MODULES \"${modules}\")
    set(HEADLESS_PROGRAMS \"${headless}\")
    set(SYSTEM_LIBRARIES [[${LAMBENT_SYSTEM_LIBRARIES}]])
    set(DISPLAY_LIBRARIES [[${LAMBENT_DISPLAY_LIBRARIES}]])
    set(COMPILED_IN \"${LAMBENT_COMPILED_INTO_${component}}\")
    set(NOTICES \"share/doc/lambent/${component}\")
    set(COMPONENT_NAME \"lambent-${component}\")
    set(COMPONENT_VERSION \"${PROJECT_VERSION}\")
    include([[${PROJECT_SOURCE_DIR}/cmake/package/libraries.cmake]])" COMPONENT ${component})
  install(CODE "
    set(PROGRAMS \"${programs}\")
    include([[${PROJECT_SOURCE_DIR}/cmake/package/manuals.cmake]])" COMPONENT ${component})
  install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "share/doc/lambent" COMPONENT ${component})
  configure_file("${PROJECT_SOURCE_DIR}/cmake/package/${component}.txt.in" "${CMAKE_BINARY_DIR}/package/${component}.txt" @ONLY)
  install(FILES "${CMAKE_BINARY_DIR}/package/${component}.txt" DESTINATION . RENAME README-${component}.txt COMPONENT ${component})
endfunction()

lambent_package(runtime ${LAMBENT_RUNTIME_PROGRAMS})
lambent_package(tools ${LAMBENT_TOOL_PROGRAMS})

# Something to show at once, baked as scripts/demo does; lambent bakes again only what changed. LAMBENT_PACKAGE_OPTIONS in the
# environment replaces the options of the bake.
set(bundle "${CMAKE_BINARY_DIR}/package/${LAMBENT_PACKAGE_SCENE}.lmb.glb")
install(CODE "
  set(options \$ENV{LAMBENT_PACKAGE_OPTIONS})
  if(NOT options)
    set(options --rays 512 --bounces 4)
  endif()
  separate_arguments(options)
  execute_process(COMMAND \"$<TARGET_FILE:lambent>\" bake \"${CMAKE_BINARY_DIR}/assets/${LAMBENT_PACKAGE_SCENE}.glb\"
                          -o \"${bundle}\" \${options}
                  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)" COMPONENT runtime)
install(FILES "${bundle}" DESTINATION share/lambent/scenes COMPONENT runtime)
install(FILES "${CMAKE_BINARY_DIR}/assets/sky.hdr" "${CMAKE_BINARY_DIR}/assets/studio.hdr"
  DESTINATION share/lambent/probes COMPONENT runtime)
install(DIRECTORY "${CMAKE_BINARY_DIR}/assets/" DESTINATION share/lambent/scenes COMPONENT tools FILES_MATCHING PATTERN "*.glb"
  PATTERN "*.lmb.glb" EXCLUDE PATTERN "CMakeFiles" EXCLUDE)
install(FILES "${CMAKE_BINARY_DIR}/assets/sky.hdr" "${CMAKE_BINARY_DIR}/assets/studio.hdr"
  DESTINATION share/lambent/probes COMPONENT tools)

# The add-on for Blender. It is packed here, since a build of the programs alone makes no other targets.
set(addon "${CMAKE_BINARY_DIR}/package/lambent-blender.zip")
install(CODE "
  set(ZIP [[${addon}]])
  include([[${PROJECT_SOURCE_DIR}/cmake/package/blender.cmake]])" COMPONENT tools)
install(FILES "${addon}" DESTINATION share/lambent/blender COMPONENT tools)

# The viewer of `lambent view`.
install(CODE "
  set(WEB [[${PROJECT_SOURCE_DIR}/web]])
  set(COMPONENT_NAME lambent-tools)
  include([[${PROJECT_SOURCE_DIR}/cmake/package/web.cmake]])" COMPONENT tools)

set(CPACK_GENERATOR TGZ)
set(CPACK_THREADS 0)
set(CPACK_PACKAGE_CHECKSUM SHA256)
set(CPACK_PACKAGE_NAME lambent)
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(platform "${PROJECT_VERSION}-${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR}")
# The folder that both archives unpack to: side by side they share their libraries.
set(CPACK_PACKAGE_FILE_NAME "lambent-${platform}")
set(CPACK_ARCHIVE_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL runtime tools)
set(CPACK_COMPONENT_INCLUDE_TOPLEVEL_DIRECTORY ON)
set(CPACK_ARCHIVE_RUNTIME_FILE_NAME "lambent-demo-${platform}")
set(CPACK_ARCHIVE_TOOLS_FILE_NAME "lambent-tools-${platform}")
set(CPACK_PACKAGE_CONTACT "The Lambent authors")

# `cpack -G DEB` makes packages for Debian of the same components.
set(LAMBENT_DEB_COMPONENTS runtime tools library development)
if(TARGET lambent_python)
  list(APPEND LAMBENT_DEB_COMPONENTS python)
endif()
configure_file("${PROJECT_SOURCE_DIR}/cmake/package/deb.cmake.in" "${CMAKE_BINARY_DIR}/package/deb.cmake" @ONLY)
set(CPACK_PROJECT_CONFIG_FILE "${CMAKE_BINARY_DIR}/package/deb.cmake")
include(CPack)
