# The packages that pliant builds with. The engine needs Eigen, Spectra and the system's threads; its clients need Eigen
# and threads. Every other package is searched for only if the option that needs it is on. A missing package is an error
# that names the Debian package.

# Records a package that was found: pliant_package(Eigen VERSION v TARGETS t... [CLIENT "arguments of
# find_dependency"]). The summary uses TARGETS to print which libraries use the package. A client of the installed
# library finds the package with CLIENT.
function(pliant_package name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "VERSION;CLIENT" "TARGETS")
  set_property(GLOBAL APPEND PROPERTY PLIANT_PACKAGES ${name})
  set_property(GLOBAL PROPERTY PLIANT_VERSION_${name} "${arg_VERSION}")
  foreach(target IN LISTS arg_TARGETS)
    set_property(GLOBAL PROPERTY PLIANT_PACKAGE_OF_${target} ${name})
  endforeach()
  set_property(GLOBAL PROPERTY PLIANT_CLIENT_${name} "${arg_CLIENT}")
endfunction()

# Stops with an error if a package is missing: pliant_require(PNG_FOUND libpng-dev PLIANT_APPS). The last argument is the
# option without which the package is not needed, or "".
function(pliant_require found debian_package option)
  if(NOT ${found})
    string(REPLACE "_FOUND" "" name ${found})
    if(option)
      set(way_out ", or configure with -D${option}=OFF")
    endif()
    message(FATAL_ERROR "pliant: ${name} was not found. Install the Debian package ${debian_package}${way_out}.")
  endif()
endfunction()

# Eigen 5 refuses a request for version 3.4, so that each version is requested.
find_package(Eigen3 3.4 QUIET CONFIG)
if(NOT Eigen3_FOUND)
  find_package(Eigen3 5 QUIET CONFIG)
endif()
pliant_require(Eigen3_FOUND libeigen3-dev "")
# A client must compile with an Eigen of the same major version as the library, and not with an older version.
pliant_package(Eigen VERSION ${Eigen3_VERSION} TARGETS Eigen3::Eigen CLIENT "Eigen3 ${Eigen3_VERSION} CONFIG")

find_package(Threads REQUIRED)
pliant_package(Threads VERSION system TARGETS Threads::Threads CLIENT "Threads")

# Spectra is header-only, and only the modes of meshes use it: clients do not need it.
find_package(spectra QUIET CONFIG PATHS /usr/share/spectra/cmake)
set(Spectra_FOUND ${spectra_FOUND})
pliant_require(Spectra_FOUND libspectra-dev "")
pliant_package(Spectra VERSION "${spectra_VERSION}" TARGETS Spectra::Spectra)

if(PLIANT_SUITESPARSE)
  find_package(CHOLMOD QUIET MODULE)
  pliant_require(CHOLMOD_FOUND libsuitesparse-dev PLIANT_SUITESPARSE)
  pliant_package(CHOLMOD VERSION "${CHOLMOD_VERSION} (SuiteSparse ${CHOLMOD_SUITESPARSE_VERSION})"
                 TARGETS SuiteSparse::CHOLMOD CLIENT "CHOLMOD MODULE")
endif()

if(PLIANT_APPS)
  find_package(nlohmann_json 3.11 QUIET CONFIG)
  pliant_require(nlohmann_json_FOUND nlohmann-json3-dev PLIANT_APPS)
  pliant_package(nlohmann_json VERSION ${nlohmann_json_VERSION} TARGETS nlohmann_json::nlohmann_json)

  find_package(CLI11 2.1 QUIET CONFIG)
  pliant_require(CLI11_FOUND libcli11-dev PLIANT_APPS)
  pliant_package(CLI11 VERSION ${CLI11_VERSION} TARGETS CLI11::CLI11)

  find_package(assimp QUIET CONFIG)
  pliant_require(assimp_FOUND libassimp-dev PLIANT_APPS)
  pliant_package(assimp VERSION ${assimp_VERSION} TARGETS assimp::assimp CLIENT "assimp CONFIG")

  find_package(PNG QUIET)
  pliant_require(PNG_FOUND libpng-dev PLIANT_APPS)
  pliant_package(PNG VERSION ${PNG_VERSION_STRING} TARGETS PNG::PNG CLIENT "PNG")

  # zlib computes the checksums of recordings. libpng needs it too.
  find_package(ZLIB QUIET)
  pliant_require(ZLIB_FOUND zlib1g-dev PLIANT_APPS)
  pliant_package(ZLIB VERSION ${ZLIB_VERSION_STRING} TARGETS ZLIB::ZLIB CLIENT "ZLIB")

  # The window of `pliant view` needs GLFW and Dear ImGui. Without them the program has no window.
  set(PLIANT_MISSING_WINDOW_PACKAGES "")
  find_package(glfw3 QUIET CONFIG)
  find_package(ImGui QUIET MODULE)
  if(glfw3_FOUND)
    pliant_package(GLFW VERSION ${glfw3_VERSION} TARGETS glfw CLIENT "glfw3 CONFIG")
  else()
    list(APPEND PLIANT_MISSING_WINDOW_PACKAGES libglfw3-dev)
  endif()
  if(ImGui_FOUND)
    pliant_package(ImGui VERSION ${ImGui_VERSION} TARGETS ImGui::ImGui CLIENT "ImGui MODULE")
  else()
    list(APPEND PLIANT_MISSING_WINDOW_PACKAGES libimgui-dev)
  endif()
  list(JOIN PLIANT_MISSING_WINDOW_PACKAGES " and " PLIANT_MISSING_WINDOW_PACKAGES)
endif()

if(PLIANT_TESTS)
  find_package(Catch2 QUIET CONFIG)
  pliant_require(Catch2_FOUND catch2 PLIANT_TESTS)
  pliant_package(Catch2 VERSION ${Catch2_VERSION} TARGETS Catch2::Catch2 Catch2::Catch2WithMain)
endif()
if(PLIANT_TESTS AND PLIANT_APPS)
  # valijson checks scenes against the schema independently of pliant. Its config file has no version.
  find_package(valijson QUIET CONFIG)
  pliant_require(valijson_FOUND libvalijson-dev PLIANT_TESTS)
  pliant_package(valijson VERSION - TARGETS valijson)
endif()
