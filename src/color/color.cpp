#include "color/color.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include <OpenColorIO/OpenColorIO.h>
#include <fmt/format.h>

#include "color/built_in_config.h"
#include "color/known_spaces.h"
#include "color/pixels.h"
#include "core/error.h"
#include "core/names.h"
#include "core/parallel.h"

namespace chromeball {

namespace ocio = OCIO_NAMESPACE;

struct ColorConfig::State {
    ocio::ConstConfigRcPtr config;
    std::string source;  ///< a path, or "built-in"
    std::string called;  ///< how messages call it
};

namespace {

constexpr auto kAllReferences = ocio::SEARCH_REFERENCE_SPACE_ALL;
constexpr auto kOptimization = ocio::OPTIMIZATION_DEFAULT;
using Processor = ocio::ConstProcessorRcPtr;
using CpuProcessor = ocio::ConstCPUProcessorRcPtr;

/// An OpenColorIO message on one line, without the "Error: " that ours get anyway.
std::string one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    while (!text.empty() && (text.back() == ' ' || text.back() == '.')) text.pop_back();
    if (text.starts_with("Error: ")) text.erase(0, 7);
    return text;
}

/// What f returns; what OpenColorIO throws becomes an Error that begins with `context`.
template <class F>
auto guarded(const std::string& context, F f) {
    try {
        return f();
    } catch (const ocio::Exception& e) {
        throw Error(Error::Kind::failed, fmt::format("{} ({})", context, one_line(e.what())));
    }
}

bool same_ignoring_case(std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
        return std::tolower(static_cast<unsigned char>(x)) ==
               std::tolower(static_cast<unsigned char>(y));
    });
}

/// Whether one letter added, left out or exchanged makes one of the other.
bool one_slip_apart(std::string_view a, std::string_view b) {
    std::size_t head = 0;
    while (head < std::min(a.size(), b.size()) && same_ignoring_case({&a[head], 1}, {&b[head], 1}))
        ++head;
    std::size_t tail = 0;
    while (tail + head < std::min(a.size(), b.size()) &&
           same_ignoring_case({&a[a.size() - 1 - tail], 1}, {&b[b.size() - 1 - tail], 1}))
        ++tail;
    return std::max(a.size(), b.size()) - head - tail <= 1;
}

/// The proper name of a colour space that may not be there. A named transform is none.
std::optional<std::string> find_space(const ocio::Config& config, std::string_view name) {
    const auto space = config.getColorSpace(std::string(name).c_str());
    if (!space) return std::nullopt;
    return space->getName();
}

/// The name that the config in force has for a space that tags know.
std::optional<std::string> find_space(const ocio::Config& config, const KnownSpace& known) {
    if (auto found = find_space(config, known.id)) return found;
    for (const std::string_view name : known.names)
        if (auto found = find_space(config, name)) return found;
    return std::nullopt;
}

std::optional<std::string> srgb_texture(const ocio::Config& config) {
    return find_space(config, *known_space("srgb_rec709_scene"));
}

/// The space that a tag's name means: one that the config has by that very name, else one that is
/// known by it.
std::optional<std::string> space_of_tag(const ocio::Config& config, const std::string& tag) {
    if (auto found = find_space(config, tag)) return found;
    const KnownSpace* known = known_space(tag);
    return known ? find_space(config, *known) : std::nullopt;
}

/// "; did you mean ...?", or what there is, or nothing. `near` are the nearest names, best first.
std::string way_out(const std::string& wanted, std::vector<std::string> near,
                    const std::vector<std::string>& all) {
    if (!near.empty()) {
        if (one_slip_apart(wanted, near.front())) near.resize(1);
        near.resize(std::min<std::size_t>(near.size(), 3));
        return fmt::format("; did you mean {}?", quoted_list(near));
    }
    if (all.empty()) return ", which has none";
    constexpr std::size_t kMost = 30;  // more would not be read
    if (all.size() <= kMost) return fmt::format("; choose {}", quoted_list(all));
    return fmt::format("; choose one of its {} names", all.size());
}

