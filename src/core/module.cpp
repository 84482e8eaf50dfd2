#include "core/module.h"

#include <dlfcn.h>

#include <cstddef>
#include <memory>
#include <new>
#include <vector>

namespace chromeball {
namespace {

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

}  // namespace

void* load_module(const std::string& name, std::string& reason) {
    // Lazily: of the hundreds of libraries behind a module few functions are called.
    if (void* handle = ::dlopen(name.c_str(), RTLD_LAZY | RTLD_LOCAL)) return handle;
    reason = ::dlerror();
    // Sanitizers stand between us and the loader, which then looks on their behalf.
    for (const std::string& folder : search_folders())
        if (void* handle = ::dlopen((folder + "/" + name).c_str(), RTLD_LAZY | RTLD_LOCAL))
            return handle;
    return nullptr;
}

void* module_symbol(void* module, const std::string& name) { return ::dlsym(module, name.c_str()); }

}  // namespace chromeball
