# libexif: what cameras say of their pictures.
# Defines the target LibExif::LibExif.
find_path(LIBEXIF_INCLUDE_DIR libexif/exif-data.h)
find_library(LIBEXIF_LIBRARY exif)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(LibExif REQUIRED_VARS LIBEXIF_LIBRARY LIBEXIF_INCLUDE_DIR
    REASON_FAILURE_MESSAGE "install libexif-dev")
if(LibExif_FOUND AND NOT TARGET LibExif::LibExif)
    add_library(LibExif::LibExif INTERFACE IMPORTED)
    set_target_properties(LibExif::LibExif PROPERTIES
        INTERFACE_INCLUDE_DIRECTORIES "${LIBEXIF_INCLUDE_DIR}" INTERFACE_LINK_LIBRARIES "${LIBEXIF_LIBRARY}")
endif()
mark_as_advanced(LIBEXIF_INCLUDE_DIR LIBEXIF_LIBRARY)