/// The proper name of a display or view, given in any case; an Error (usage) for one that there is
/// not.
std::string proper_name(const std::string& kind, const std::string& wanted,
                        const std::vector<std::string>& names, const std::string& where) {
    for (const std::string& name : names)
        if (same_ignoring_case(name, wanted)) return name;
    throw Error(Error::Kind::usage,
                fmt::format("{} \"{}\" is not in {}{}", kind, wanted, where,
                            way_out(wanted, nearest_names(wanted, names), names)));
}

ocio::BitDepth bit_depth(PixelType type) {
    switch (type) {
        case PixelType::u8:
            return ocio::BIT_DEPTH_UINT8;
        case PixelType::u16:
            return ocio::BIT_DEPTH_UINT16;
        case PixelType::f16:
            return ocio::BIT_DEPTH_F16;
        default:
            return ocio::BIT_DEPTH_F32;
    }
}

/// Rows a band of about 32768 pixels: enough work for a task, and within a core's cache.
int band_rows(int width) { return std::max(1, 32768 / std::max(1, width)); }

ImageView<float> rows_of(Image& image, int first, int last) {
    ImageView<float> view = image.view();
    return {view.row(first), {view.size.width, last - first}, view.channels, view.stride};
}

ocio::PackedImageDesc description(ImageView<float> pixels) {
    return {pixels.data, pixels.size.width, pixels.size.height, pixels.channels};
}

void apply(const ocio::CPUProcessor& processor, const StoredRows& from, ImageView<float> to) {
    ocio::PackedImageDesc target = description(to);
    // OpenColorIO only reads from its source, but declares it writable.
    auto* data = const_cast<std::byte*>(from.data);
    const ocio::BitDepth depth = bit_depth(from.type);
    if (from.is_grey()) {
        // The same plane thrice is grey as RGB, without a copy.
        std::byte* alpha = from.has_alpha() ? data + bytes_per_value(from.type) : nullptr;
        const ocio::PlanarImageDesc source(data, data, data, alpha, from.size.width,
                                           from.size.height, depth, from.pixel_bytes(),
                                           from.row_bytes);
        processor.apply(source, target);
    } else {
        const ocio::PackedImageDesc source(data, from.size.width, from.size.height, from.channels,
                                           depth,
                                           static_cast<std::ptrdiff_t>(bytes_per_value(from.type)),
                                           from.pixel_bytes(), from.row_bytes);
        processor.apply(source, target);
    }
}

/// Applies a transform to an image of the working space, in place; not to alpha-multiplied colour
/// if `divide`.
void convert(Image& image, const ocio::CPUProcessor& processor, bool divide) {
    for_each_band(image.height(), band_rows(image.width()), [&](int first, int last) {
        const ImageView<float> band = rows_of(image, first, last);
        if (divide) divide_by_alpha(band);
        ocio::PackedImageDesc pixels = description(band);
        processor.apply(pixels);
        if (divide) multiply_by_alpha(band);
    });
}

/// Whether f(ax + by) = a f(x) + b f(y), tried on colours dark, bright, negative and saturated.
bool acts_linearly(const ocio::CPUProcessor& processor) {
    using Color = std::array<float, 3>;
    const auto image_of = [&](Color c) {
        processor.applyRGB(c.data());
        return c;
    };
    const Color zero = image_of({0, 0, 0});
    const Color r = image_of({1, 0, 0}), g = image_of({0, 1, 0}), b = image_of({0, 0, 1});
    const auto near = [](float x, float y, float scale) {
        return std::abs(x - y) <= 1e-4f * scale;  // a float matrix errs by some 1e-7
    };
    for (const Color& c : {Color{0.01f, 0.02f, 0.005f}, Color{0.18f, 0.5f, 0.9f},
                           Color{8, 0.2f, 60}, Color{-0.1f, 0.3f, 0.1f}}) {
        const Color found = image_of(c);
        const float scale = std::max({std::abs(c[0]), std::abs(c[1]), std::abs(c[2])});
        for (std::size_t i = 0; i < 3; ++i) {
            const float wanted = c[0] * r[i] + c[1] * g[i] + c[2] * b[i];
            if (!near(zero[i], 0, scale) || !near(found[i], wanted, scale)) return false;
        }
    }
    return true;
}

