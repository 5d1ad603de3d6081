# Checks that README.md quotes the examples word for word.
file(READ ${SOURCE}/README.md readme)
foreach(name two_parts add_a_shape add_a_deformation)
  file(READ ${SOURCE}/apps/examples/${name}.cpp code)
  string(FIND "${readme}" "${code}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "README.md does not quote apps/examples/${name}.cpp as it is")
  endif()
endforeach()
