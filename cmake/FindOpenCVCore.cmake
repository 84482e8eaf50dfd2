# OpenCV's own package config comes only with all of OpenCV; two modules are enough here.
# Defines the target OpenCVCore::OpenCVCore (core and imgproc).
find_path(OpenCVCore_INCLUDE_DIR opencv2/imgproc.hpp PATH_SUFFIXES opencv4)
find_library(OpenCVCore_CORE opencv_core)
find_library(OpenCVCore_IMGPROC opencv_imgproc)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenCVCore
    REQUIRED_VARS OpenCVCore_IMGPROC OpenCVCore_CORE OpenCVCore_INCLUDE_DIR
    REASON_FAILURE_MESSAGE "install libopencv-core-dev and libopencv-imgproc-dev")
if(OpenCVCore_FOUND AND NOT TARGET OpenCVCore::OpenCVCore)
    add_library(OpenCVCore::OpenCVCore INTERFACE IMPORTED)
    set_target_properties(OpenCVCore::OpenCVCore PROPERTIES
        INTERFACE_INCLUDE_DIRECTORIES "${OpenCVCore_INCLUDE_DIR}"
        INTERFACE_LINK_LIBRARIES "${OpenCVCore_IMGPROC};${OpenCVCore_CORE}")
endif()
mark_as_advanced(OpenCVCore_INCLUDE_DIR OpenCVCore_CORE OpenCVCore_IMGPROC)
