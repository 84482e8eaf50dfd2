#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>
#include <utility>

namespace chromeball {

/// Bytes that are 0, or nullptr where there are none; for std::free. Large pieces are the system's
/// own fresh pages, large ones where it has them, which nothing touches before they are used, and
/// then on the thread that uses them.
void* zeroed_memory(std::size_t count, std::size_t size);

/// Lets the C library keep memory of pieces up to some megabytes for the next ones, for the whole
/// process. It would give each back and take fresh pages again, which the system clears: a tenth of
/// a fast conversion's time. Called by programs, before they work.
void keep_freed_memory();

/// Of vectors that need not be filled with 0 when they are made.
template <class T>
struct ZeroedAllocator {
    using value_type = T;
    ZeroedAllocator() = default;
    template <class U>
    ZeroedAllocator(const ZeroedAllocator<U>&) {}
    T* allocate(std::size_t count) {
        void* memory = zeroed_memory(count, sizeof(T));
        if (!memory) throw std::bad_alloc();
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t) { std::free(memory); }
    /// Without a value: zero already, since no vector here is ever made smaller and larger again.
    template <class U>
    void construct(U*) {}
    template <class U, class... Args>
    void construct(U* at, Args&&... args) {
        ::new (static_cast<void*>(at)) U(std::forward<Args>(args)...);
    }
    bool operator==(const ZeroedAllocator&) const { return true; }
};

}  // namespace chromeball
