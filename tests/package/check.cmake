file(REMOVE_RECURSE ${WORK})
set(sanitize "")
if(FLAGS)
  set(sanitize -DCMAKE_CXX_FLAGS=-fsanitize=address,undefined)
endif()
foreach(command
    "${CMAKE_COMMAND};--install;${BUILD};--prefix;${WORK}/prefix"
    "${CMAKE_COMMAND};-G;Ninja;-S;${OUTSIDE};-B;${WORK}/build;-DCMAKE_PREFIX_PATH=${WORK}/prefix;-DCMAKE_BUILD_TYPE=Release;${sanitize}"
    "${CMAKE_COMMAND};--build;${WORK}/build"
    "${WORK}/build/outside")
  execute_process(COMMAND ${command} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${command}\n${out}\n${err}")
  endif()
endforeach()
