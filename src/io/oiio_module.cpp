#include "io/oiio_module.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <memory>
#include <string_view>
#include <vector>

#include "io/messages.h"

namespace chromeball::io {
namespace {

constexpr char kName[] = "chromeball_oiio.so";

/// Where the loader looks on behalf of the program or library that holds this code.
std::vector<std::string> search_folders() {
    std::vector<std::string> folders;
#ifdef __GLIBC__
    Dl_info info{};
    void* self = nullptr;
    if (::dladdr1(reinterpret_cast<const void*>(&search_folders), &info, &self, RTLD_DL_LINKMAP) ==
        0)
        return folders;
    Dl_serinfo extent{};
    if (::dlinfo(self, RTLD_DI_SERINFOSIZE, &extent) != 0) return folders;
    const auto memory = std::make_unique<std::byte[]>(extent.dls_size);
    auto* list = new (memory.get()) Dl_serinfo(extent);
    if (::dlinfo(self, RTLD_DI_SERINFO, list) != 0) return folders;
    for (unsigned i = 0; i < list->dls_cnt; ++i)
        folders.emplace_back(list->dls_serpath[i].dls_name);
#endif
    return folders;
}

/// The module's handle, or nullptr and the loader's words.
void* load(std::string& reason) {
    // Lazily: of the hundreds of libraries behind OpenImageIO few functions are called.
    if (void* handle = ::dlopen(kName, RTLD_LAZY | RTLD_LOCAL)) return handle;
    reason = ::dlerror();
    // Sanitizers stand between us and the loader, which then looks on their behalf.
    for (const std::string& folder : search_folders())
        if (void* handle = ::dlopen((folder + "/" + kName).c_str(), RTLD_LAZY | RTLD_LOCAL))
            return handle;
    return nullptr;
}

const OiioModule& load_module(const std::string& path) {
    constexpr std::string_view kWayOut =
        "install chromeball again, or convert the picture to EXR or PNG";
    std::string reason;
    void* handle = load(reason);
    if (!handle)
        throw failure(path, fmt::format("this format needs {}, which cannot be loaded: {}; {}",
                                        kName, reason, kWayOut));
    auto* entry = reinterpret_cast<OiioModuleEntry*>(::dlsym(handle, kOiioModuleEntry));
    const OiioModule* module = entry ? entry() : nullptr;
    if (!module || std::string_view(module->version) != CHROMEBALL_VERSION)
        throw failure(path, fmt::format("this format needs {} of version {}, but {} was found; {}",
                                        kName, CHROMEBALL_VERSION,
                                        module ? module->version : "something else", kWayOut));
    return *module;
}

/// Loaded at the first call; after a failure the next call tries again. Stays loaded.
const OiioModule& module_for(const std::string& path) {
    static const OiioModule& module = load_module(path);
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
