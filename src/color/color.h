#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/photo.h"

namespace chromeball {

/// The colour management in force: an OpenColorIO config, and conversions with it.
///
/// Working space: the config's scene_linear role. Safe to use from many threads.
class ColorConfig {
public:
    /// The config of a file; without one that of $OCIO; without that the one embedded in the
    /// program. Throws Error naming the file when it is missing or broken.
    static ColorConfig load(const std::optional<std::string>& file);
    /// The config embedded in the program (data/chromeball.ocio).
    static ColorConfig built_in();

    ColorConfig(ColorConfig&&) noexcept;
    ColorConfig& operator=(ColorConfig&&) noexcept;
    ~ColorConfig();

    /// Where it came from: a path, or "built-in".
    const std::string& source() const;

    /// The proper name of a colour space, given by name, alias or role. Throws Error (usage) with
    /// the nearest names.
    std::string space(const std::string& name) const;
    /// All names, aliases and roles, for help texts.
    std::vector<std::string> space_names() const;

    /// The space of a photo's pixels: the one asked for, else the file's own tag (its name before
    /// its chromaticities), else a file rule that the config has for this path, else by how the
    /// numbers are stored: integers in the config's default space (sRGB texture, also where the
    /// default is linear), floats in scene_linear. `warning` is set when a tag was not understood
    /// or names a space that the config does not have.
    std::string input_space(const Photo& photo, const std::optional<std::string>& asked,
                            std::string* warning = nullptr) const;
    /// The space to write: the one asked for, else scene_linear for scene-linear files, sRGB
    /// texture for pictures.
    std::string output_space(const std::optional<std::string>& asked, bool scene_linear_file) const;

    /// A photo in the working space: RGB, or RGBA (colour multiplied by alpha) where the photo has
    /// alpha. Grey becomes RGB. `region` is in display-window coordinates and is cut to the photo's
    /// window; absent: all of it. Pixels that are NaN or infinite become 0 with alpha 0 (the image
    /// then has alpha); `bad_pixels` counts them.
    Image to_working(const Photo& photo, const std::string& space,
                     std::optional<Window> region = {}, std::size_t* bad_pixels = nullptr) const;

    /// From the working space into another, in place; alpha-multiplied colour is divided by alpha
    /// around a non-linear transform, and multiplied again.
    void from_working(Image& image, const std::string& space) const;

    /// From the working space to a display, in place, as from_working. Throws Error (usage) for an
    /// unknown display or view.
    void to_display(Image& image, const std::string& display, const std::string& view) const;
    std::vector<std::string> displays() const;
    std::vector<std::string> views(const std::string& display) const;

    /// How a file should tag a space: its interop name and, for linear RGB spaces whose primaries
    /// are known, chromaticities.
    ColorTag tag(const std::string& space) const;
    /// Whether a space is scene-linear (its numbers are proportional to light). Data is not.
    bool is_linear(const std::string& space) const;

private:
    struct State;
    explicit ColorConfig(std::unique_ptr<State> state);
    std::string untagged_space(const Photo& photo) const;
    bool transforms_linearly(const std::string& space) const;  // into the working space; data, too
    std::unique_ptr<State> state_;
};

}  // namespace chromeball
