# What `cmake --install` puts where, beyond the data folders and modules that overfly.cmake's functions register.
if(TARGET overfly)
  # Beside share/overfly and lib/overfly of the build tree: build/release/overfly.
  set_target_properties(overfly PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
  # The program opens them at run time, so the linker does not know.
  get_property(parts GLOBAL PROPERTY OVERFLY_PARTS)
  if(parts)
    add_dependencies(overfly ${parts})
  endif()
  install(TARGETS overfly RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

set(OVERFLY_DATA ${PROJECT_SOURCE_DIR}/assets/data)
overfly_data_folder(dem ${OVERFLY_DATA}/dem)
overfly_data_folder(scenes ${OVERFLY_DATA}/scenes)
