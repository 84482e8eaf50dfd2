#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/metadata.h"
#include "io/write.h"
#include "map/layouts.h"

namespace chromeball {

/// What kind of files a map is written to, as the options say; see plan_output.
struct OutputOptions {
    std::string output;
    std::optional<std::string> layout;
    std::optional<std::string> preset;
    std::optional<std::string> format;
    bool full_float = false;
    std::optional<int> bits;  ///< of PNG and TIFF; 16
};

/// The decisions that follow from them.
struct OutputPlan {
    const Layout* layout = nullptr;
    const Preset* preset = nullptr;  ///< nullptr: none
    FileFormat format = FileFormat::exr;
    /// Whether the file holds light (EXR, HDR, float TIFF) rather than a picture.
    bool scene_linear = true;
    std::string path;

    std::array<std::string, 6> face_files() const;
};

/// Throws Error (usage) for unknown names and contradictions.
OutputPlan plan_output(const OutputOptions& options);

/// Whether an output can be written where it is asked for, and is not the input; before work is
/// spent on it. Makes nothing. Throws Error.
void check_output(const OutputPlan& plan, const std::string& input);
/// Throws Error (usage) when both are the same file or folder.
void check_not_input(const std::string& target, const std::string& input);

/// Writes a map as planned: one file, or six in a folder that is made if need be. Returns the
/// files.
std::vector<std::string> write_map(const OutputPlan& plan, const Image& map,
                                   const WriteOptions& options, WriteReport& report);

/// The six faces' files in a folder, by the names of any preset, in our order; nothing unless all
/// are there.
std::optional<std::array<std::string, 6>> faces_in(const std::string& folder);

}  // namespace chromeball
