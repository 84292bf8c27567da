# Shared by all folders: warnings, sanitizers, libraries found by pkg-config.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
include(GNUInstallDirs)

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
  set(executable $<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>)
  target_sources(overfly_options INTERFACE $<${executable}:${PROJECT_SOURCE_DIR}/tools/keep_libraries.c>)
  target_link_options(overfly_options INTERFACE $<${executable}:-Wl,--export-dynamic-symbol=dlclose>)
endif()

# overfly_library(NAME terrain SOURCES a.c b.c LINKS overfly_base) makes overfly_terrain.
function(overfly_library)
  cmake_parse_arguments(LIB "" "NAME" "SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
  add_library(overfly_${LIB_NAME} STATIC ${LIB_SOURCES})
  target_link_libraries(overfly_${LIB_NAME} PUBLIC overfly_options ${LIB_LINKS} PRIVATE ${LIB_PRIVATE_LINKS})
endfunction()

# The build tree finds data and modules as an installation does (base/paths.h): share/overfly and lib/overfly.
set(OVERFLY_DATA_STAGE ${CMAKE_BINARY_DIR}/share/overfly)
set(OVERFLY_MODULE_STAGE ${CMAKE_BINARY_DIR}/lib/overfly)
file(MAKE_DIRECTORY ${OVERFLY_DATA_STAGE} ${OVERFLY_MODULE_STAGE})

# overfly_data_folder(shaders ${CMAKE_CURRENT_SOURCE_DIR}/shaders): source files as share/overfly/shaders, in the build
# tree (a link, so that an edit shows at once) and installed.
function(overfly_data_folder name source)
  file(CREATE_LINK ${source} ${OVERFLY_DATA_STAGE}/${name} SYMBOLIC)
  install(DIRECTORY ${source}/ DESTINATION ${CMAKE_INSTALL_DATADIR}/overfly/${name})
endfunction()

# overfly_data_made(geoid egm96-15.pgm): a file that a build step writes to ${OVERFLY_DATA_STAGE}/geoid.
# Called in the folder of that step.
function(overfly_data_made folder file)
  file(MAKE_DIRECTORY ${OVERFLY_DATA_STAGE}/${folder})
  add_custom_target(overfly_${folder}_data ALL DEPENDS ${OVERFLY_DATA_STAGE}/${folder}/${file})
  set_property(GLOBAL APPEND PROPERTY OVERFLY_PARTS overfly_${folder}_data)
  install(FILES ${OVERFLY_DATA_STAGE}/${folder}/${file} DESTINATION ${CMAKE_INSTALL_DATADIR}/overfly/${folder})
endfunction()

# overfly_module(TARGET overfly_image): a loadable module, lib/overfly/overfly_image.so.
function(overfly_module)
  cmake_parse_arguments(MODULE "" "TARGET" "" ${ARGN})
  set_target_properties(${MODULE_TARGET} PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${OVERFLY_MODULE_STAGE})
  set_property(GLOBAL APPEND PROPERTY OVERFLY_PARTS ${MODULE_TARGET})
  install(TARGETS ${MODULE_TARGET} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/overfly)
endfunction()
