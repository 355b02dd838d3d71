# Writes a header with a hash of source files. Called as
#   cmake -D SOURCES=a.cpp;b.cpp -D NAME=MACRO -D HEADER=file.h -P fingerprint.cmake
foreach(source IN LISTS SOURCES)
  file(SHA256 ${source} hash)
  string(APPEND all ${hash})
endforeach()
string(SHA256 all "${all}")
string(SUBSTRING ${all} 0 16 all)
file(CONFIGURE OUTPUT ${HEADER} CONTENT "#define ${NAME} \"${all}\"\n")
