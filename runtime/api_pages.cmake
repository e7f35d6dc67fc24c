# Pages made by doxygen: build/api/html. Every public name of what is listed as documented has words, or the target fails; of the
# other headers only the words that are there are checked.
find_program(SINEW_DOXYGEN doxygen)
if(NOT SINEW_DOXYGEN)
  return()
endif()
sinew_with_included(c_interface ${CMAKE_CURRENT_SOURCE_DIR} c/sinew.h)  # it includes its parts
set(documented ${SINEW_PUBLIC_HEADERS} ${c_interface})
list(REMOVE_DUPLICATES documented)
list(TRANSFORM documented PREPEND sinew/)
list(PREPEND documented api_pages.dox)

# doxygen_run(folder undocumented INPUT…): a configuration in build/api/folder.
function(doxygen_run folder undocumented)
  set(SINEW_DOXYGEN_OUTPUT ${CMAKE_BINARY_DIR}/api/${folder})
  set(SINEW_DOXYGEN_UNDOCUMENTED ${undocumented})
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE SINEW_DOXYGEN_INPUT)
  list(JOIN SINEW_DOXYGEN_INPUT " " SINEW_DOXYGEN_INPUT)
  file(MAKE_DIRECTORY ${SINEW_DOXYGEN_OUTPUT})
  configure_file(Doxyfile.in ${SINEW_DOXYGEN_OUTPUT}/Doxyfile @ONLY)
endfunction()
doxygen_run(. NO api_pages.dox sinew)
doxygen_run(documented YES ${documented})
add_custom_target(api_pages
  COMMAND ${SINEW_DOXYGEN} ${CMAKE_BINARY_DIR}/api/documented/Doxyfile
  COMMAND ${SINEW_DOXYGEN} ${CMAKE_BINARY_DIR}/api/Doxyfile
  VERBATIM)
