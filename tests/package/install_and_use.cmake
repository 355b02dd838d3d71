# Installs a build of lamina into an empty prefix, then configures, builds and runs the project of
# this folder against it.
#   cmake -D BUILD=... -D SOURCE=... -D WORK=... -D GENERATOR=... -D COMPILER=... -D FLAGS=...
#     [-D LAUNCHER=...] -P install_and_use.cmake
set(without -D CMAKE_DISABLE_FIND_PACKAGE_OpenEXR=ON -D CMAKE_DISABLE_FIND_PACKAGE_PNG=ON
  -D CMAKE_DISABLE_FIND_PACKAGE_TIFF=ON -D CMAKE_DISABLE_FIND_PACKAGE_embree=ON)
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\nended with ${result}:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -G ${GENERATOR}
  -D CMAKE_PREFIX_PATH=${WORK}/prefix -D CMAKE_CXX_COMPILER=${COMPILER}
  -D CMAKE_CXX_FLAGS=${FLAGS} -D CMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/consumer)
if(NOT output MATCHES "donner_jensen_skin: 3 layers")
  message(FATAL_ERROR "the consumer printed: ${output}")
endif()
# Solvers where no image library and no Embree is to be found.
run(${CMAKE_COMMAND} -S ${SOURCE}/solvers -B ${WORK}/solvers -G ${GENERATOR}
  -D CMAKE_PREFIX_PATH=${WORK}/prefix -D CMAKE_CXX_COMPILER=${COMPILER}
  -D CMAKE_CXX_FLAGS=${FLAGS} -D CMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} ${without})
run(${CMAKE_COMMAND} --build ${WORK}/solvers)
run(ldd ${WORK}/solvers/consumer)
if(output MATCHES "OpenEXR|libpng|libtiff|embree")
  message(FATAL_ERROR "solvers are linked to image libraries or Embree:\n${output}")
endif()
run(${WORK}/solvers/consumer)
if(NOT output MATCHES "of light, 1000 photons")
  message(FATAL_ERROR "the consumer of solvers printed: ${output}")
endif()
# lamina itself is made ready to be built there, too: the command without Embree.
run(${CMAKE_COMMAND} -S ${SOURCE}/../.. -B ${WORK}/lamina_without_embree -G ${GENERATOR}
  -D LAMINA_RENDER=OFF -D LAMINA_TESTS=OFF -D LAMINA_BENCHMARKS=OFF -D CMAKE_CXX_COMPILER=${COMPILER}
  -D CMAKE_DISABLE_FIND_PACKAGE_embree=ON)
run(${CMAKE_COMMAND} --build ${WORK}/lamina_without_embree -- -n)
# What is installed must not point into the build or the source.
file(GLOB_RECURSE files ${WORK}/prefix/*.cmake)
foreach(file ${files})
  file(READ ${file} text)
  string(FIND "${text}" ${BUILD} at)
  if(NOT at EQUAL -1)
    message(FATAL_ERROR "${file} names the build folder")
  endif()
endforeach()
file(REMOVE_RECURSE ${WORK}/prefix)  # large
