#pragma once

#include <OpenImageIO/typedesc.h>

#include "core/photo.h"

namespace chromeball::io {

/// Our pixel types in OpenImageIO's words. For oiio_*.cpp only.
inline OIIO::TypeDesc type_desc_of(PixelType type) {
    switch (type) {
        case PixelType::u8:
            return OIIO::TypeDesc::UINT8;
        case PixelType::u16:
            return OIIO::TypeDesc::UINT16;
        case PixelType::f16:
            return OIIO::TypeDesc::HALF;
        case PixelType::f32:
            break;
    }
    return OIIO::TypeDesc::FLOAT;
}

}  // namespace chromeball::io