std::string described(const std::array<double, 8>& c) {
    return fmt::format(
        "red {:.4f} {:.4f}, green {:.4f} {:.4f}, blue {:.4f} {:.4f}, white {:.4f} "
        "{:.4f}",
        c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]);
}

ocio::ConstConfigRcPtr read_config(const std::string& path, bool from_environment) {
    const std::string thing = path + (from_environment ? " (from $OCIO)" : "");
    const std::string remedy = from_environment ? "correct or clear $OCIO, or use --ocio FILE"
                                                : "give another file with --ocio, or leave it out "
                                                  "for the built-in config";
    std::error_code ignored;
    const auto status = std::filesystem::status(path, ignored);
    if (!std::filesystem::is_regular_file(status)) {
        const char* found = !std::filesystem::exists(status) ? "no such file" : "not a file";
        throw Error(Error::Kind::failed, fmt::format("{}: {}, an OpenColorIO config is wanted; {}",
                                                     thing, found, remedy));
    }
    const std::string broken =
        fmt::format("{}: cannot be used as an OpenColorIO config; {}", thing, remedy);
    auto config = guarded(broken, [&] { return ocio::Config::CreateFromFile(path.c_str()); });
    if (!find_space(*config, ocio::ROLE_SCENE_LINEAR))
        throw Error(Error::Kind::failed,
                    fmt::format("{}: the config has no role scene_linear, which names the working "
                                "space; {}",
                                thing, remedy));
    return config;
}

}  // namespace

ColorConfig::ColorConfig(std::unique_ptr<State> state) : state_(std::move(state)) {}
ColorConfig::ColorConfig(ColorConfig&&) noexcept = default;
ColorConfig& ColorConfig::operator=(ColorConfig&&) noexcept = default;
ColorConfig::~ColorConfig() = default;

ColorConfig ColorConfig::load(const std::optional<std::string>& file) {
    const char* environment = std::getenv("OCIO");
    const bool from_environment = !file && environment && *environment;
    if (!file && !from_environment) return built_in();
    const std::string path = file ? *file : environment;
    return ColorConfig(
        std::make_unique<State>(State{read_config(path, from_environment), path, path}));
}

ColorConfig ColorConfig::built_in() {
    std::istringstream text{std::string(built_in_config_text())};
    auto config = guarded("the built-in color config is broken",
                          [&] { return ocio::Config::CreateFromStream(text); });
    return ColorConfig(std::make_unique<State>(State{config, "built-in", "the built-in config"}));
}

const std::string& ColorConfig::source() const { return state_->source; }

std::string ColorConfig::space(const std::string& name) const {
    if (auto found = find_space(*state_->config, name)) return *found;
    // Several names of one space are one suggestion.
    std::vector<std::string> near;
    std::set<std::string> seen;
    const std::vector<std::string> all = space_names();
    for (const std::string& candidate : nearest_names(name, all, 12))
        if (seen.insert(find_space(*state_->config, candidate).value_or(candidate)).second)
            near.push_back(candidate);
    throw Error(Error::Kind::usage, fmt::format("color space \"{}\" is not in {}{}", name,
                                                state_->called, way_out(name, near, all)));
}

