# Shared by all folders: warnings, sanitizers, libraries found by pkg-config.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)

set(OVERFLY_SANITIZE "" CACHE STRING "Sanitizers, as for -fsanitize=: address,undefined or thread")

add_library(overfly_options INTERFACE)
target_include_directories(overfly_options INTERFACE ${PROJECT_SOURCE_DIR})
# No contraction: a vertex is decided by the same bits in every patch, and a recording must replay.
target_compile_options(overfly_options INTERFACE -Wall -Wextra -Wshadow -ffp-contract=off)
target_link_libraries(overfly_options INTERFACE m Threads::Threads)
if(OVERFLY_SANITIZE)
  target_compile_options(overfly_options INTERFACE -fsanitize=${OVERFLY_SANITIZE} -fno-omit-frame-pointer
                                                   -fno-sanitize-recover=undefined)
  target_link_options(overfly_options INTERFACE -fsanitize=${OVERFLY_SANITIZE})
endif()

# overfly_library(NAME terrain SOURCES a.c b.c LINKS overfly_base) makes overfly_terrain.
function(overfly_library)
  cmake_parse_arguments(LIB "" "NAME" "SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
  add_library(overfly_${LIB_NAME} STATIC ${LIB_SOURCES})
  target_link_libraries(overfly_${LIB_NAME} PUBLIC overfly_options ${LIB_LINKS} PRIVATE ${LIB_PRIVATE_LINKS})
endfunction()
