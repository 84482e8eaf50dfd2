#include "structure/include_rules.h"

#include <algorithm>
#include <set>

namespace chromeball::structure {
namespace {

using Names = std::set<std::string_view>;

/// A folder and those whose headers it may include: the arrows of the architecture.
struct Arrows {
    std::string_view folder;
    Names may_include;
};

const Arrows kArrows[] = {
    {"core", {"core"}},
    {"map", {"map", "core"}},
    {"resample", {"resample", "map", "core"}},
    {"io", {"io", "map", "core"}},
    {"color", {"color", "map", "core"}},
    {"detect", {"detect", "map", "core"}},
    {"light", {"light", "resample", "map", "core"}},
    {"shot", {"shot", "resample", "map", "core"}},
    {"render", {"render", "resample", "map", "core"}},
    {"apps",
     {"apps", "io", "color", "detect", "light", "shot", "render", "resample", "map", "core"}},
};

/// Third-party headers, by how their names begin, and the folders that are their doors.
struct Door {
    std::string_view begins;
    Names folders;
};

const Names kAll = {"core",   "map",   "resample", "io",     "color",
                    "detect", "light", "shot",     "render", "apps"};

const Door kDoors[] = {
    {"Imath", kAll},  // our vectors and matrices
    {"half.h", kAll},
    {"OpenImageIO/", {"io"}},
    {"OpenEXR/", {"io"}},
    {"Imf", {"io"}},  // OpenEXR's headers without their folder
    {"Iex", {"io"}},
    {"png.h", {"io"}},
    {"zlib.h", {"io"}},
    {"isa-l/", {"io"}},
    {"jpeglib.h", {"io"}},
    {"libdeflate", {"io"}},
    {"libexif/", {"io"}},
    {"immintrin.h", {"io"}},  // half floats
    {"nlohmann/", {"io", "shot", "apps"}},
    {"OpenColorIO/", {"color"}},
    {"opencv2/", {"detect"}},
    {"ceres/", {"detect"}},
    {"Eigen/", {"detect", "light", "shot"}},
    {"embree3/", {"render"}},
    {"assimp/", {"render"}},
    {"CLI/", {"apps"}},
    {"tbb/", {"core", "resample"}},
    {"oneapi/", {"core", "resample"}},
    {"hwy/", {"resample"}},
    {"fmt/", {"io", "color", "detect", "light", "shot", "render", "apps"}},
};

/// The system's own headers have ".h" names; the standard library's have none.
bool is_standard(std::string_view name) {
    return name.find('.') == std::string_view::npos && name.find('/') == std::string_view::npos;
}

/// POSIX: files and folders in io, the terminal and signals in apps; core asks for pages and loads
/// modules.
bool is_system(std::string_view name) {
    static const Names files = {"dlfcn.h",  "fcntl.h",   "unistd.h",
                                "signal.h", "termios.h", "spawn.h"};
    return name.starts_with("sys/") || files.contains(name);
}

/// "src/map/cube.cpp" is in "map", "apps/chromeball/main.cpp" in "apps".
std::string folder_of(std::string_view path) {
    if (path.starts_with("src/")) path.remove_prefix(4);
    return std::string(path.substr(0, path.find('/')));
}

std::string refused_header(const std::string& folder, std::string_view name) {
    if (is_standard(name)) return "";
    if (folder == "core" && (name == "sys/mman.h" || name == "dlfcn.h" || name == "malloc.h"))
        return "";
    if (is_system(name))
        return folder == "io" || folder == "apps" ? "" : "system headers are for io and apps";
    for (const Door& door : kDoors)
        if (name.starts_with(door.begins))
            return door.folders.contains(folder) ? "" : "is not at its door";
    return "is not in the table of doors";
}

std::string refused_folder(const std::string& folder, const Names& may_include,
                           std::string_view name) {
    const std::size_t slash = name.find('/');
    if (slash == std::string_view::npos)
        return folder == "apps" ? "" : "is included without its folder";
    // The program's own headers may be named by the program's folder.
    const std::string_view target =
        name.starts_with("chromeball/") ? "apps" : name.substr(0, slash);
    return may_include.contains(target) ? "" : "is against the arrows";
}

}  // namespace

std::vector<std::string> includes_of(std::string_view text) {
    std::vector<std::string> names;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        std::string_view line = text.substr(0, end);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        const auto skip_blanks = [&] {
            line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
        };
        const auto skip = [&](std::string_view word) {
            skip_blanks();
            if (!line.starts_with(word)) return false;
            line.remove_prefix(word.size());
            skip_blanks();
            return true;
        };
        if (!skip("#") || !skip("include") || line.empty()) continue;
        const std::size_t close = line.find(line[0] == '<' ? '>' : '"', 1);
        if (close != std::string_view::npos) names.emplace_back(line.substr(0, close + 1));
    }
    return names;
}

std::vector<std::string> violations(const std::string& path, std::string_view text) {
    const std::string folder = folder_of(path);
    const auto* arrows = std::find_if(std::begin(kArrows), std::end(kArrows),
                                      [&](const Arrows& a) { return a.folder == folder; });
    if (arrows == std::end(kArrows)) return {path + ": its folder is not in the table of arrows"};
    std::vector<std::string> found;
    for (const std::string& include : includes_of(text)) {
        const std::string_view name = std::string_view(include).substr(1, include.size() - 2);
        const std::string reason = include[0] == '<'
                                       ? refused_header(folder, name)
                                       : refused_folder(folder, arrows->may_include, name);
        if (!reason.empty()) found.push_back(path + ": " + include + " " + reason);
    }
    return found;
}

}  // namespace chromeball::structure
