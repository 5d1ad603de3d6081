# Checks the includes of include/pliant and src. A file includes only headers of its own folder and of folders to the left
# of this folder in the list `order`. Apart from headers of pliant, headers of core include only Eigen, the standard
# library and the headers of vector instructions (immintrin.h, arm_neon.h). No include uses "..". Each header has
# #pragma once.
# Run as cmake -D SOURCE=... -P include_order.cmake.
cmake_minimum_required(VERSION 3.25)
set(order math shape deform local part solve body collision project method contact simulate scene io render view)
set(outside_core scene io render view)  # folders of libraries with their own packages
set(faults "")

function(check_file path)
  cmake_path(RELATIVE_PATH path BASE_DIRECTORY ${SOURCE} OUTPUT_VARIABLE shown)
  if(shown STREQUAL include/pliant/pliant.h)  # it includes all of core, as a file of the last folder of core may
    set(shown include/pliant/simulate/pliant.h)
  endif()
  string(REGEX MATCH "^(include/pliant|src)/([a-z]+)/" ignored ${shown})
  set(kind ${CMAKE_MATCH_1})
  set(folder ${CMAKE_MATCH_2})
  list(FIND order "${folder}" place)
  if(place EQUAL -1)
    list(APPEND faults "${shown}: not in a folder of the include order")
  endif()
  if(path MATCHES "\\.h$")
    file(STRINGS ${path} once REGEX "^#pragma once$")
    if(NOT once)
      list(APPEND faults "${shown}: #pragma once is missing")
    endif()
  endif()
  file(STRINGS ${path} lines REGEX "^[ \t]*#[ \t]*include")
  foreach(line IN LISTS lines)
    if(line MATCHES "<pliant/([a-z]+)/|\"([a-z]+)/[a-z0-9_/]+\\.h\"")
      set(included ${CMAKE_MATCH_1}${CMAKE_MATCH_2})
      list(FIND order ${included} other)
      if(other EQUAL -1 OR other GREATER place)
        list(APPEND faults "${shown}: ${line}: ${folder} comes before ${included}")
      endif()
    elseif(line MATCHES "[<\"](pliant/|\\.\\./)")
      list(APPEND faults "${shown}: ${line}: write <pliant/folder/file.h>")
    elseif(kind STREQUAL "include/pliant" AND NOT folder IN_LIST outside_core AND line MATCHES "<.*[./]"
           AND NOT line MATCHES "<Eigen/[A-Za-z]+>" AND NOT line MATCHES "<(immintrin|arm_neon)\\.h>")
      list(APPEND faults "${shown}: ${line}: headers of core may include only Eigen and the standard library")
    endif()
  endforeach()
  set(faults "${faults}" PARENT_SCOPE)
endfunction()

file(GLOB_RECURSE files ${SOURCE}/include/*.h ${SOURCE}/src/*.h ${SOURCE}/src/*.cpp)
list(REMOVE_ITEM files ${SOURCE}/include/pliant/pliant.h)  # this header includes all folders of core
if(NOT files)
  message(FATAL_ERROR "there are no sources in ${SOURCE}")
endif()
foreach(path IN LISTS files)
  check_file(${path})
endforeach()
if(faults)
  list(JOIN faults "\n" text)
  message(FATAL_ERROR "${text}")
endif()
