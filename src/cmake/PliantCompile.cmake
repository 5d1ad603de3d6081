# How pliant is compiled. pliant_options is exported with the libraries, because memory layout and rounding must be the
# same in the library and in its clients. pliant_own_sources is for targets of this project only.
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES AND PROJECT_IS_TOP_LEVEL)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

add_library(pliant_options INTERFACE)
add_library(pliant::options ALIAS pliant_options)
set_target_properties(pliant_options PROPERTIES EXPORT_NAME options)
target_compile_features(pliant_options INTERFACE cxx_std_17)
target_compile_definitions(pliant_options INTERFACE EIGEN_MAX_STATIC_ALIGN_BYTES=16)
target_compile_options(pliant_options INTERFACE -ffp-contract=off)

add_library(pliant_own_sources INTERFACE)
target_compile_options(pliant_own_sources INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
                                                    -Wno-sign-conversion -Wno-psabi)
if(PLIANT_WERROR)
  target_compile_options(pliant_own_sources INTERFACE -Werror)
endif()
# With these parameters GCC collects garbage in its own memory less often: 7 to 20 % less time to compile, 25 % more memory.
target_compile_options(pliant_own_sources INTERFACE
                       "$<$<CXX_COMPILER_ID:GNU>:SHELL:--param ggc-min-expand=400 --param ggc-min-heapsize=1000000>")
if(PLIANT_NATIVE)
  # Exported too: the calling convention of vectors depends on this option, and a client without it would not link.
  target_compile_options(pliant_options INTERFACE -march=native)
  # GCC 12 reports uninitialised reads in its own AVX-512 intrinsics, and reads outside small matrices that do not
  # happen at run time.
  target_compile_options(pliant_own_sources INTERFACE -Wno-uninitialized -Wno-maybe-uninitialized -Wno-array-bounds
                                                      $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overread>
                                                      $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>)
endif()
if(PLIANT_SANITIZE)
  # Null pointers and misaligned packets (SIMD vectors) crash even without checks. The checks that are switched off are done at
  # each access, and would double the time to compile and to run.
  add_compile_options(-fsanitize=address,undefined -fno-sanitize=null,alignment,vptr,object-size,pointer-overflow
                      -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
  add_compile_definitions(PLIANT_SANITIZED)  # for tests that sanitizers slow down, and tests that count allocations
endif()
if(PLIANT_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang" OR NOT PLIANT_APPS OR NOT PLIANT_TESTS)
    message(FATAL_ERROR "PLIANT_FUZZ needs Clang, PLIANT_APPS and PLIANT_TESTS; for example: "
                        "cmake --preset asan-ubsan -DCMAKE_CXX_COMPILER=clang++ -DPLIANT_FUZZ=ON")
  endif()
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

# Precompiles headers: pliant_precompile(TARGET HEADERS <a.h> ...) for this target, or pliant_precompile(TARGET LIKE OTHER)
# to reuse the precompiled headers of OTHER, which has the same options. Clang saves an eighth of its time. GCC gains nothing.
function(pliant_precompile target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "LIKE" "HEADERS")
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    return()
  endif()
  if(arg_LIKE)
    target_precompile_headers(${target} REUSE_FROM ${arg_LIKE})
  else()
    target_precompile_headers(${target} PRIVATE ${arg_HEADERS})
    # The times of the headers are not stored. Otherwise a new version of a system package, whose headers are older
    # than the build, would stop the build with an error.
    target_compile_options(${target} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")
  endif()
endfunction()

# Adds a library: pliant_library(core SOURCES ... PUBLIC ... PRIVATE ...) makes pliant_core, pliant::core and the
# component core of the installed package. Write a header-only private library as $<BUILD_INTERFACE:...>, so that
# clients do not need it.
function(pliant_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;PUBLIC;PRIVATE")
  add_library(pliant_${name} ${arg_SOURCES})
  add_library(pliant::${name} ALIAS pliant_${name})
  set_target_properties(pliant_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON
                                                   UNITY_BUILD ${PLIANT_UNITY} UNITY_BUILD_BATCH_SIZE 8)
  target_include_directories(pliant_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                                   $<INSTALL_INTERFACE:include>)
  target_include_directories(pliant_${name} PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(pliant_${name} PUBLIC pliant_options ${arg_PUBLIC}
                                       PRIVATE $<BUILD_INTERFACE:pliant_own_sources> ${arg_PRIVATE})
  if(name STREQUAL "core")
    if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")  # the sources share many templates of Eigen; GCC would need 3.3 GB for a batch
      set_target_properties(pliant_core PROPERTIES UNITY_BUILD_BATCH_SIZE 16)
    endif()
    pliant_precompile(pliant_core HEADERS <pliant/pliant.h> <Eigen/Dense> <Eigen/Sparse>)
  else()
    pliant_precompile(pliant_${name} LIKE pliant_core)
  endif()
  if(PLIANT_UNITY)  # a batch includes sources; GCC warns of their types that have members from unnamed namespaces
    target_compile_options(pliant_${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
  pliant_install_library(${name} ${arg_PUBLIC} ${arg_PRIVATE})
endfunction()
