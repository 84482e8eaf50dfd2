#pragma once

#include <OpenEXR/ImfForward.h>

#include "core/metadata.h"
#include "core/photo.h"

// Included by the files that talk to OpenEXR only.

namespace chromeball::io {

/// The header's facts: every attribute of a known type that does not describe the pixels' storage.
Metadata metadata_of(const Imf::Header& header);
ColorTag color_tag_of(const Imf::Header& header);

/// Adds the facts of known types; those that would change how the pixels are stored are left out.
void add_metadata(Imf::Header& header, const Metadata& metadata);
void add_color_tag(Imf::Header& header, const ColorTag& tag);

}  // namespace chromeball::io
