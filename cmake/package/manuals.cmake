# While installing: has each of PROGRAMS write its manual pages and what shells complete its words with, from the tables that
# parse its options (runtime/command_line).
cmake_policy(VERSION 3.25)  # install scripts begin with none
set(prefix "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}")

function(lambent_write file)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
  message(STATUS "Installing: ${prefix}/${file}")
  file(WRITE "${prefix}/${file}" "${text}")
  set(CMAKE_INSTALL_MANIFEST_FILES "${CMAKE_INSTALL_MANIFEST_FILES};${prefix}/${file}" PARENT_SCOPE)
endfunction()

foreach(program ${PROGRAMS})
  get_filename_component(name "${program}" NAME)
  lambent_write(share/man/man1/${name}.1 "${program}" --help-as man)
  execute_process(COMMAND "${program}" --help-as commands OUTPUT_VARIABLE commands COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "[^\n]+" commands "${commands}")
  foreach(command ${commands})
    lambent_write(share/man/man1/${name}-${command}.1 "${program}" ${command} --help-as man)
  endforeach()
  lambent_write(share/bash-completion/completions/${name} "${program}" --help-as bash)
  lambent_write(share/zsh/site-functions/_${name} "${program}" --help-as zsh)
  lambent_write(share/fish/vendor_completions.d/${name}.fish "${program}" --help-as fish)
endforeach()