std::vector<std::string> ColorConfig::space_names() const {
    const ocio::Config& config = *state_->config;
    std::vector<std::string> names;
    std::vector<std::string> aliases;
    for (int i = 0; i < config.getNumColorSpaces(kAllReferences, ocio::COLORSPACE_ALL); ++i) {
        names.emplace_back(
            config.getColorSpaceNameByIndex(kAllReferences, ocio::COLORSPACE_ALL, i));
        const auto space = config.getColorSpace(names.back().c_str());
        for (std::size_t alias = 0; alias < space->getNumAliases(); ++alias)
            aliases.emplace_back(space->getAlias(alias));
    }
    names.insert(names.end(), aliases.begin(), aliases.end());
    for (int i = 0; i < config.getNumRoles(); ++i) names.emplace_back(config.getRoleName(i));
    return names;
}

std::string ColorConfig::input_space(const Photo& photo, const std::optional<std::string>& asked,
                                     std::string* warning) const {
    if (asked) return space(*asked);
    const ocio::Config& config = *state_->config;
    const ColorTag& tag = photo.color;
    // "unknown" is an identifier of the Color Interop Forum, and means what it says.
    const bool named = !tag.space.empty() && tag.space != "unknown";
    std::optional<std::string> tagged;
    if (named) tagged = space_of_tag(config, tag.space);
    std::string misunderstood;
    if (named && !tagged) misunderstood = fmt::format("color tag \"{}\" is", tag.space);
    if (!tagged && tag.chromaticities) {
        const KnownSpace* known = known_space(*tag.chromaticities);
        if (known) tagged = find_space(config, *known);
        if (!tagged && !named)
            misunderstood = fmt::format("chromaticities ({}) are", described(*tag.chromaticities));
    }
    const std::string chosen = tagged ? *tagged : untagged_space(photo);
    if (warning && !misunderstood.empty())
        *warning = fmt::format(
            "{}: the file's {} not known to {}; taken as \"{}\", say another "
            "with --input-space",
            photo.name, misunderstood, state_->called, chosen);
    return chosen;
}

std::string ColorConfig::untagged_space(const Photo& photo) const {
    const ocio::Config& config = *state_->config;
    const std::string scene_linear = space(ocio::ROLE_SCENE_LINEAR);
    // The rule names a space or a role; a rule for this very path is somebody's decision.
    const auto ruled = find_space(config, config.getColorSpaceFromFilepath(photo.name.c_str()));
    if (ruled && !config.filepathOnlyMatchesDefaultRule(photo.name.c_str())) return *ruled;
    if (!is_integer(photo.type)) return scene_linear;
    // Some configs have a linear default, meant for their renders; pictures in integers are not.
    if (ruled && !is_linear(*ruled)) return *ruled;
    return srgb_texture(config).value_or(ruled.value_or(scene_linear));
}

std::string ColorConfig::output_space(const std::optional<std::string>& asked,
                                      bool scene_linear_file) const {
    if (asked) return space(*asked);
    if (scene_linear_file) return space(ocio::ROLE_SCENE_LINEAR);
    if (auto found = srgb_texture(*state_->config)) return *found;
    throw Error(Error::Kind::usage,
                fmt::format("{} has no space called srgb_texture, which pictures are written in; "
                            "name one of its spaces with --output-space",
                            state_->called));
}

