#pragma once

#include <string>
#include <vector>

#include "core/metadata.h"

// TIFF knows that a channel is no colour, and not which. So chromeball's own description, where
// the provenance is, names the channels of files with such a one.

namespace chromeball::io {

/// The description's JSON text (see to_attribute; empty for none) with names, one a channel.
std::string with_channel_names(const std::string& own, const std::vector<std::string>& names);

/// The names in a file's metadata, one a channel; none where it has none. Other programs may have
/// changed the channels since.
std::vector<std::string> channel_names(const Metadata& metadata);

}  // namespace chromeball::io
