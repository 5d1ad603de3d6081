# Builds and runs the client outside the tree: cmake -D WAY=... -P build_client.cmake. WAY is one of
#   find          find_package(pliant COMPONENTS core) in the installation PREFIX, other packages hidden
#   components    find_package with all of COMPONENTS
#   absent        find_package with a component that does not exist: must fail and name it
#   pkg-config    pliant.pc of PREFIX
#   subdirectory  add_subdirectory(SOURCE); links the existing library CORE, as another build takes minutes
# GENERATOR, CXX and LAUNCHER are those of the calling build.
cmake_minimum_required(VERSION 3.25)
set(work ${WORK}/${WAY})
file(REMOVE_RECURSE ${work})
set(configure ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/client -B ${work} -G ${GENERATOR}
    -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})

if(WAY STREQUAL subdirectory)
  list(APPEND configure -DPLIANT_SOURCE=${SOURCE} -DPLIANT_BUILT_CORE=${CORE} -DCMAKE_BUILD_TYPE=None)
else()
  list(APPEND configure -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_BUILD_TYPE=Release)
endif()
if(WAY STREQUAL find OR WAY STREQUAL subdirectory)
  foreach(package CHOLMOD nlohmann_json CLI11 PNG ZLIB Catch2 assimp)
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
execute_process(COMMAND ${work}/client COMMAND_ERROR_IS_FATAL ANY)
