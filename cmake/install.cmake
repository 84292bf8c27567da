# The target `program`: all that an installation needs, tests aside; and what `cmake --install` puts where, beyond the
# data folders and modules that overfly.cmake's functions register.
set(data ${PROJECT_SOURCE_DIR}/assets/data)
set(manual ${CMAKE_BINARY_DIR}/overfly.1)

# Beside share/overfly and lib/overfly of the build tree: build/release/overfly. Modules and made data are opened at run
# time, so the linker does not know of them.
set_target_properties(overfly PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
get_property(parts GLOBAL PROPERTY OVERFLY_PARTS)
if(parts)
  add_dependencies(overfly ${parts})
endif()

add_custom_command(
  OUTPUT ${manual}
  COMMAND sh ${PROJECT_SOURCE_DIR}/tools/make_manual $<TARGET_FILE:overfly> ${data}/man/overfly.1.in
          ${PROJECT_VERSION} ${PROJECT_SOURCE_DIR}/input/action.h > ${manual}.new
  COMMAND ${CMAKE_COMMAND} -E rename ${manual}.new ${manual}
  DEPENDS overfly ${data}/man/overfly.1.in ${PROJECT_SOURCE_DIR}/tools/make_manual
          ${PROJECT_SOURCE_DIR}/input/action.h
  COMMENT "Writing the man page"
  VERBATIM)
add_custom_target(program ALL DEPENDS overfly ${manual})

overfly_data_folder(aircraft ${data}/aircraft)
overfly_data_folder(dem ${data}/dem)
overfly_data_folder(demos ${data}/demos)
overfly_data_folder(joysticks ${data}/joysticks)
overfly_data_folder(report ${data}/report)
overfly_data_folder(scenes ${data}/scenes)
overfly_data_folder(udev ${data}/udev)
# Of the prefixes /usr and /usr/local, udev reads it there.
install(FILES ${data}/udev/70-overfly.rules DESTINATION lib/udev/rules.d)
install(TARGETS overfly RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES ${manual} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${data}/bash-completion/overfly DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${data}/desktop/overfly.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications)
install(FILES ${data}/desktop/overfly.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/NOTICE DESTINATION ${CMAKE_INSTALL_DOCDIR})

# The terrain as a library of its own: static archives, the headers others need, and overfly-terrain.pc.
set(terrain_headers dem/dem geo geodesy grid jobs lod/lod measure/measure terrain)
set(base_headers arena base clock log paths vec)
list(TRANSFORM base_headers REPLACE "(.+)" "${PROJECT_SOURCE_DIR}/base/\\1.h")
install(TARGETS overfly_terrain overfly_assets overfly_base ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(header ${terrain_headers})
  cmake_path(GET header PARENT_PATH folder)
  install(FILES ${PROJECT_SOURCE_DIR}/terrain/${header}.h
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/overfly/terrain/${folder})
endforeach()
install(FILES ${base_headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/overfly/base)

# Relative to the .pc file, so that the prefix may be chosen when installing.
file(RELATIVE_PATH terrain_prefix_from_pc ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
file(RELATIVE_PATH libdir_from_prefix ${CMAKE_INSTALL_PREFIX} ${CMAKE_INSTALL_FULL_LIBDIR})
file(RELATIVE_PATH includedir_from_prefix ${CMAKE_INSTALL_PREFIX} ${CMAKE_INSTALL_FULL_INCLUDEDIR})
set(terrain_libdir "\${prefix}/${libdir_from_prefix}")
set(terrain_includedir "\${prefix}/${includedir_from_prefix}")
configure_file(${PROJECT_SOURCE_DIR}/cmake/overfly-terrain.pc.in ${CMAKE_BINARY_DIR}/overfly-terrain.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/overfly-terrain.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
