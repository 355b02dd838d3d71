# A fingerprint changes with every file that results follow from, however it is included, and with
# no other.
cmake_policy(VERSION 3.25)
set(root ${WORK}/src)
set(folder ${root}/lamina/solve/scattering)
file(REMOVE_RECURSE ${WORK})
file(WRITE ${folder}/solver.cpp "#include \"lamina/solve/scattering/solver.h\"\n")
file(WRITE ${folder}/solver.h "#include <vector>\n#include \"lamina/layers/optics/ray.h\"\n")
file(WRITE ${root}/lamina/layers/optics/ray.h "#include \"lamina/solve/scattering/solver.h\"  // a circle\n")
file(WRITE ${root}/lamina/layers/optics/ray.cpp "#include \"lamina/layers/optics/deep.h\"\n")
file(WRITE ${root}/lamina/layers/optics/deep.h "")
file(WRITE ${root}/lamina/layers/optics/other.h "")

function(fingerprint out)
  execute_process(COMMAND ${CMAKE_COMMAND} -D SOURCES=${folder}/solver.cpp -D ROOT=${root}
    -D NAME=F -D HEADER=${WORK}/f.h -D DEPFILE=${WORK}/f.d -P ${SCRIPT} COMMAND_ERROR_IS_FATAL ANY)
  file(READ ${WORK}/f.h text)
  if(NOT text MATCHES "^#define F \"[0-9a-f]+\"\n$")
    message(FATAL_ERROR "not a fingerprint: ${text}")
  endif()
  set(${out} ${text} PARENT_SCOPE)
endfunction()

fingerprint(before)
foreach(file IN ITEMS solve/scattering/solver.cpp solve/scattering/solver.h layers/optics/ray.h layers/optics/ray.cpp
    layers/optics/deep.h)
  file(APPEND ${root}/lamina/${file} "// changed\n")
  fingerprint(after)
  if(after STREQUAL before)
    message(FATAL_ERROR "${file} changed, but the fingerprint did not")
  endif()
  set(before ${after})
endforeach()
file(APPEND ${root}/lamina/layers/optics/other.h "// changed\n")
fingerprint(after)
if(NOT after STREQUAL before)
  message(FATAL_ERROR "the fingerprint follows a file that nothing includes")
endif()

# Of the solver itself: what lies in private headers.
file(GLOB sources ${SOURCE}/lamina/solve/scattering/transport_profile/*.cpp
  ${SOURCE}/lamina/solve/scattering/low_orders/*.cpp
  ${SOURCE}/lamina/solve/scattering/spatial_frequency/*.cpp)
execute_process(COMMAND ${CMAKE_COMMAND} -D "SOURCES=${sources}" -D ROOT=${SOURCE} -D NAME=F
  -D HEADER=${WORK}/f.h -D DEPFILE=${WORK}/f.d -P ${SCRIPT} COMMAND_ERROR_IS_FATAL ANY)
file(READ ${WORK}/f.d files)
foreach(file IN ITEMS solve/scattering/low_orders/straight_ray.h
    solve/scattering/transport_profile/internal/transfer_profile_band.h
    solve/scattering/profile/bessel.cpp solve/scattering/profile/hankel.cpp
    solve/scattering/adding_doubling/adding_doubling_matrix.cpp layers/optics/fresnel.h
    layers/optics/phase_function.cpp base/core/quadrature.cpp)
  string(FIND "${files}" "/lamina/${file}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "the fingerprint of transfer profiles lacks ${file}")
  endif()
endforeach()
