# Packs the Blender add-on as Blender installs it, a zip with one folder: cmake -D ZIP=FILE -P blender.cmake. Included while
# installing (cmake/Package.cmake), and run by the add-on's test.
get_filename_component(addon_parent "${CMAKE_CURRENT_LIST_DIR}/../../baker/blender" ABSOLUTE)
file(GLOB addon_files RELATIVE "${addon_parent}" "${addon_parent}/lambent_blender/*.py")
get_filename_component(zip_folder "${ZIP}" DIRECTORY)
file(MAKE_DIRECTORY "${zip_folder}")
execute_process(COMMAND "${CMAKE_COMMAND}" -E tar cf "${ZIP}" --format=zip ${addon_files} WORKING_DIRECTORY "${addon_parent}"
                COMMAND_ERROR_IS_FATAL ANY)
