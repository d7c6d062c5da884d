# Writes OUT, a C file with the digest of all sources below SOURCE_DIR. A stored
# outcome of a task depends on this digest and on the input of the task.
file(GLOB_RECURSE sources RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/*.c
  ${SOURCE_DIR}/*.h ${SOURCE_DIR}/*.cpp)
list(SORT sources)
set(all "")
foreach(source ${sources})
  file(SHA256 ${SOURCE_DIR}/${source} digest)
  string(APPEND all "${source} ${digest}\n")
endforeach()
string(SHA256 digest "${all}")
file(WRITE ${OUT} "#include \"base/version.h\"\n\n"
  "const char vg_source_digest[] = \"${digest}\";\n")
