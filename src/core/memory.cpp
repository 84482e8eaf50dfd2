#include "core/memory.h"

#include <cstdint>

#ifdef __linux__
#include <sys/mman.h>
#endif
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace chromeball {
namespace {

/// A page fault for each 4 KiB is a fifth of a fast conversion's time.
void ask_for_large_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    constexpr std::size_t kWorthIt = std::size_t{8} << 20, kPage = 4096;
    if (bytes < kWorthIt) return;
    const auto begin = reinterpret_cast<std::uintptr_t>(memory);
    const std::uintptr_t first = (begin + kPage - 1) / kPage * kPage;
    const std::uintptr_t last = (begin + bytes) / kPage * kPage;
    // Only advice: where the system does not take it, nothing is lost.
    ::madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
#endif
}

}  // namespace

void* zeroed_memory(std::size_t count, std::size_t size) {
    void* memory = std::calloc(count, size);
    if (memory) ask_for_large_pages(memory, count * size);
    return memory;
}

void keep_freed_memory() {
#ifdef __GLIBC__
    // Larger pieces still come from the system and go back to it: large pages are for them.
    ::mallopt(M_MMAP_THRESHOLD, 4 << 20);
    ::mallopt(M_TRIM_THRESHOLD, 32 << 20);
#endif
}

}  // namespace chromeball
