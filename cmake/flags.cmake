# Signs of predicates and bytes of output must not depend on how a compiler
# fuses or reorders floating point: no contraction, no fast-math, ever.
add_library(vg_flags INTERFACE)
target_compile_options(vg_flags INTERFACE
  -Wall -Wextra -Wshadow -Wpointer-arith
  $<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes -Wmissing-prototypes>
  -ffp-contract=off -fno-fast-math
  $<$<BOOL:${VG_WERROR}>:-Werror>)
target_compile_definitions(vg_flags INTERFACE $<$<BOOL:${VG_CHECKS}>:VG_CHECKS>)
target_include_directories(vg_flags INTERFACE ${PROJECT_SOURCE_DIR}/src)
set(CMAKE_C_FLAGS_RELEASE "-O3 -g -DNDEBUG")
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -g -DNDEBUG")

# Counts of lines (verification/coverage.sh). They are not atomic, which would slow
# threads down: how often a line ran is then inexact, whether it ran is not.
if(VG_COVERAGE)
  target_compile_options(vg_flags INTERFACE --coverage)
  add_link_options(--coverage LINKER:--wrap=_exit)
endif()

# vg_module(FOLDER SEEN...): the sources of a folder of src as one part of the
# program, that sees the headers of others: src/CMakeLists.txt.
function(vg_module module)
  string(REPLACE "/" "_" target "vg_${module}")
  file(GLOB sources CONFIGURE_DEPENDS ${module}/*.c ${module}/*.cpp)
  add_library(${target} OBJECT ${sources})
  target_link_libraries(${target} PUBLIC vg_flags)
  foreach(seen ${ARGN})
    string(REPLACE "/" "_" below "vg_${seen}")
    if(NOT TARGET ${below})
      message(FATAL_ERROR "src/CMakeLists.txt: ${module} sees ${seen}, which is "
        "not above it in the list")
    endif()
    target_link_libraries(${target} PUBLIC ${below})
  endforeach()
  set_property(GLOBAL APPEND PROPERTY VG_MODULES ${module})
endfunction()
