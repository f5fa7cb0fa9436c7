# What every room's CMakeLists.txt uses: one library per room, one arrow per link line, the same warnings everywhere.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

find_program(LAMBENT_CCACHE ccache)
if(LAMBENT_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${LAMBENT_CCACHE}")
endif()

add_library(lambent_flags INTERFACE)
target_include_directories(lambent_flags INTERFACE "${PROJECT_SOURCE_DIR}")
target_compile_options(lambent_flags INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow)
if(LAMBENT_WERROR)
  target_compile_options(lambent_flags INTERFACE -Werror)
endif()
# GCC warns of a class with members of types in an unnamed namespace unless it is defined in the main file, which it is not
# in a unity build.
if(CMAKE_UNITY_BUILD)
  target_compile_options(lambent_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()
# Vector math comes from -march and plain loops. No -ffast-math: a bake is reproducible to the byte.
if(LAMBENT_ISA AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_compile_options(lambent_flags INTERFACE "-march=${LAMBENT_ISA}")
  target_compile_definitions(lambent_flags INTERFACE "LAMBENT_ISA=\"${LAMBENT_ISA}\"")
else()
  target_compile_definitions(lambent_flags INTERFACE "LAMBENT_ISA=\"${CMAKE_SYSTEM_PROCESSOR}\"")
endif()
# Programs that read what strangers made are hardened: overruns that the compiler can tell end the program, and what the
# loader wrote cannot be written again (docs/robustness.md says what it costs).
if(LAMBENT_HARDEN)
  target_compile_options(lambent_flags INTERFACE $<$<CONFIG:Release>:-U_FORTIFY_SOURCE> $<$<CONFIG:Release>:-D_FORTIFY_SOURCE=2> -fstack-protector-strong)
  target_link_options(lambent_flags INTERFACE LINKER:-z,relro LINKER:-z,now)
endif()
target_compile_definitions(lambent_flags INTERFACE "LAMBENT_VERSION=\"${PROJECT_VERSION}\"")
if(LAMBENT_SANITIZE)
  # Checks of every pointer take a third of the time to compile, and AddressSanitizer finds most of what they would.
  target_compile_options(lambent_flags INTERFACE -fsanitize=${LAMBENT_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
    -fno-sanitize=null,alignment,object-size,pointer-overflow,vptr)
  target_compile_definitions(lambent_flags INTERFACE LAMBENT_SANITIZED)
  target_link_options(lambent_flags INTERFACE -fsanitize=${LAMBENT_SANITIZE})
endif()

# lambent_room(NAME SOURCES file... [LINK target...] [LINK_PRIVATE target...])
# The library lambent_NAME. LINK lists what the room's headers show, LINK_PRIVATE what only its .cpp files use.
function(lambent_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;LINK;LINK_PRIVATE" ${ARGN})
  add_library(lambent_${name} STATIC ${ROOM_SOURCES})
  target_link_libraries(lambent_${name} PUBLIC lambent_flags ${ROOM_LINK} PRIVATE ${ROOM_LINK_PRIVATE})
endfunction()

# lambent_program(NAME SOURCES file... LINK target...): an executable in bin/. Installed, it finds its libraries in ../lib.
function(lambent_program name)
  cmake_parse_arguments(PROGRAM "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${PROGRAM_SOURCES})
  target_link_libraries(${name} PRIVATE lambent_flags ${PROGRAM_LINK})
  # What takes time lies in the rooms. Programs parse words and print, and compile in two thirds of the time so.
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  # RPATH and not RUNPATH, which would count for the program's own needs only and not for those of its libraries. The same
  # in the build folder, where there is no ../lib: CMake would hold the place with an empty path, which is the working folder.
  set_target_properties(${name} PROPERTIES INSTALL_RPATH "$ORIGIN/../lib" BUILD_WITH_INSTALL_RPATH ON)
  target_link_options(${name} PRIVATE "LINKER:--disable-new-dtags")
endfunction()

# lambent_embed(TARGET file...): the files' text in the binary, found by name with
# `std::string_view lambent::embedded::TARGET::find(name)` from "TARGET_embedded.hpp", here and in rooms that link TARGET.
function(lambent_embed target)
  set(header "${CMAKE_CURRENT_BINARY_DIR}/embedded/${target}_embedded.hpp")
  set(inputs "")
  foreach(file ${ARGN})
    list(APPEND inputs "${CMAKE_CURRENT_SOURCE_DIR}/${file}")
  endforeach()
  add_custom_command(OUTPUT "${header}"
    COMMAND "${CMAKE_COMMAND}" "-DOUT=${header}" "-DNAME=${target}" "-DFILES=${inputs}"
            -P "${PROJECT_SOURCE_DIR}/cmake/Embed.cmake"
    DEPENDS ${inputs} "${PROJECT_SOURCE_DIR}/cmake/Embed.cmake" VERBATIM)
  target_sources(${target} PRIVATE "${header}")
  target_include_directories(${target} PUBLIC "${CMAKE_CURRENT_BINARY_DIR}/embedded")
endfunction()

# lambent_as_cpp(TARGET file...): the shaders' text as C++, which stands in the body of a class, as "as_cpp/FILE"
# (runtime/base/glsl.hpp). Files are named from the root. They are headers of the system, since shaders shadow names and
# convert between signed and unsigned.
function(lambent_as_cpp target)
  foreach(file ${ARGN})
    get_filename_component(name "${file}" NAME)
    set(out "${CMAKE_CURRENT_BINARY_DIR}/glsl/as_cpp/${name}")
    add_custom_command(OUTPUT "${out}"
      COMMAND "${CMAKE_COMMAND}" "-DIN=${PROJECT_SOURCE_DIR}/${file}" "-DOUT=${out}" -P "${PROJECT_SOURCE_DIR}/cmake/AsCpp.cmake"
      DEPENDS "${PROJECT_SOURCE_DIR}/${file}" "${PROJECT_SOURCE_DIR}/cmake/AsCpp.cmake" VERBATIM)
    target_sources(${target} PRIVATE "${out}")
    set_source_files_properties("${out}" PROPERTIES HEADER_FILE_ONLY ON)
  endforeach()
  # A shader of one room may include one of another, so as_cpp itself is searched, too.
  target_include_directories(${target} SYSTEM PUBLIC "${CMAKE_CURRENT_BINARY_DIR}/glsl" "${CMAKE_CURRENT_BINARY_DIR}/glsl/as_cpp")
endfunction()

# lambent_test(NAME SOURCES file... LINK target... [LABELS label...] [TIMEOUT seconds])
# Labels: gpu needs OpenGL; fast takes seconds in an optimized build and is what scripts/test-sanitized builds and runs;
# files reads files that may be damaged, and is what scripts/test --sanitized builds and runs with sanitizers too; threads
# works on several threads, and is what scripts/test-sanitized threads builds and runs with ThreadSanitizer.
function(lambent_test name)
  cmake_parse_arguments(TEST "" "TIMEOUT" "SOURCES;LINK;LABELS" ${ARGN})
  if(NOT TEST_TIMEOUT)
    set(TEST_TIMEOUT 300)
  endif()
  add_executable(${name} ${TEST_SOURCES})
  target_link_libraries(${name} PRIVATE lambent_flags ${TEST_LINK} GTest::gtest_main)
  # What is tested is built as it ships. The claims themselves run once; -O1 compiles them in two thirds of the time.
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  if(LAMBENT_SANITIZE)
    target_compile_options(${name} PRIVATE -O0 -fno-sanitize=undefined)
  endif()
  # Tests find the shared data beside the checkout, if it is there; LAMBENT_SHARED_DATA overrides.
  target_compile_definitions(${name} PRIVATE "LAMBENT_SOURCE_DIR=\"${PROJECT_SOURCE_DIR}\"" "LAMBENT_BINARY_DIR=\"${CMAKE_BINARY_DIR}\"")
  foreach(label fast files threads)
    if(label IN_LIST TEST_LABELS)
      add_dependencies(${label}-tests ${name})
    endif()
  endforeach()
  # gtest_discover_tests() loses all but the first entry of a list. One label of all words is found by each (-L files).
  string(JOIN "-" label ${TEST_LABELS})
  # ctest begins with the tests of the highest cost, so that the longest does not run alone at the end.
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60
    PROPERTIES TIMEOUT ${TEST_TIMEOUT} COST ${TEST_TIMEOUT} LABELS "${label}")
endfunction()
