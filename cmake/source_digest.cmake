# SPDX-License-Identifier: LGPL-3.0-or-later
# Writes OUT, a C file with the digest of all sources below SOURCE_DIR, or below
# its FOLDERS (separated by commas). A stored
# outcome of a task depends on this digest and on the input of the task.
set(sources)
string(REPLACE "," ";" FOLDERS "${FOLDERS}")
if(NOT FOLDERS)
  set(FOLDERS .)
endif()
foreach(folder ${FOLDERS})
  file(GLOB_RECURSE found RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/${folder}/*.c
    ${SOURCE_DIR}/${folder}/*.h ${SOURCE_DIR}/${folder}/*.cpp)
  list(APPEND sources ${found})
endforeach()
list(SORT sources)
set(all "")
foreach(source ${sources})
  file(SHA256 ${SOURCE_DIR}/${source} digest)
  string(APPEND all "${source} ${digest}\n")
endforeach()
string(SHA256 digest "${all}")
file(WRITE ${OUT} "#include \"base/version.h\"\n\n"
  "const char vg_source_digest[] = \"${digest}\";\n")
