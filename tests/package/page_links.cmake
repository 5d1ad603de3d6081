# Checks that links between the pages of the project lead to files. If a page shows a file name with a folder in
# backticks, this file must exist in the project, in the folder of the page or in include/pliant.
# Run as cmake -D SOURCE=... -P page_links.cmake.
cmake_minimum_required(VERSION 3.25)
file(GLOB pages ${SOURCE}/*.md)
foreach(folder apps bench include scenes src tests)
  file(GLOB_RECURSE more ${SOURCE}/${folder}/*.md)
  list(APPEND pages ${more})
endforeach()

set(faults "")
foreach(page IN LISTS pages)
  cmake_path(GET page PARENT_PATH folder)
  cmake_path(RELATIVE_PATH page BASE_DIRECTORY ${SOURCE} OUTPUT_VARIABLE shown)
  file(READ ${page} text)
  string(REGEX REPLACE "```[^`]*```" "" text "${text}")
  # Square brackets and semicolons have a special meaning in CMake lists.
  string(REPLACE "](" "<LINK " text "${text}")
  string(REGEX REPLACE "[][;]" "" text "${text}")

  string(REGEX MATCHALL "`[a-z0-9_-]+/[a-z0-9_/-]+\\.(h|cpp|cmake|json|md|py|sh|csv)`" names "${text}")
  if(shown STREQUAL CHANGELOG.md)  # the changelog names files of older versions
    set(names "")
  endif()
  foreach(name IN LISTS names)
    string(REPLACE "`" "" name "${name}")
    if(NOT EXISTS ${SOURCE}/${name} AND NOT EXISTS ${folder}/${name} AND NOT EXISTS ${SOURCE}/include/pliant/${name})
      list(APPEND faults "${shown}: no file ${name}")
    endif()
  endforeach()

  string(REGEX REPLACE "`[^`\n]*`" "" text "${text}")  # in code, "](" is no link
  string(REGEX MATCHALL "<LINK [^) \n]*" links "${text}")
  foreach(link IN LISTS links)
    string(REGEX REPLACE "^<LINK ([^#]*).*$" "\\1" target "${link}")
    if(NOT target STREQUAL "" AND NOT target MATCHES "^[a-z]+:" AND NOT EXISTS ${folder}/${target})
      list(APPEND faults "${shown}: no file ${target}")
    endif()
  endforeach()
endforeach()
if(faults)
  list(JOIN faults "\n" text)
  message(FATAL_ERROR "pages name files that do not exist:\n${text}")
endif()
