# Builds and runs a client of pliant outside the source tree: cmake -D WAY=... -P build_client.cmake. WAY is one of
#   find          find_package(pliant COMPONENTS core) in the installation PREFIX, with the other packages disabled
#   components    find_package with all of COMPONENTS
#   absent        find_package with a component that does not exist; it must fail with a message that names the component
#   pkg-config    pliant.pc of PREFIX
#   subdirectory  add_subdirectory(SOURCE); the client links the existing library CORE, because another build of core
#                 takes minutes
#   readme        the program and the CMakeLists.txt that SOURCE/README.md shows, built with the installation PREFIX
# The programs are built in the folder WORK/WAY. GENERATOR, CXX and LAUNCHER are the generator, compiler and compiler
# launcher of the calling build.
cmake_minimum_required(VERSION 3.25)
set(work ${WORK}/${WAY})
file(REMOVE_RECURSE ${work})
set(client ${CMAKE_CURRENT_LIST_DIR}/client)
set(program client)
if(WAY STREQUAL readme)
  include(${CMAKE_CURRENT_LIST_DIR}/page_block.cmake)
  set(client ${work}/source)
  set(program two_parts)
  page_block(${SOURCE}/README.md "## The library" "```cpp" text)
  file(WRITE ${client}/two_parts.cpp "${text}")
  page_block(${SOURCE}/README.md "## The library" "```cmake" text)
  file(WRITE ${client}/CMakeLists.txt "${text}")
  page_block(${SOURCE}/README.md "The program prints" "```" shown)
endif()
set(configure ${CMAKE_COMMAND} -S ${client} -B ${work} -G ${GENERATOR}
    -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})

if(WAY STREQUAL subdirectory)
  list(APPEND configure -DPLIANT_SOURCE=${SOURCE} -DPLIANT_BUILT_CORE=${CORE} -DCMAKE_BUILD_TYPE=None)
else()
  list(APPEND configure -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_BUILD_TYPE=Release)
endif()
if(WAY MATCHES "^(find|subdirectory|readme)$")
  foreach(package CHOLMOD nlohmann_json CLI11 PNG ZLIB Catch2)
    list(APPEND configure -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
  endforeach()
elseif(WAY STREQUAL components)
  list(APPEND configure "-DCLIENT_COMPONENTS=${COMPONENTS}")
elseif(WAY STREQUAL absent)
  list(APPEND configure -DCLIENT_COMPONENTS=nosuch)
  execute_process(COMMAND ${configure} RESULT_VARIABLE status ERROR_VARIABLE errors OUTPUT_QUIET)
  if(status EQUAL 0 OR NOT errors MATCHES "has no component nosuch")
    message(FATAL_ERROR "a component that does not exist was not refused: status ${status}, message: ${errors}")
  endif()
  return()
elseif(WAY STREQUAL pkg-config)
  list(APPEND configure -DPLIANT_PKG_CONFIG=ON)
endif()

execute_process(COMMAND ${configure} COMMAND_ERROR_IS_FATAL ANY)
if(WAY STREQUAL subdirectory)
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${work} --target client_of_built COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${work}/client_of_built COMMAND_ERROR_IS_FATAL ANY)
  return()
endif()
execute_process(COMMAND ${CMAKE_COMMAND} --build ${work} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${work}/${program} OUTPUT_VARIABLE printed COMMAND_ERROR_IS_FATAL ANY)
if(WAY STREQUAL readme)
  # Only the text before ", balance" is compared. The numbers after it are rounding errors, which depend on the
  # processor.
  string(REGEX REPLACE ", balance.*" "" shown "${shown}")
  string(FIND "${printed}" "${shown}" at)
  if(NOT at EQUAL 0)
    message(FATAL_ERROR "the program of README.md prints\n${printed}but README.md shows\n${shown}")
  endif()
endif()
