# With BUILD_SHARED_LIBS the layers are shared libraries, which an outside project finds installed, links and runs with.
if(NOT DEFINED ENV{${NEEDS}})
  message("skipped: set ${NEEDS}=1 to run this")
  return()
endif()
file(REMOVE_RECURSE ${WORK})
foreach(command
    "${CMAKE_COMMAND};-G;Ninja;-S;${SINEW};-B;${WORK};-DBUILD_SHARED_LIBS=ON;-DSINEW_TOOLS=OFF;-DSINEW_TESTS=OFF;-DSINEW_SAMPLES=OFF"
    "${CMAKE_COMMAND};--build;${WORK}"
    "${CMAKE_COMMAND};--install;${WORK};--prefix;${WORK}/prefix"
    "${CMAKE_COMMAND};-G;Ninja;-S;${OUTSIDE};-B;${WORK}/outside;-DCMAKE_PREFIX_PATH=${WORK}/prefix;-DCMAKE_BUILD_TYPE=Debug;-DEMBEDDING=${OUTSIDE}/main.cpp"
    "${CMAKE_COMMAND};--build;${WORK}/outside"
    "${WORK}/outside/outside"
    "${WORK}/outside/outside_c;${ASSET}")
  execute_process(COMMAND ${command} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${command}\n${out}\n${err}")
  endif()
endforeach()
file(GLOB_RECURSE static ${WORK}/prefix/*.a)
file(GLOB_RECURSE shared ${WORK}/prefix/*/libsinew_character.so.*)
if(static OR NOT shared)
  message(FATAL_ERROR "static: ${static}, shared: ${shared}")
endif()
