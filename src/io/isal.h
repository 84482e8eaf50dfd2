#pragma once

namespace chromeball::io {

/// To be called behind every call of ISA-L. Its functions leave bits in the upper halves of the
/// vector registers, against the rules of the platform; then all code compiled for SSE, such as
/// the C library's mathematics, waits for these halves at every instruction: exp() was 6 times
/// slower on a thread that had inflated anything.
inline void clear_upper_halves() {
#if defined(__AVX__)
    __builtin_ia32_vzeroupper();
#elif defined(__x86_64__)
    // Compiled for less, code has nothing in there, and may not call the builtin.
    if (__builtin_cpu_supports("avx")) asm volatile("vzeroupper");
#endif
}

}  // namespace chromeball::io
