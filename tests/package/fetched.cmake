# A project that takes Sinew in by FetchContent, where neither pkg-config nor CMake finds what the tools and tests need. Compiled
# without optimisation: that it builds is the point.
file(REMOVE_RECURSE ${WORK})
set(missing "")
foreach(package GTest CLI11 nlohmann_json PNG JPEG ZLIB SDL2 TBB PkgConfig benchmark mujoco)
  list(APPEND missing -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
set(ENV{PKG_CONFIG_LIBDIR} ${WORK}/none)
foreach(command
    "${CMAKE_COMMAND};-G;Ninja;-S;${PROJECT};-B;${WORK};-DSINEW=${SINEW};-DCMAKE_BUILD_TYPE=None;-DCMAKE_CXX_COMPILER=${COMPILER};-DSINEW_CCACHE=ON;${missing}"
    "${CMAKE_COMMAND};--build;${WORK};--target;game"
    "${WORK}/game;${ASSET}")
  execute_process(COMMAND ${command} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${command}\n${out}\n${err}")
  endif()
endforeach()
file(STRINGS ${WORK}/CMakeCache.txt asked REGEX "^(FLATC|GTest_DIR|CLI11_DIR|SINEW_PYTHON):")
if(asked)
  message(FATAL_ERROR "the runtime asked for ${asked}")
endif()
execute_process(COMMAND ${CMAKE_COMMAND} --install ${WORK} --prefix ${WORK}/prefix OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
file(GLOB_RECURSE installed ${WORK}/prefix/*)
if(installed)
  message(FATAL_ERROR "Sinew installs itself with the game: ${installed}")
endif()
