# cpack runs this between installing and packing packages for Debian: it moves what the archives hold to where Debian has it,
# and gives each file to one package, since two cannot own the same.
cmake_policy(VERSION 3.25)
set(root "${CPACK_TEMPORARY_INSTALL_DIRECTORY}")

# Documents of archives: their first page, and the licences of the libraries that they carry.
file(GLOB pages "${root}/*/usr/README-*.txt")
if(pages)
  file(REMOVE ${pages})
endif()
file(REMOVE_RECURSE "${root}/runtime/usr/share/doc" "${root}/tools/usr/share/doc")

# The skies come with the demo, and the module for OpenImageIO with the libraries, if they are packed.
file(REMOVE_RECURSE "${root}/tools/usr/share/lambent/probes")
if("library" IN_LIST CPACK_COMPONENTS_ALL)
  file(REMOVE_RECURSE "${root}/tools/usr/lib")
endif()

# What compiling against the libraries takes is a package of its own, and so is the module for Python.
function(lambent_move component pattern)
  file(GLOB found RELATIVE "${root}/library" "${root}/library/${pattern}")
  foreach(each ${found})
    get_filename_component(folder "${root}/${component}/${each}" DIRECTORY)
    file(MAKE_DIRECTORY "${folder}")
    file(RENAME "${root}/library/${each}" "${root}/${component}/${each}")
  endforeach()
endfunction()
foreach(pattern usr/include usr/lib*/cmake usr/lib*/pkgconfig usr/lib*/*/cmake usr/lib*/*/pkgconfig
                usr/lib*/liblambent-sh.so usr/lib*/liblambent-runtime.so usr/lib*/liblambent-baker.so
                usr/lib*/*/liblambent-sh.so usr/lib*/*/liblambent-runtime.so usr/lib*/*/liblambent-baker.so)
  lambent_move(development ${pattern})
endforeach()
lambent_move(python usr/lib/python3)

foreach(component ${CPACK_COMPONENTS_ALL})
  string(TOUPPER "${component}" upper)
  file(COPY_FILE "${CMAKE_CURRENT_LIST_DIR}/../../LICENSE" "${root}/LICENSE")
  set(doc "${root}/${component}/usr/share/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME}")
  file(MAKE_DIRECTORY "${doc}")
  file(RENAME "${root}/LICENSE" "${doc}/copyright")
endforeach()
file(GLOB manuals "${root}/*/usr/share/man/man1/*.1")
foreach(manual ${manuals})  # Debian's are compressed
  file(ARCHIVE_CREATE OUTPUT "${manual}.gz" PATHS "${manual}" FORMAT raw COMPRESSION GZip)
  file(REMOVE "${manual}")
endforeach()
