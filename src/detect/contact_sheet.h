#pragma once

#include <string>
#include <vector>

#include "core/photo.h"

namespace chromeball {

/// One cell of a contact sheet.
struct SheetEntry {
    Photo picture;  ///< 8-bit RGB, as overlay() makes them; without pixels the cell stays empty
    std::string caption;  ///< a line under it; what is too long is cut
    bool good = true;     ///< green caption, else red
};

/// A picture made small enough for a cell, so that many can wait for their sheet in little memory.
Photo thumbnail(const Photo& picture);

/// All entries on one 8-bit RGB picture, in rows from the top left, captions below.
Photo contact_sheet(const std::vector<SheetEntry>& entries);

}  // namespace chromeball
