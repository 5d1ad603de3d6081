# Installation: headers, libraries, the CMake package pliant with one component for each library, and pliant.pc for
# core. Each component is a separate export set, so that a client of core does not need the packages of render.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
set(PLIANT_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/pliant)

# Makes the library pliant_${name} the component ${name}. The arguments after the name are the libraries that it links.
# Libraries in pliant:: become components that the new component needs. Other libraries become packages that a client has
# to find.
function(pliant_install_library name)
  if(NOT PLIANT_INSTALL)
    return()
  endif()
  set(needs "")
  set(finds "")
  foreach(library IN LISTS ARGN)
    get_property(package GLOBAL PROPERTY "PLIANT_PACKAGE_OF_${library}")
    if(library MATCHES "^pliant::(.+)$")
      list(APPEND needs ${CMAKE_MATCH_1})
    elseif(package)
      get_property(client GLOBAL PROPERTY PLIANT_CLIENT_${package})
      if(NOT client)
        message(FATAL_ERROR "pliant_${name} links ${library}, but its pliant_package() has no CLIENT; add one, so that clients find it")
      endif()
      string(APPEND finds "find_dependency(${client})\n")
    endif()
  endforeach()
  set_property(GLOBAL APPEND PROPERTY PLIANT_COMPONENTS ${name})
  set(PLIANT_COMPONENT ${name})
  set(PLIANT_COMPONENT_NEEDS ${needs})
  set(PLIANT_COMPONENT_FINDS "${finds}")
  configure_file(${PROJECT_SOURCE_DIR}/src/cmake/pliant-component.cmake.in
                 ${PROJECT_BINARY_DIR}/package/pliant-${name}.cmake @ONLY)

  set(targets pliant_${name})
  if(name STREQUAL core)
    list(APPEND targets pliant_options)
  endif()
  install(TARGETS ${targets} EXPORT pliant-${name})
  install(EXPORT pliant-${name} NAMESPACE pliant:: FILE pliant-${name}-targets.cmake DESTINATION ${PLIANT_PACKAGE_DIR})
  install(FILES ${PROJECT_BINARY_DIR}/package/pliant-${name}.cmake DESTINATION ${PLIANT_PACKAGE_DIR})
endfunction()

# Writes pliant.pc, with the compile definitions and options of pliant_options, to `file`.
function(_pliant_write_pkg_config file)
  cmake_path(RELATIVE_PATH CMAKE_INSTALL_FULL_LIBDIR BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX} OUTPUT_VARIABLE libdir)
  cmake_path(RELATIVE_PATH CMAKE_INSTALL_FULL_INCLUDEDIR BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX}
             OUTPUT_VARIABLE includedir)
  cmake_path(RELATIVE_PATH CMAKE_INSTALL_PREFIX BASE_DIRECTORY ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig
             OUTPUT_VARIABLE prefix)
  get_target_property(definitions pliant_options INTERFACE_COMPILE_DEFINITIONS)
  get_target_property(flags pliant_options INTERFACE_COMPILE_OPTIONS)
  list(TRANSFORM definitions PREPEND -D)
  list(JOIN definitions " " definitions)
  list(JOIN flags " " flags)
  configure_file(${PROJECT_SOURCE_DIR}/src/cmake/pliant.pc.in ${file} @ONLY)
endfunction()

# Installs the files that belong to no component: headers of the libraries that are built, the package's config and
# version files, pliant.pc.
function(pliant_install_package)
  set(not_built "")
  foreach(folder scene io render view)
    if(NOT TARGET pliant_${folder})
      list(APPEND not_built PATTERN pliant/${folder} EXCLUDE)
    endif()
  endforeach()
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/pliant DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} ${not_built})

  set(build ${PROJECT_BINARY_DIR}/package)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/src/cmake/pliant-config.cmake.in ${build}/pliant-config.cmake
                                INSTALL_DESTINATION ${PLIANT_PACKAGE_DIR} NO_SET_AND_CHECK_MACRO)
  write_basic_package_version_file(${build}/pliant-config-version.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${build}/pliant-config.cmake ${build}/pliant-config-version.cmake
                ${PROJECT_SOURCE_DIR}/src/cmake/FindCHOLMOD.cmake ${PROJECT_SOURCE_DIR}/src/cmake/FindImGui.cmake
          DESTINATION ${PLIANT_PACKAGE_DIR})

  _pliant_write_pkg_config(${build}/pliant.pc)
  install(FILES ${build}/pliant.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()
