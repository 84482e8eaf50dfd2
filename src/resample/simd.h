#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace chromeball {

/// The kinds of instructions that the resampler has kernels for and this processor can run, best
/// first: of AVX3 (which is AVX-512), AVX2, SSE4, SCALAR.
std::vector<std::string> simd_targets();

/// From now on the resampler uses these instructions instead of the best ones, in the whole
/// process; an empty name: the best again. Not while a picture is being drawn. False, and nothing
/// changes, for a name that simd_targets() does not have. The same instructions give the same bytes
/// on every machine; others differ by roundings.
bool use_simd_target(std::string_view name);

}  // namespace chromeball
