cmake_policy(VERSION 3.25)
# The embedding lines of the README become a program: its includes, then a draw() that ends the game after a second, then
# the lines themselves.
file(REMOVE_RECURSE ${WORK})
file(READ ${README} readme)
string(REGEX MATCH "```cpp\n(#include[^`]*)```" found "${readme}")
if(NOT found)
  message(FATAL_ERROR "${README} holds no embedding lines")
endif()
set(block "${CMAKE_MATCH_1}")
string(REGEX MATCHALL "#include[^\n]*\n" includes "${block}")
string(REGEX REPLACE "#include[^\n]*\n" "" lines "${block}")
string(CONCAT program ${includes} "#include \"draw.h\"\nint main() {\n" "${lines}" "  return 1;  // nothing was drawn\n}\n")
file(WRITE ${WORK}/embedding.cpp "${program}")
configure_file(${ASSET} ${WORK}/hero.sinew COPYONLY)
# And a file with every public header, out of what is installed.
include(${RUNTIME}/public_headers.cmake)
set(program "")
foreach(header ${SINEW_PUBLIC_HEADERS})
  string(APPEND program "#include <sinew/${header}>\n")
endforeach()
file(WRITE ${WORK}/headers.cpp "${program}")
set(sanitize "")
if(FLAGS)
  set(sanitize -DCMAKE_CXX_FLAGS=-fsanitize=address,undefined -DCMAKE_C_FLAGS=-fsanitize=address,undefined)
endif()
foreach(command
    "${CMAKE_COMMAND};--install;${BUILD};--prefix;${WORK}/prefix"
    "${CMAKE_COMMAND};-G;Ninja;-S;${OUTSIDE};-B;${WORK}/build;-DCMAKE_PREFIX_PATH=${WORK}/prefix;-DCMAKE_BUILD_TYPE=Release;-DEMBEDDING=${WORK}/embedding.cpp;-DHEADERS=${WORK}/headers.cpp;${sanitize}"
    "${CMAKE_COMMAND};--build;${WORK}/build"
    "${WORK}/build/outside"
    "${WORK}/build/embedding"
    "${WORK}/build/outside_c;${ASSET}"
    "${WORK}/build/outside_pkg_config;${ASSET}")
  execute_process(COMMAND ${command} WORKING_DIRECTORY ${WORK} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${command}\n${out}\n${err}")
  endif()
endforeach()
# What the public headers do not need stays with the sources.
foreach(internal character/world_impl.h character/state.h c/call.h animation/kernels/pack.h optimizer/newton.h)
  if(EXISTS ${WORK}/prefix/include/sinew/${internal})
    message(FATAL_ERROR "${internal} is installed")
  endif()
endforeach()
