# What `cmake --install` puts where, beyond the data folders and modules that overfly.cmake's functions register.
if(TARGET overfly)
  # Beside share/overfly and lib/overfly of the build tree: build/release/overfly.
  set_target_properties(overfly PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
  install(TARGETS overfly RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

set(OVERFLY_DATA ${PROJECT_SOURCE_DIR}/assets/data)
overfly_data_folder(dem ${OVERFLY_DATA}/dem)
overfly_data_folder(scenes ${OVERFLY_DATA}/scenes)
