#pragma once

#include <cassert>
#include <cstddef>
#include <vector>

#include "core/memory.h"

namespace chromeball {

/// Width and height in pixels.
struct Size {
    int width = 0;
    int height = 0;

    bool operator==(const Size&) const = default;
    /// width x height; does not overflow for any two ints.
    std::size_t pixels() const {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    }
};

/// A rectangle of whole pixels: its top-left corner and its size.
struct Window {
    int x = 0;
    int y = 0;
    Size size;

    bool operator==(const Window&) const = default;
};

/// Borrowed pixels: interleaved channels, rows from top to bottom, `stride` elements from row to
/// row. Never owns.
template <class T>
struct ImageView {
    T* data = nullptr;
    Size size;
    int channels = 0;
    std::ptrdiff_t stride = 0;

    T* row(int y) const {
        assert(y >= 0 && y < size.height);
        return data + y * stride;
    }
    T* pixel(int x, int y) const {
        assert(x >= 0 && x < size.width);
        return row(y) + static_cast<std::ptrdiff_t>(x) * channels;
    }
    operator ImageView<const T>() const { return {data, size, channels, stride}; }
};

/// Owned float pixels, interleaved, scene-linear; with four channels the fourth is alpha, and
/// colour is multiplied by it.
class Image {
public:
    Image() = default;
    /// All pixels 0.
    Image(Size size, int channels)
        : size_(size),
          channels_(channels),
          values_(size.pixels() * static_cast<std::size_t>(channels)) {}

    Size size() const { return size_; }
    int width() const { return size_.width; }
    int height() const { return size_.height; }
    int channels() const { return channels_; }
    bool empty() const { return values_.empty(); }

    ImageView<float> view() { return {values_.data(), size_, channels_, stride()}; }
    ImageView<const float> view() const { return {values_.data(), size_, channels_, stride()}; }
    float* row(int y) { return view().row(y); }
    const float* row(int y) const { return view().row(y); }
    float* pixel(int x, int y) { return view().pixel(x, y); }
    const float* pixel(int x, int y) const { return view().pixel(x, y); }

private:
    std::ptrdiff_t stride() const { return static_cast<std::ptrdiff_t>(size_.width) * channels_; }

    Size size_;
    int channels_ = 0;
    std::vector<float, ZeroedAllocator<float>> values_;
};

}  // namespace chromeball
