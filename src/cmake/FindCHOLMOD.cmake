# CHOLMOD, the sparse Cholesky factorisation of SuiteSparse, as the target SuiteSparse::CHOLMOD. SuiteSparse 7 and later
# install CMake config files. Older versions (Debian 12) install neither config files nor pkg-config files; their header
# and library are searched for. Sets CHOLMOD_FOUND, CHOLMOD_VERSION and CHOLMOD_SUITESPARSE_VERSION. The two versions
# are read from the headers.
include(FindPackageHandleStandardArgs)

find_package(CHOLMOD CONFIG QUIET)
if(TARGET SuiteSparse::CHOLMOD)
  get_target_property(CHOLMOD_INCLUDE_DIR SuiteSparse::CHOLMOD INTERFACE_INCLUDE_DIRECTORIES)
  set(CHOLMOD_LIBRARY SuiteSparse::CHOLMOD)
else()
  find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
  find_library(CHOLMOD_LIBRARY cholmod)
  mark_as_advanced(CHOLMOD_INCLUDE_DIR CHOLMOD_LIBRARY)
endif()

# Sets ${result} to the version that a header defines as ${prefix}_MAIN_VERSION, ${prefix}_SUB_VERSION and
# ${prefix}_SUBSUB_VERSION. The header is the first file name in ARGN that is found.
function(_cholmod_read_version prefix result)
  find_file(_cholmod_header NAMES ${ARGN} HINTS ${CHOLMOD_INCLUDE_DIR} PATH_SUFFIXES suitesparse NO_CACHE)
  set(version "")
  if(_cholmod_header)
    foreach(part MAIN SUB SUBSUB)
      file(STRINGS ${_cholmod_header} line REGEX "^[ \t]*#define[ \t]+${prefix}_${part}_VERSION[ \t]+[0-9]+")
      if(line MATCHES "([0-9]+)[^0-9]*$")
        list(APPEND version ${CMAKE_MATCH_1})
      endif()
    endforeach()
  endif()
  list(JOIN version . version)
  set(${result} "${version}" PARENT_SCOPE)
endfunction()

if(CHOLMOD_INCLUDE_DIR)
  _cholmod_read_version(CHOLMOD CHOLMOD_VERSION cholmod_core.h cholmod.h)
  _cholmod_read_version(SUITESPARSE CHOLMOD_SUITESPARSE_VERSION SuiteSparse_config.h)
endif()
find_package_handle_standard_args(CHOLMOD REQUIRED_VARS CHOLMOD_LIBRARY CHOLMOD_INCLUDE_DIR
                                          VERSION_VAR CHOLMOD_VERSION)

if(CHOLMOD_FOUND AND NOT TARGET SuiteSparse::CHOLMOD)
  add_library(SuiteSparse::CHOLMOD UNKNOWN IMPORTED)
  set_target_properties(SuiteSparse::CHOLMOD PROPERTIES IMPORTED_LOCATION ${CHOLMOD_LIBRARY}
                                                        INTERFACE_INCLUDE_DIRECTORIES ${CHOLMOD_INCLUDE_DIR})
  # A static CHOLMOD needs these libraries.
  foreach(library amd camd colamd ccolamd suitesparseconfig)
    string(TOUPPER ${library} upper)
    find_library(CHOLMOD_${upper}_LIBRARY ${library})
    mark_as_advanced(CHOLMOD_${upper}_LIBRARY)
    if(CHOLMOD_${upper}_LIBRARY)
      set_property(TARGET SuiteSparse::CHOLMOD APPEND PROPERTY INTERFACE_LINK_LIBRARIES ${CHOLMOD_${upper}_LIBRARY})
    endif()
  endforeach()
endif()
