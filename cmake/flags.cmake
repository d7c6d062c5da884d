# Signs of predicates and bytes of output must not depend on how a compiler
# fuses or reorders floating point: no contraction, no fast-math, ever.
add_library(vg_flags INTERFACE)
target_compile_options(vg_flags INTERFACE
  -Wall -Wextra -Wshadow -Wpointer-arith
  $<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes -Wmissing-prototypes>
  -ffp-contract=off -fno-fast-math
  $<$<BOOL:${VG_WERROR}>:-Werror>)
target_include_directories(vg_flags INTERFACE ${PROJECT_SOURCE_DIR}/src)
set(CMAKE_C_FLAGS_RELEASE "-O3 -g -DNDEBUG")
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -g -DNDEBUG")

function(vg_library name)
  file(GLOB sources CONFIGURE_DEPENDS *.c *.cpp)
  add_library(vg_${name} OBJECT ${sources})
  target_link_libraries(vg_${name} PUBLIC vg_flags)
endfunction()
