# cmake --install, and find_package(chromeball) for those who build on the layers.
include(CMakePackageConfigHelpers)

# All layers under one name: chromeball::chromeball
add_library(chromeball_layers INTERFACE)
add_library(chromeball::chromeball ALIAS chromeball_layers)
set_target_properties(chromeball_layers PROPERTIES EXPORT_NAME chromeball)
set(targets chromeball_layers)
foreach(layer ${CHROMEBALL_LAYERS})
    target_link_libraries(chromeball_layers INTERFACE chromeball_${layer})
    list(APPEND targets chromeball_${layer})
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/${layer}
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/chromeball FILES_MATCHING PATTERN "*.h")
endforeach()

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/chromeball)
install(TARGETS ${targets} EXPORT chromeball ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS chromeball_oiio chromeball_render_module LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/chromeball)
install(EXPORT chromeball NAMESPACE chromeball:: FILE chromeballTargets.cmake DESTINATION ${package_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/chromeballConfig.cmake.in
    ${PROJECT_BINARY_DIR}/chromeballConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/chromeballConfigVersion.cmake
    COMPATIBILITY SameMinorVersion)
install(FILES
    ${PROJECT_BINARY_DIR}/chromeballConfig.cmake ${PROJECT_BINARY_DIR}/chromeballConfigVersion.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindOpenCVCore.cmake ${PROJECT_SOURCE_DIR}/cmake/FindOpenColorIOConfig.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindISAL.cmake ${PROJECT_SOURCE_DIR}/cmake/FindLibDeflate.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindLibExif.cmake
    DESTINATION ${package_dir})

# The program has the config inside; the file is for other programs to use the same colours.
install(FILES ${PROJECT_SOURCE_DIR}/data/chromeball.ocio DESTINATION ${CMAKE_INSTALL_DATADIR}/chromeball)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
