# Dear ImGui with its backends for GLFW and OpenGL 3, as the target ImGui::ImGui. Debian installs a static library that
# needs stb and GLFW, without CMake config files. Sets ImGui_FOUND and ImGui_VERSION.
include(FindPackageHandleStandardArgs)

find_path(ImGui_INCLUDE_DIR backends/imgui_impl_glfw.h PATH_SUFFIXES imgui)
find_library(ImGui_LIBRARY imgui)
find_library(ImGui_STB_LIBRARY stb)
mark_as_advanced(ImGui_INCLUDE_DIR ImGui_LIBRARY ImGui_STB_LIBRARY)
if(ImGui_INCLUDE_DIR)
  file(STRINGS ${ImGui_INCLUDE_DIR}/imgui.h ImGui_LINE REGEX "^#define IMGUI_VERSION ")
  string(REGEX REPLACE ".*\"([^\" ]+).*\".*" "\\1" ImGui_VERSION "${ImGui_LINE}")
endif()
find_package_handle_standard_args(ImGui REQUIRED_VARS ImGui_LIBRARY ImGui_INCLUDE_DIR VERSION_VAR ImGui_VERSION)

if(ImGui_FOUND AND NOT TARGET ImGui::ImGui)
  add_library(ImGui::ImGui UNKNOWN IMPORTED)
  set_target_properties(ImGui::ImGui PROPERTIES IMPORTED_LOCATION ${ImGui_LIBRARY}
                                                INTERFACE_INCLUDE_DIRECTORIES ${ImGui_INCLUDE_DIR})
  set_property(TARGET ImGui::ImGui PROPERTY INTERFACE_LINK_LIBRARIES glfw ${CMAKE_DL_LIBS})
  if(ImGui_STB_LIBRARY)
    set_property(TARGET ImGui::ImGui APPEND PROPERTY INTERFACE_LINK_LIBRARIES ${ImGui_STB_LIBRARY})
  endif()
endif()
