#include "io/oiio_module.h"

#include <fmt/format.h>

#include <string_view>

#include "core/module.h"
#include "io/messages.h"

namespace chromeball::io {
namespace {

constexpr char kName[] = "chromeball_oiio.so";

const OiioModule& loaded_module(const std::string& path) {
    constexpr std::string_view kWayOut =
        "install chromeball again, or convert the picture to EXR or PNG";
    std::string reason;
    void* handle = load_module(kName, reason);
    if (!handle)
        throw failure(path, fmt::format("this format needs {}, which cannot be loaded: {}; {}",
                                        kName, reason, kWayOut));
    auto* entry = reinterpret_cast<OiioModuleEntry*>(module_symbol(handle, kOiioModuleEntry));
    const OiioModule* module = entry ? entry() : nullptr;
    if (!module || std::string_view(module->version) != CHROMEBALL_VERSION)
        throw failure(path, fmt::format("this format needs {} of version {}, but {} was found; {}",
                                        kName, CHROMEBALL_VERSION,
                                        module ? module->version : "something else", kWayOut));
    return *module;
}

/// Loaded at the first call; after a failure the next call tries again. Stays loaded.
const OiioModule& module_for(const std::string& path) {
    static const OiioModule& module = loaded_module(path);
    return module;
}

}  // namespace

Photo decode_with_oiio(const std::string& path, const FileProbe& probe,
                       const DecodeRequest& request) {
    return module_for(path).decode(path, probe, request);
}

Bytes encode_with_oiio(const std::string& path, const Values& values, const WriteOptions& options,
                       WriteReport& report) {
    return module_for(path).encode(path, values, options, report);
}

std::unique_ptr<ClipReader> open_clip_with_oiio(const std::string& path) {
    return module_for(path).open_clip(path);
}

}  // namespace chromeball::io