Image ColorConfig::to_working(const Photo& photo, const std::string& space_name,
                              std::optional<Window> region, std::size_t* bad_pixels) const {
    const std::string from = space(space_name);
    const Window window = region ? intersection(*region, photo.window) : photo.window;
    const bool alpha = photo.channels == 2 || photo.channels == 4;
    const bool divide = alpha && photo.associated_alpha && !transforms_linearly(from);
    const auto processor = guarded(
        fmt::format("{}: color space \"{}\" cannot be used; name "
                    "another with --input-space",
                    state_->called, from),
        [&] { return state_->config->getProcessor(from.c_str(), ocio::ROLE_SCENE_LINEAR); });
    // Numbers as stored go straight into OpenColorIO, which is several times cheaper for integers;
    // where colour has to be divided first, or nothing is to be done, they become floats here.
    const bool load_first = divide || processor->isNoOp();
    const PixelType type = load_first ? PixelType::f32 : photo.type;
    const auto decoder =
        processor->getOptimizedCPUProcessor(bit_depth(type), ocio::BIT_DEPTH_F32, kOptimization);
    Image image(window.size, alpha ? 4 : 3);
    std::atomic<std::size_t> bad = 0;
    for_each_band(image.height(), band_rows(image.width()), [&](int first, int last) {
        const StoredRows stored = stored_rows(photo, window, first, last);
        const ImageView<float> band = rows_of(image, first, last);
        if (load_first) load_floats(stored, band);
        if (divide) divide_by_alpha(band);
        if (!load_first) {
            apply(*decoder, stored, band);
        } else if (!processor->isNoOp()) {
            ocio::PackedImageDesc pixels = description(band);
            decoder->apply(pixels);
        }
        if (divide || (alpha && !photo.associated_alpha)) multiply_by_alpha(band);
        bad += clear_bad_pixels(stored, band);
    });
    if (bad_pixels) *bad_pixels = bad;
    if (bad > 0 && !alpha) return add_alpha(image);
    return image;
}

void ColorConfig::from_working(Image& image, const std::string& space_name) const {
    const std::string to = space(space_name);
    const auto processor =
        guarded(fmt::format("{}: color space \"{}\" cannot be written; name "
                            "another with --output-space",
                            state_->called, to),
                [&] { return state_->config->getProcessor(ocio::ROLE_SCENE_LINEAR, to.c_str()); });
    if (processor->isNoOp()) return;
    const auto encoder = processor->getOptimizedCPUProcessor(kOptimization);
    convert(image, *encoder, image.channels() == 4 && !acts_linearly(*encoder));
}

void ColorConfig::to_display(Image& image, const std::string& display_name,
                             const std::string& view_name) const {
    const std::string display = proper_name("display", display_name, displays(), state_->called);
    const std::string view =
        proper_name("view", view_name, views(display),
                    fmt::format("display \"{}\" of {}", display, state_->called));
    const auto processor = guarded(
        fmt::format("{}: view \"{}\" of display \"{}\" cannot be used; name another with --view",
                    state_->called, view, display),
        [&] {
            return state_->config->getProcessor(ocio::ROLE_SCENE_LINEAR, display.c_str(),
                                                view.c_str(), ocio::TRANSFORM_DIR_FORWARD);
        });
    if (processor->isNoOp()) return;
    const auto encoder = processor->getOptimizedCPUProcessor(kOptimization);
    convert(image, *encoder, image.channels() == 4);
}

std::vector<std::string> ColorConfig::displays() const {
    std::vector<std::string> names;
    for (int i = 0; i < state_->config->getNumDisplays(); ++i)
        names.emplace_back(state_->config->getDisplay(i));
    return names;
}

std::vector<std::string> ColorConfig::views(const std::string& display) const {
    const std::string name = proper_name("display", display, displays(), state_->called);
    std::vector<std::string> names;
    for (int i = 0; i < state_->config->getNumViews(name.c_str()); ++i)
        names.emplace_back(state_->config->getView(name.c_str(), i));
    return names;
}

ColorTag ColorConfig::tag(const std::string& space_name) const {
    const std::string wanted = space(space_name);
    for (const KnownSpace& known : known_spaces())
        if (find_space(*state_->config, known) == wanted)
            return {std::string(known.id), known.chromaticities};
    return {wanted, std::nullopt};
}

bool ColorConfig::is_linear(const std::string& space_name) const {
    const std::string name = space(space_name);
    return !state_->config->getColorSpace(name.c_str())->isData() && transforms_linearly(name);
}

bool ColorConfig::transforms_linearly(const std::string& name) const {
    return guarded(fmt::format("{}: color space \"{}\" cannot be used", state_->called, name), [&] {
        const auto processor = state_->config->getProcessor(name.c_str(), ocio::ROLE_SCENE_LINEAR);
        return acts_linearly(*processor->getOptimizedCPUProcessor(kOptimization));
    });
}

}  // namespace chromeball
