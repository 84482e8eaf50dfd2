#include "io/probe.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <string_view>

#include "io/bytes.h"
#include "io/input_file.h"
#include "io/messages.h"

namespace chromeball::io {
namespace {

using namespace std::string_view_literals;

constexpr std::size_t kHeadBytes = 64 * 1024;

/// A signature and the OpenImageIO plugin that reads such files.
struct Signature {
    std::size_t offset;
    std::string_view bytes;
    std::string_view plugin;
};
constexpr Signature kSignatures[] = {
    {0, "\x76\x2f\x31\x01"sv, "openexr"},
    {0, "\x89PNG\r\n\x1a\n"sv, "png"},
    {0, "\xff\xd8\xff"sv, "jpeg"},
    {0, "II*\0"sv, "tiff"},
    {0, "MM\0*"sv, "tiff"},
    {0, "II+\0"sv, "tiff"},
    {0, "MM\0+"sv, "tiff"},
    {0, "#?RADIANCE"sv, "hdr"},
    {0, "#?RGBE"sv, "hdr"},
    {0, "SDPX"sv, "dpx"},
    {0, "XPDS"sv, "dpx"},
    {0, "\x80\x2a\x5f\xd7"sv, "cineon"},
    {0, "\xd7\x5f\x2a\x80"sv, "cineon"},
    {0, "8BPS"sv, "psd"},
    {0, "BM"sv, "bmp"},
    {0, "GIF8"sv, "gif"},
    {8, "WEBP"sv, "webp"},
    {0, "\0\0\0\x0cjP  "sv, "jpeg2000"},
    {0, "\xff\x4f\xff\x51"sv, "jpeg2000"},
    {0, "\x01\xda"sv, "sgi"},
    {0, "SIMPLE  ="sv, "fits"},
    {0, "DDS "sv, "dds"},
    {0, "FUJIFILMCCD-RAW"sv, "raw"},
    {0, "FOVb"sv, "raw"},
    {0, "IIRO"sv, "raw"},
    {0, "IIRS"sv, "raw"},
    {0, "IIU\0"sv, "raw"},
    {4, "ftypheic"sv, "heif"},
    {4, "ftypheix"sv, "heif"},
    {4, "ftypmif1"sv, "heif"},
    {4, "ftypmsf1"sv, "heif"},
    {4, "ftypavif"sv, "heif"},
    {4, "ftypcrx "sv, "raw"},
};

/// Formats without a signature of their own, by the file's name; TIFF-like ones among the RAWs.
constexpr std::string_view kRawExtensions[] = {
    "3fr", "arw", "bay", "bmq", "cap", "cine", "cr2", "cr3", "crw", "cs1", "dc2",
    "dcr", "dng", "drf", "dsc", "erf", "fff",  "ia",  "iiq", "k25", "kc2", "kdc",
    "mdc", "mef", "mos", "mrw", "nef", "nrw",  "orf", "pef", "ptx", "pxn", "qtk",
    "raf", "raw", "rdc", "rw2", "rwl", "rwz",  "sr2", "srf", "srw", "sti", "x3f"};
constexpr std::pair<std::string_view, std::string_view> kNamedFormats[] = {
    {"tga", "targa"}, {"tpic", "targa"}, {"rla", "rla"}, {"pic", "softimage"}};

std::string extension_of_name(const std::string& path) {
    const auto dot = path.find_last_of("./");
    if (dot == std::string::npos || path[dot] == '/') return {};
    std::string extension = path.substr(dot + 1);
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

/// P1 to P6 and the float maps PF, Pf, followed by white space.
bool is_portable_map(std::span<const std::byte> head) {
    if (head.size() < 3 || head[0] != std::byte{'P'}) return false;
    const bool kind = "123456Ff"sv.find(static_cast<char>(head[1])) != std::string_view::npos;
    return kind && std::isspace(std::to_integer<int>(head[2]));
}

std::string_view plugin_of_content(std::span<const std::byte> head) {
    for (const Signature& signature : kSignatures)
        if (starts_with(head, signature.offset, signature.bytes)) return signature.plugin;
    return is_portable_map(head) ? "pnm"sv : ""sv;
}

std::string_view plugin_of_name(const std::string& extension) {
    for (const auto& [name, plugin] : kNamedFormats)
        if (extension == name) return plugin;
    const bool raw = std::ranges::find(kRawExtensions, extension) != std::end(kRawExtensions);
    return raw ? "raw"sv : ""sv;
}

bool is_text(std::span<const std::byte> head) {
    return std::ranges::all_of(head.first(std::min<std::size_t>(head.size(), 512)), [](auto b) {
        const int c = std::to_integer<int>(b);
        return (c >= 32 && c != 127) || (c >= 9 && c <= 13);
    });
}

std::string unknown_type(const std::string& extension, std::span<const std::byte> head) {
    const std::string found = is_text(head)                  ? "plain text"
                              : starts_with(head, 4, "ftyp") ? "a movie"
                                                             : "of no known picture type";
    const std::string wanted =
        extension == "exr" ? "not an OpenEXR file although it is named so" : "not a picture";
    const std::string_view way_out =
        starts_with(head, 4, "ftyp") ? "extract its frames as pictures first"
                                     : "give an EXR, JPEG, PNG, TIFF, HDR, DPX or camera RAW file";
    return fmt::format("{}: its content is {}; {}", wanted, found, way_out);
}

}  // namespace

std::size_t check_file(const std::string& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) {
        if (errno == ENOENT) throw failure(path, "no such file; check the path");
        throw failure(path, fmt::format("cannot be read: {}", system_reason(errno)));
    }
    if (S_ISDIR(status.st_mode)) throw failure(path, "is a folder; give a picture file");
    if (!S_ISREG(status.st_mode)) throw failure(path, "is not a regular file; give a picture file");
    if (status.st_size == 0) throw failure(path, "is empty (0 bytes); copy or export it again");
    return static_cast<std::size_t>(status.st_size);
}

FileProbe probe_file(const std::string& path) {
    FileProbe probe;
    probe.size = check_file(path);
    probe.head = first_bytes(path, std::min(probe.size, kHeadBytes));
    const std::string extension = extension_of_name(path);
    std::string_view plugin = plugin_of_content(probe.head);
    const std::string_view by_name = plugin_of_name(extension);
    // Most camera RAWs are TIFFs inside; only their name tells.
    if (plugin.empty() || (plugin == "tiff" && by_name == "raw")) plugin = by_name;
    if (plugin.empty()) throw failure(path, unknown_type(extension, probe.head));
    probe.plugin = plugin;
    probe.exr = plugin == "openexr";
    probe.raw = plugin == "raw";
    return probe;
}

}  // namespace chromeball::io
