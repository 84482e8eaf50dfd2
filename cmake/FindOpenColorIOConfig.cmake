# Debian 12's OpenColorIO package config points at paths that do not exist; pkg-config knows better.
# Defines the target OpenColorIOConfig::OpenColorIO.
find_package(PkgConfig REQUIRED)
pkg_check_modules(OCIO QUIET IMPORTED_TARGET GLOBAL OpenColorIO>=2.1)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenColorIOConfig REQUIRED_VARS OCIO_FOUND
    REASON_FAILURE_MESSAGE "install libopencolorio-dev 2.1 or newer")
if(OpenColorIOConfig_FOUND AND NOT TARGET OpenColorIOConfig::OpenColorIO)
    add_library(OpenColorIOConfig::OpenColorIO INTERFACE IMPORTED)
    set_target_properties(OpenColorIOConfig::OpenColorIO PROPERTIES INTERFACE_LINK_LIBRARIES PkgConfig::OCIO)
endif()
