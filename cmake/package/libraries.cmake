# While installing: copies the shared libraries that PROGRAMS and MODULES link, and those that these link, to lib/, each under
# the one name that it is asked for by, and the licences of their packages and of those COMPILED_IN to NOTICES, beside a bill of
# materials. SYSTEM_LIBRARIES and DISPLAY_LIBRARIES are regular expressions of names that stay out; HEADLESS_PROGRAMS, which no
# display can trip, get the latter in lib/headless/. RPATHs lead there (lambent_program in cmake/Lambent.cmake).
cmake_policy(VERSION 3.25)  # install scripts begin with none
set(prefix "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}")
set(files "")

# To `folder`, but for what lies in lib/ already.
function(lambent_copy_libraries folder programs excluded)
  file(GET_RUNTIME_DEPENDENCIES EXECUTABLES ${programs} MODULES ${MODULES}
    RESOLVED_DEPENDENCIES_VAR libraries UNRESOLVED_DEPENDENCIES_VAR missing PRE_EXCLUDE_REGEXES ${excluded})
  if(missing)
    message(FATAL_ERROR "lambent: ${programs}: libraries are not to be found: ${missing}")
  endif()
  foreach(library ${libraries})
    get_filename_component(name "${library}" NAME)
    if(NOT name IN_LIST copied)
      file(REAL_PATH "${library}" file)
      message(STATUS "Installing: ${prefix}/${folder}/${name}")
      file(MAKE_DIRECTORY "${prefix}/${folder}")
      file(COPY_FILE "${file}" "${prefix}/${folder}/${name}" ONLY_IF_DIFFERENT)
      list(APPEND CMAKE_INSTALL_MANIFEST_FILES "${prefix}/${folder}/${name}")
      list(APPEND copied "${name}")
      list(APPEND files "${library}" "${file}")
    endif()
  endforeach()
  set(copied "${copied}" PARENT_SCOPE)
  set(files "${files}" PARENT_SCOPE)
  set(CMAKE_INSTALL_MANIFEST_FILES "${CMAKE_INSTALL_MANIFEST_FILES}" PARENT_SCOPE)
endfunction()

# Packages for a system name its libraries as what they depend on, and carry none (deb.cmake.in).
if(LAMBENT_SYSTEM_PACKAGES)
  return()
endif()

set(copied "")
lambent_copy_libraries(lib "${PROGRAMS}" "${SYSTEM_LIBRARIES};${DISPLAY_LIBRARIES}")
if(HEADLESS_PROGRAMS)
  lambent_copy_libraries(lib/headless "${HEADLESS_PROGRAMS}" "${SYSTEM_LIBRARIES}")
endif()

# Whose they are. Where there is no dpkg, whoever packs has to add them.
find_program(DPKG_QUERY dpkg-query)
if(DPKG_QUERY)
  set(owners ${COMPILED_IN})
  if(files)
    execute_process(COMMAND "${DPKG_QUERY}" --search ${files} OUTPUT_VARIABLE found ERROR_QUIET)
    string(REGEX MATCHALL "[^\n]+" found "${found}")
    list(TRANSFORM found REPLACE ":.*" "")
    list(APPEND owners ${found})
    list(REMOVE_DUPLICATES owners)
  endif()
  file(MAKE_DIRECTORY "${prefix}/${NOTICES}")
  foreach(owner ${owners})
    if(EXISTS "/usr/share/doc/${owner}/copyright")
      file(REAL_PATH "/usr/share/doc/${owner}/copyright" text)
      file(COPY_FILE "${text}" "${prefix}/${NOTICES}/${owner}.txt" ONLY_IF_DIFFERENT)
    endif()
  endforeach()

  # A bill of materials, by CycloneDX 1.5: each package in the version of the machine that packs.
  set(sbom [[{"bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1, "metadata": {"component": {"type": "application"}}, "components": []}]])
  string(JSON sbom SET "${sbom}" metadata component name "\"${COMPONENT_NAME}\"")
  string(JSON sbom SET "${sbom}" metadata component version "\"${COMPONENT_VERSION}\"")
  set(count 0)
  list(SORT owners)
  file(STRINGS /etc/os-release distribution REGEX "^ID=" LIMIT_COUNT 1)
  string(REGEX REPLACE "^ID=\"?([a-z]*)\"?$" "\\1" distribution "${distribution}")
  foreach(owner ${owners})
    execute_process(COMMAND "${DPKG_QUERY}" --show "--showformat=\${Version}\n" "${owner}" OUTPUT_VARIABLE version ERROR_QUIET)
    string(REGEX REPLACE "\n.*" "" version "${version}")  # the first of several architectures
    string(REPLACE "+" "%2B" escaped "${version}")
    string(JSON sbom SET "${sbom}" components ${count} "{\"type\": \"library\", \"name\": \"${owner}\",
      \"version\": \"${version}\", \"purl\": \"pkg:deb/${distribution}/${owner}@${escaped}\"}")
    math(EXPR count "${count} + 1")
  endforeach()
  file(WRITE "${prefix}/share/doc/lambent/${COMPONENT_NAME}.cdx.json" "${sbom}\n")
endif()
